// Checks that inputs whose keyframes stay in files give the same results as inputs in memory.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "chronormal/io/input.h"
#include "chronormal/io/output.h"
#include "chronormal/motion/paths.h"
#include "chronormal/workflow/audit.h"
#include "chronormal/workflow/compare.h"
#include "chronormal/workflow/inspect.h"
#include "chronormal/workflow/sample.h"
#include "core/text.h"
#include "io/input/input_identity.h"
#include "tests/support/cache_bytes.h"
#include "tests/support/gltf_documents.h"
#include "tests/support/read_input.h"
#include "tests/support/strict_stream.h"
#include "tests/support/temporary_folder.h"
#include "workflow/json/json.h"

namespace chronormal::stream_test {
namespace {

using test::TemporaryFolder;

constexpr std::uint32_t kSide = 8;

// Makes a wavy sheet with a seam, at which two columns of vertices coincide. In the last keyframe, the vertices at one
// end of the seam separate.
Motion wave(std::size_t keyframes) {
  Motion motion;
  std::vector<std::uint32_t> corners;
  for (std::uint32_t y = 0; y + 1 < kSide; ++y) {
    for (std::uint32_t x = 0; x + 1 < kSide; ++x) {
      const std::uint32_t v = y * kSide + x;
      if (x == 3) continue;  // columns 3 and 4 have the same x
      corners.insert(corners.end(), {v, v + 1, v + kSide, v + 1, v + kSide + 1, v + kSide});
    }
  }
  motion.topology = Topology::triangles(kSide * kSide, corners).value();
  for (std::size_t k = 0; k < keyframes; ++k) {
    Motion::Keyframe keyframe{{}, static_cast<double>(k), ""};
    for (std::size_t v = 0; v < kSide * kSide; ++v) {
      const std::size_t column = v % kSide, x = column > 3 ? column - 1 : column;
      const double phase = 0.7 * static_cast<double>(x) + 0.9 * static_cast<double>(k);
      const double apart = column > 3 && k + 1 == keyframes && v < kSide ? 0.1 : 0;
      keyframe.positions.insert(keyframe.positions.end(), {static_cast<float>(x), static_cast<float>(v / kSide),
                                                           static_cast<float>(std::sin(phase) + apart)});
    }
    motion.keyframes.push_back(std::move(keyframe));
  }
  motion.connect_as_sequence();
  return motion;
}

// Writes the motion in every format that can be read one keyframe at a time. Returns the names of the files of each
// format.
std::vector<std::vector<std::string>> write_all(const TemporaryFolder& folder, const Motion& motion) {
  for (const char* const name : {"walk.npz", "walk.pc2", "walk.mdd", "walk_%02d.ply", "walk_%02d.obj"})
    EXPECT_TRUE(write_motion(motion, folder / name, false).ok()) << name;
  std::vector<float> coordinates;
  for (const auto& keyframe : motion.keyframes)
    coordinates.insert(coordinates.end(), keyframe.positions.begin(), keyframe.positions.end());
  const std::vector<double> doubles(coordinates.begin(), coordinates.end());
  const std::string shape =
      "(" + std::to_string(motion.keyframes.size()) + ", " + std::to_string(motion.topology.vertex_count()) + ", 3)";
  folder.write("big.npy", test::npy(test::npy_header(">f8", shape), test::raw(doubles, true)));
  const std::string mesh = folder / "walk_00.obj";
  return {{folder / "walk.npz"},      {mesh, folder / "walk.pc2"}, {mesh, folder / "walk.mdd"},
          {mesh, folder / "big.npy"}, {folder / "walk_*.ply"},     {folder / "walk_*.obj"}};
}

InputOptions streamed(InputOptions options) {
  options.stream = true;
  options.kept_bytes = 0;
  return options;
}

TEST(InputStream, keyframes_have_the_bits_of_the_input_read_whole) {
  const TemporaryFolder folder;
  for (const auto& names : write_all(folder, wave(5))) {
    const Motion whole = test::read_motion(test::files(names, 24)).value();
    Result<Input> input = open_input(streamed(test::files(names, 24)));
    ASSERT_TRUE(input.ok()) << input.error().text();
    MotionStream& stream = *input.value().stream().value();
    EXPECT_TRUE(stream.motion().topology == whole.topology) << names.back();
    ASSERT_EQ(stream.motion().keyframes.size(), 5U) << names.back();
    EXPECT_TRUE(stream.motion().keyframes[3].positions.empty()) << names.back() << ": it was read whole";
    for (const std::size_t k : {3U, 0U, 4U, 1U, 2U}) {
      ASSERT_TRUE(stream.hold(k, k).ok());
      EXPECT_EQ(stream.motion().keyframes[k].positions, whole.keyframes[k].positions) << names.back();
      EXPECT_EQ(stream.motion().keyframes[k].time, whole.keyframes[k].time) << names.back();
      EXPECT_EQ(stream.motion().keyframes[k].name, whole.keyframes[k].name) << names.back();
    }
    EXPECT_EQ(input.value().motion().value()->keyframes[4].positions, whole.keyframes[4].positions);
  }
}

// A part of a sequence follows the curves through all keyframes of the sequence, so its pieces are also pieces of the
// whole sequence.
TEST(InputStream, the_ends_of_a_part_move_on_the_curves_of_the_whole) {
  const TemporaryFolder folder;
  for (const auto& names : write_all(folder, wave(14))) {
    for (const bool is_streamed : {false, true}) {
      const auto pieces = [&](std::size_t from, std::optional<std::size_t> to, std::size_t every) {
        InputOptions options = is_streamed ? streamed(test::files(names, 24)) : test::files(names, 24);
        options.from = from;
        options.to = to;
        options.every = every;
        options.path = "catmull-rom:0.5";
        Result<Input> input = open_input(options);
        EXPECT_TRUE(input.ok()) << input.error().text();
        std::vector<std::pair<double, std::vector<float>>> found;
        for (const Motion::Keyframe& keyframe : input.value().motion().value()->keyframes)
          found.emplace_back(keyframe.time, keyframe.positions);
        return found;
      };
      struct Part {
        std::size_t from, to, every;
      };
      for (const Part& part : {Part{4, 9, 1}, Part{0, 1, 1}, Part{0, 2, 1}, Part{12, 13, 1}, Part{10, 13, 1},
                               Part{2, 8, 2}, Part{6, 9, 3}}) {
        const auto all = pieces(0, std::nullopt, part.every), some = pieces(part.from, part.to, part.every);
        const auto first =
            std::find_if(all.begin(), all.end(), [&](const auto& key) { return key.first == some[0].first; });
        ASSERT_LE(some.size(), static_cast<std::size_t>(all.end() - first));
        EXPECT_TRUE(std::equal(some.begin(), some.end(), first)) << names.back() << ' ' << part.from << ' ' << part.to;
      }
    }
  }
}

TEST(InputStream, curves_are_cut_and_what_has_none_is_refused) {
  const TemporaryFolder folder;
  const auto inputs = write_all(folder, wave(5));
  for (const auto& names : inputs) {
    InputOptions options = streamed(test::files(names));
    options.path = "catmull-rom:0.1";
    Result<Input> input = open_input(options);
    ASSERT_TRUE(input.ok());
    const CutMotion whole =
        cut_into_segments(test::read_motion(test::files(names)).value(), {PathKind::kCatmullRom, 0.1}).value();
    const Motion& found = *input.value().motion().value();
    ASSERT_EQ(found.keyframes.size(), whole.motion.keyframes.size());
    EXPECT_GT(found.keyframes.size(), 5U);
    EXPECT_EQ(input.value().cut_path().pieces, found.segments.size());
    for (std::size_t k = 0; k < found.keyframes.size(); ++k)
      EXPECT_EQ(found.keyframes[k].positions, whole.motion.keyframes[k].positions);
    options.path = "hermite";
    Result<Input> without = open_input(options);
    ASSERT_TRUE(without.ok());
    for (int again = 0; again < 2; ++again) EXPECT_EQ(without.value().motion().error().place, "--path");
    options.path = "round";
    EXPECT_EQ(open_input(options).error().place, "--path");
    options.path = "catmull-rom";
    options.max_expansion = 2;
    EXPECT_LE(open_input(options).value().motion().value()->segments.size(), 8U);
  }
}

TEST(InputStream, what_cannot_be_read_one_by_one_is_read_whole) {
  const TemporaryFolder folder;
  folder.write("a.npz", test::small_npz(true));
  Result<Input> input = open_input(streamed(test::files({folder / "a.npz"})));
  ASSERT_TRUE(input.ok());
  EXPECT_EQ(input.value().stream().value()->motion().keyframes[1].positions, test::kTurning[1]);
}

TEST(InputStream, commands_give_the_bytes_that_they_give_of_a_motion_in_memory) {
  const TemporaryFolder folder;
  const auto inputs = write_all(folder, wave(9));
  Result<Input> input = open_input(streamed(test::files(inputs[1])));
  ASSERT_TRUE(input.ok());
  const Motion whole = test::read_motion(test::files(inputs[1])).value();
  std::size_t most_held = 0;
  MotionStream stream = test::strict(*input.value().stream().value(), most_held);

  for (const ElementKind kind : {ElementKind::kFaces, ElementKind::kVertices}) {
    CompareOptions options;
    options.elements.kind = kind;
    options.certify = true;
    const auto text = [](const Result<Comparison>& comparison) {
      return compare_json({{"x", comparison.value()}}, false, false);
    };
    EXPECT_EQ(text(compare(stream, options)), text(compare(whole, options)));
  }
  AuditOptions audit_options;
  audit_options.keep_errors = true;
  const Audit in_memory = audit(whole, {}, audit_options).value();
  const Audit as_stream = audit(stream, {}, audit_options).value();
  EXPECT_EQ(audit_json("x", as_stream, {1}), audit_json("x", in_memory, {1}));
  EXPECT_EQ(as_stream.errors[0].degrees.size(), in_memory.errors[0].degrees.size());
  const Inspection inspection = inspect(stream).value(), of_whole = inspect(whole);
  EXPECT_EQ(inspection.doubled.count, of_whole.doubled.count);
  EXPECT_EQ(inspection.diagonal, of_whole.diagonal);
  EXPECT_EQ(inspection.normal_bytes, of_whole.normal_bytes);
  EXPECT_EQ(inspection.turn.value, of_whole.turn.value);

  most_held = 0;  // resets the count, as a comparison holds several small segments at once
  for (const char* const name : {"n.npy", "n.npz", "n_%02d.ply"}) {
    {
      const SampleOptions options;
      const Moments moments{{0, 0.25, 3.5, 3.75, 1, 7.5, 8}, {}};
      const SampleFormat format = find_sample_format(name).value();
      ASSERT_TRUE(write_samples(stream, options, moments, {folder / (std::string("s") + name), format, true}).ok());
      ASSERT_TRUE(write_samples(whole, options, moments, {folder / (std::string("w") + name), format, true}).ok());
      const std::string one = format == SampleFormat::kPly ? "n_05.ply" : name;
      EXPECT_EQ(test::read_whole(folder / ("s" + one)), test::read_whole(folder / ("w" + one))) << one;
    }
  }
  EXPECT_LE(most_held, 3U);
  for (const char* const name : {"c.npz", "c.pc2", "c.mdd", "c_%d.ply"}) {
    ASSERT_TRUE(write_motion(stream, folder / (std::string("s") + name), false).ok());
    ASSERT_TRUE(write_motion(whole, folder / (std::string("w") + name), false).ok());
  }
  for (const char* const name : {"c.npz", "c.pc2", "c.mdd", "c_8.ply"})
    EXPECT_EQ(test::read_whole(folder / (std::string("s") + name)),
              test::read_whole(folder / (std::string("w") + name)))
        << name;
}

TEST(InputStream, a_pass_over_segments_holds_three_keyframes) {
  const Motion whole = wave(9);
  MotionStream read(whole);
  std::size_t most_held = 0;
  MotionStream stream = test::strict(read, most_held);
  AuditOptions options;
  ASSERT_TRUE(audit(stream, {}, options).ok());
  EXPECT_LE(most_held, 3U);
}

TEST(InputStream, a_file_that_is_cut_while_it_is_read_is_an_error_and_leaves_nothing) {
  const TemporaryFolder folder;
  const auto inputs = write_all(folder, wave(9));
  Result<Input> input = open_input(streamed(test::files(inputs[1])));
  ASSERT_TRUE(input.ok());
  constexpr std::size_t kEnd = 32 + 12 * kSide * kSide * 6 + 100;
  std::filesystem::resize_file(folder / "walk.pc2", kEnd);
  const std::size_t before = folder.entry_count();
  Result<SampleSummary> written =
      write_samples(*input.value().stream().value(), {}, {{0.5, 1.5, 6.5}, {}}, {folder / "n.npy", SampleFormat::kNpy});
  ASSERT_FALSE(written.ok());
  EXPECT_EQ(written.error().code, ErrorCode::kFailed);
  EXPECT_EQ(written.error().place, folder / "walk.pc2");
  EXPECT_EQ(written.error().message.find("another program has shortened the file from "), 0U)
      << written.error().message;
  EXPECT_NE(written.error().message.find(" to " + grouped(kEnd) + " bytes while it was read"), std::string::npos);
  EXPECT_EQ(folder.entry_count(), before);
}

TEST(InputStream, keyframes_may_be_written_over_the_files_that_they_come_from) {
  const Moments moments{{0, 0.25, 0.5, 1.5, 3.5}, {}};
  for (const bool sampled : {false, true}) {
    const TemporaryFolder folder;
    (void)write_all(folder, wave(5));
    std::vector<std::string> backwards;
    for (int k = 4; k >= 0; --k) backwards.push_back(folder / ("walk_0" + std::to_string(k) + ".ply"));
    for (const char* const name : {"other_%02d.ply", "walk_%02d.ply"}) {
      Result<Input> input = open_input(streamed(test::files(backwards)));
      ASSERT_TRUE(input.ok()) << input.error().text();
      MotionStream& stream = *input.value().stream().value();
      if (sampled)
        ASSERT_TRUE(write_samples(stream, {}, moments, {folder / name, SampleFormat::kPly, true}).ok());
      else
        ASSERT_TRUE(write_motion(stream, folder / name, true).ok());
    }
    for (int k = 0; k < 5; ++k) {
      const std::string end = "_0" + std::to_string(k) + ".ply";
      EXPECT_EQ(test::read_whole(folder / ("walk" + end)), test::read_whole(folder / ("other" + end))) << sampled << k;
    }
  }
}

TEST(InputStream, a_keyframe_that_is_wrong_leaves_none_of_the_files_behind) {
  const TemporaryFolder folder;
  (void)write_all(folder, wave(5));
  folder.write("walk_03.ply", "ply\nformat ascii 1.0\nelement vertex 1\n");
  const std::size_t before = folder.entry_count();
  for (const bool sampled : {false, true}) {
    Result<Input> input = open_input(streamed(test::files({folder / "walk_*.ply"})));
    ASSERT_TRUE(input.ok()) << input.error().text();
    MotionStream& stream = *input.value().stream().value();
    const bool is_written =
        sampled ? write_samples(stream, {}, {{0, 1, 3}, {}}, {folder / "new_%d.obj", SampleFormat::kObj}).ok()
                : write_motion(stream, folder / "new_%d.obj", false).ok();
    EXPECT_FALSE(is_written);
    EXPECT_EQ(folder.entry_count(), before) << sampled;
  }
}

TEST(InputStream, errors_in_keyframes_are_those_of_reading_whole) {
  const TemporaryFolder folder;
  const auto inputs = write_all(folder, wave(5));
  std::string bytes = test::read_whole(folder / "walk.pc2");
  bytes.replace(32 + 12 * kSide * kSide * 3 + 16, 4, std::string("\0\0\xC0\x7F", 4));
  folder.write("walk.pc2", bytes);
  folder.write("walk_03.ply", "ply\nformat ascii 1.0\nelement vertex 1\n");
  folder.write("walk_03.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  for (const std::size_t i : {1U, 4U, 5U}) {
    const Result<Motion> whole = test::read_motion(test::files(inputs[i]));
    Result<Input> input = open_input(streamed(test::files(inputs[i])));
    ASSERT_FALSE(whole.ok());
    ASSERT_TRUE(input.ok()) << input.error().text();
    MotionStream& stream = *input.value().stream().value();
    EXPECT_TRUE(stream.hold_segment(0).ok());
    const Status status = stream.hold_segment(2);
    ASSERT_FALSE(status.ok());
    EXPECT_EQ(status.error().text(), whole.error().text());
  }
}

TEST(InputFrames, from_to_and_every_choose_keyframes_and_keep_their_times) {
  const TemporaryFolder folder;
  const Motion motion = wave(9);
  for (const auto& names : write_all(folder, motion)) {
    for (const bool stream : {false, true}) {
      InputOptions options = test::files(names);
      if (stream) options = streamed(options);
      options.from = 1;
      options.to = 7;
      options.every = 3;
      const Result<Motion> chosen = test::read_motion(options);
      ASSERT_TRUE(chosen.ok()) << chosen.error().text();
      ASSERT_EQ(chosen.value().keyframes.size(), 3U);
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(chosen.value().keyframes[i].positions, motion.keyframes[1 + 3 * i].positions) << names.back();
        EXPECT_EQ(chosen.value().keyframes[i].time, static_cast<double>(1 + 3 * i)) << names.back();
      }
      options.to = 9;
      EXPECT_EQ(
          test::read_motion(options).error().text(),
          "--to: there is no keyframe with this number; choose another, since the keyframes are numbered from 0 to 8");
      options.to = 2;
      EXPECT_EQ(test::read_motion(options).error().code, ErrorCode::kUsage);
    }
  }
}

TEST(InputFrames, only_sequences_have_keyframes_to_choose_among) {
  const TemporaryFolder folder;
  write_all(folder, wave(2));
  InputOptions options = test::targets_over(folder / "walk_00.obj", {folder / "walk_01.obj"});
  options.every = 2;
  EXPECT_EQ(open_input(options).error().text(),
            "--every: this option is only for sequences of keyframes, and the input is not one; leave the option out");
  InputOptions still = test::files({folder / "walk_00.obj"});
  still.allow_mesh = true;
  still.from = 1;
  EXPECT_EQ(open_input(still).error().text(),
            "--from: this option is only for sequences of keyframes, and the input is not one; leave the option out");
  InputOptions document = test::files({folder.write("face.glb", test::sparse_document().glb())});
  document.to = 1;
  EXPECT_EQ(open_input(document).error().text(),
            "--to: this option is only for sequences of keyframes, and the input is not one; leave the option out");
}

TEST(InputFrames, a_step_of_zero_leads_nowhere) {
  const TemporaryFolder folder;
  for (const auto& names : write_all(folder, wave(3))) {
    InputOptions options = test::files(names);
    options.every = 0;
    EXPECT_EQ(test::read_motion(options).error().text(), "--every: the step must be at least 1");
  }
}

// A pattern also finds links whose target does not exist.
TEST(InputIdentity, of_a_link_that_leads_nowhere_is_an_error_with_its_path) {
  const TemporaryFolder folder;
  write_all(folder, wave(2));
  std::filesystem::create_symlink("gone.obj", folder / "walk_99.obj");
  const auto files = identify_files(test::files({folder / "walk_*.obj"}));
  ASSERT_FALSE(files.ok());
  EXPECT_EQ(files.error().code, ErrorCode::kFailed);
  EXPECT_EQ(files.error().text(), folder / "walk_99.obj" + ": No such file or directory");
}

}  // namespace
}  // namespace chronormal::stream_test
