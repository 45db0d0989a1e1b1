// Checks bakes of a sequence whose keyframes stay in files. The results must have the same bytes as for a sequence in
// memory, the memory of the bake must not grow with the number of keyframes, and a failure must leave no files.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "chronormal/core/parallel.h"
#include "chronormal/io/input.h"
#include "chronormal/io/output.h"
#include "chronormal/workflow/bake.h"
#include "core/text.h"
#include "tests/support/cache_bytes.h"
#include "tests/support/child_process.h"
#include "tests/support/read_input.h"
#include "tests/support/strict_stream.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::bake_stream_test {
namespace {

using test::TemporaryFolder;

// The keyframes in which a sheet has no area: none, only the first, or some in the middle.
enum class Flat { kNever, kFirst, kForAWhile };

bool is_flat(Flat flat, std::size_t k) {
  return (flat == Flat::kFirst && k == 0) || (flat == Flat::kForAWhile && 2 <= k && k <= 7);
}

// Returns the positions of keyframe k of a waving sheet with side x side vertices. The first column rests.
std::vector<float> wave(std::uint32_t side, std::size_t k, Flat flat = Flat::kNever) {
  std::vector<float> positions;
  for (std::uint32_t v = 0; v < side * side; ++v) {
    const double x = v % side, y = v / side, time = static_cast<double>(k);
    const double z = (0.3 + 0.1 * x) * std::sin(0.7 * x + 0.4 * y + 0.9 * time) * (x > 0 ? 1 : 0);
    const double share = is_flat(flat, k) ? 0 : 1;
    positions.insert(positions.end(),
                     {static_cast<float>(x), static_cast<float>(share * y), static_cast<float>(share * z)});
  }
  return positions;
}

Motion outline(std::uint32_t side, std::size_t keyframes) {
  Motion motion;
  std::vector<std::uint32_t> corners;
  for (std::uint32_t y = 0; y + 1 < side; ++y) {
    for (std::uint32_t x = 0; x + 1 < side; ++x) {
      const std::uint32_t v = y * side + x;
      corners.insert(corners.end(), {v, v + 1, v + side, v + 1, v + side + 1, v + side});
    }
  }
  motion.topology = Topology::triangles(side * side, corners).value();
  for (std::size_t k = 0; k < keyframes; ++k) motion.keyframes.push_back({{}, static_cast<double>(k), ""});
  motion.connect_as_sequence();
  return motion;
}

Motion waving(std::uint32_t side, std::size_t keyframes, Flat flat = Flat::kNever) {
  Motion motion = outline(side, keyframes);
  for (std::size_t k = 0; k < keyframes; ++k) motion.keyframes[k].positions = wave(side, k, flat);
  return motion;
}

struct Way {
  const char* name;
  BakeOptions options;
  std::size_t most_held = 3;
};

std::vector<Way> ways() {
  return {{"exact", {.encoding = BakeEncoding::kExact}},
          {"endpoint", {.encoding = BakeEncoding::kEndpoint}},
          {"harmless", {.encoding = BakeEncoding::kHarmless}},
          {"keys", {.encoding = BakeEncoding::kKeys}, 10},
          {"angles", {.encoding = BakeEncoding::kExact, .weighting = Weighting::kAngle}},
          {"hard edges", {.encoding = BakeEncoding::kExact, .crease_angle = 20}},
          {"zeros", {.encoding = BakeEncoding::kHarmless, .dense_zeros = true}}};
}

void expect_same(const SequenceBake& found, const SequenceBake& expected, const std::string& what) {
  EXPECT_EQ(found.keyframes, expected.keyframes) << what;
  EXPECT_EQ(found.vertices, expected.vertices) << what;
  EXPECT_EQ(found.targets, expected.targets) << what;
  EXPECT_EQ(found.extra_targets, expected.extra_targets) << what;
  EXPECT_EQ(found.bytes, expected.bytes) << what;
  EXPECT_EQ(found.largest_error, expected.largest_error) << what;
  EXPECT_EQ(found.warnings, expected.warnings) << what;
}

TEST(BakeStream, has_the_bytes_of_a_motion_in_memory_and_holds_few_keyframes) {
  const TemporaryFolder folder;
  for (const Flat flat : {Flat::kNever, Flat::kFirst, Flat::kForAWhile}) {
    const Motion whole = waving(9, 12, flat);
    for (const Way& way : ways()) {
      const std::string what = way.name + std::string(", flat ") + std::to_string(static_cast<int>(flat));
      std::string glb;
      const Result<SequenceBake> expected = bake_sequence(whole, way.options, glb);
      ASSERT_TRUE(expected.ok()) << what << ": " << expected.error().text();
      ASSERT_EQ(expected.value().bytes, glb.size()) << what;
      std::size_t most_held = 0;
      MotionStream in_memory(whole), stream = test::strict(in_memory, most_held);
      const Result<SequenceBake> found = bake_sequence(stream, way.options, folder / "out.glb", true);
      ASSERT_TRUE(found.ok()) << what << ": " << found.error().text();
      EXPECT_TRUE(test::read_whole(folder / "out.glb") == glb) << what;
      expect_same(found.value(), expected.value(), what);
      EXPECT_EQ(folder.entry_count(), 1U) << what;
      EXPECT_LE(most_held, way.most_held) << what;
    }
  }
}

TEST(BakeStream, viewers_with_little_room_get_the_bends_that_gain_most_from_a_stream_too) {
  const TemporaryFolder folder;
  const Motion whole = waving(9, 12);
  BakeOptions options = with_viewers({.encoding = BakeEncoding::kHarmless});
  for (Viewer& viewer : options.viewers) viewer.most_targets = 15;
  std::string glb;
  EXPECT_EQ(bake_sequence(whole, options, glb).value().extra_targets, 4U);
  std::size_t most_held = 0;
  MotionStream in_memory(whole), stream = test::strict(in_memory, most_held);
  ASSERT_TRUE(bake_sequence(stream, options, folder / "out.glb", false).ok());
  EXPECT_TRUE(test::read_whole(folder / "out.glb") == glb);
  EXPECT_LE(most_held, 3U);
}

TEST(BakeStream, has_the_same_bytes_of_every_format_that_can_be_read_one_keyframe_at_a_time) {
  const TemporaryFolder folder;
  const Motion motion = waving(9, 7);
  for (const char* const name : {"walk.npz", "walk.pc2", "walk.mdd", "walk_%02d.ply", "walk_%02d.obj"})
    ASSERT_TRUE(write_motion(motion, folder / name, false).ok()) << name;
  std::vector<float> coordinates;
  for (const auto& keyframe : motion.keyframes)
    coordinates.insert(coordinates.end(), keyframe.positions.begin(), keyframe.positions.end());
  folder.write("walk.npy", test::npy(test::npy_header("<f4", "(7, 81, 3)"), test::raw(coordinates)));
  const std::string mesh = folder / "walk_00.obj";
  const std::vector<std::vector<std::string>> inputs = {{folder / "walk.npz"},       {mesh, folder / "walk.pc2"},
                                                        {mesh, folder / "walk.mdd"}, {mesh, folder / "walk.npy"},
                                                        {folder / "walk_*.ply"},     {folder / "walk_*.obj"}};
  for (const auto& names : inputs) {
    InputOptions options = test::files(names, 24);
    const Motion whole = test::read_motion(options).value();
    options.stream = true;
    options.kept_bytes = 0;
    for (const BakeEncoding encoding : {BakeEncoding::kExact, BakeEncoding::kHarmless}) {
      std::string glb;
      ASSERT_TRUE(bake_sequence(whole, {.encoding = encoding}, glb).ok());
      Result<Input> input = open_input(options);
      ASSERT_TRUE(input.ok()) << input.error().text();
      MotionStream& stream = *input.value().stream().value();
      ASSERT_FALSE(stream.keeps_all()) << names.back();
      ASSERT_TRUE(bake_sequence(stream, {.encoding = encoding}, folder / "out.glb", true).ok());
      EXPECT_TRUE(test::read_whole(folder / "out.glb") == glb) << names.back();
    }
  }
}

TEST(BakeStream, memory_does_not_grow_with_the_number_of_keyframes) {
  if (test::is_sanitized()) GTEST_SKIP() << "sanitizers take memory of their own";
  const TemporaryFolder folder;
  const auto bake_frames = [&](std::uint32_t side, std::size_t keyframes, BakeEncoding encoding) -> std::string {
    const ThreadLimit one(1);
    MotionStream stream(
        outline(side, keyframes),
        [side](const Motion&, std::size_t k, std::span<float> positions) -> Status {
          const std::vector<float> values = wave(side, k);
          std::copy(values.begin(), values.end(), positions.begin());
          return Success{};
        },
        0);
    const Result<SequenceBake> baked = bake_sequence(stream, {.encoding = encoding}, folder / "out.glb", true);
    return baked ? std::to_string(baked.value().bytes) : baked.error().text();
  };
  for (const BakeEncoding encoding : {BakeEncoding::kExact, BakeEncoding::kHarmless}) {
    const std::uint32_t side = encoding == BakeEncoding::kExact ? 100 : 50;
    std::size_t bytes[2] = {}, growth[2] = {};
    for (const std::size_t i : {0U, 1U}) {
      const std::size_t keyframes = i == 0 ? 20 : 120;
      const test::ChildRun run = test::run_in_child(
          60, [&] { return bake_frames(side, keyframes, encoding); }, [&] { (void)bake_frames(side, 3, encoding); });
      ASSERT_TRUE(run.finished) << run.text;
      bytes[i] = std::stoul(run.text);
      growth[i] = run.peak_growth;
      RecordProperty(std::string(name_of(encoding)) + std::to_string(keyframes), std::to_string(run.peak_growth));
    }
    EXPECT_GT(bytes[1], 5 * bytes[0]);
    // Linux counts the pages of a thread in batches of 64, so each of the two peaks may be wrong by one batch.
    constexpr std::size_t kBatches = 2 * 64 * 4096;
    EXPECT_LT(growth[1], growth[0] + kBatches + (bytes[1] - bytes[0]) / 6) << name_of(encoding);
    EXPECT_LT(kBatches, (bytes[1] - bytes[0]) / 3);  // so an output in memory would fail the test
  }
}

TEST(BakeStream, a_file_that_is_cut_while_it_is_read_is_an_error_and_leaves_nothing) {
  const TemporaryFolder folder;
  const Motion motion = waving(9, 12);
  ASSERT_TRUE(write_motion(motion, folder / "walk.pc2", false).ok());
  ASSERT_TRUE(write_motion(motion, folder / "walk_%02d.obj", false).ok());
  constexpr std::size_t kKeyframe = 12 * 81, kEnd = 32 + 6 * kKeyframe + 100;
  const std::string whole = test::read_whole(folder / "walk.pc2");
  InputOptions options = test::files({folder / "walk_00.obj", folder / "walk.pc2"});
  options.stream = true;
  options.kept_bytes = 0;
  const std::size_t before = folder.entry_count();
  for (const BakeEncoding encoding : {BakeEncoding::kExact, BakeEncoding::kEndpoint, BakeEncoding::kHarmless}) {
    // The callback for progress shortens the input file, before or after the bake has written some arrays.
    for (const std::size_t step : {0U, 2U, 4U, 12U}) {
      if (encoding != BakeEncoding::kHarmless && step == 12) continue;  // by then, such bakes have read everything
      folder.write("walk.pc2", whole);
      Result<Input> input = open_input(options);
      ASSERT_TRUE(input.ok());
      const auto cut = [&] { std::filesystem::resize_file(folder / "walk.pc2", kEnd); };
      if (step == 0) cut();
      BakeOptions how{.encoding = encoding};
      how.progress = [&](std::size_t done, std::size_t) {
        if (done == step) cut();
      };
      const Result<SequenceBake> baked = bake_sequence(*input.value().stream().value(), how, folder / "out.glb", false);
      ASSERT_FALSE(baked.ok()) << name_of(encoding) << step;
      EXPECT_EQ(baked.error().code, ErrorCode::kFailed);
      EXPECT_EQ(baked.error().place, folder / "walk.pc2");
      EXPECT_NE(baked.error().message.find(" to " + grouped(kEnd) + " bytes while it was read"), std::string::npos)
          << baked.error().message;
      EXPECT_EQ(folder.entry_count(), before) << name_of(encoding) << step;
    }
  }
}

TEST(BakeStream, a_keyframe_that_cannot_be_read_ends_it_in_whatever_pass) {
  const TemporaryFolder folder;
  const Motion whole = waving(4, 8);
  for (const Way& way : ways()) {
    std::string glb;
    ASSERT_TRUE(bake_sequence(whole, way.options, glb).ok()) << way.name;
    for (std::size_t failing = 0, read = 1; failing < read; ++failing) {
      read = 0;
      MotionStream stream(
          outline(4, 8),
          [&](const Motion&, std::size_t k, std::span<float> positions) -> Status {
            if (read++ == failing)
              return Error{ErrorCode::kFailed, "keyframe " + std::to_string(k), "the disk is gone"};
            std::copy(whole.keyframes[k].positions.begin(), whole.keyframes[k].positions.end(), positions.begin());
            return Success{};
          },
          0);
      const Result<SequenceBake> baked = bake_sequence(stream, way.options, folder / "out.glb", false);
      if (baked.ok()) {  // the bake had read the missing part before, or did not need it
        EXPECT_TRUE(test::read_whole(folder / "out.glb") == glb) << way.name << failing;
        std::filesystem::remove(folder / "out.glb");
        continue;
      }
      EXPECT_EQ(baked.error().message, "the disk is gone") << way.name << failing;
      EXPECT_EQ(folder.entry_count(), 0U) << way.name << failing;
    }
  }
}

TEST(BakeStream, what_a_motion_in_memory_is_refused_for_a_stream_is_too) {
  const TemporaryFolder folder;
  Motion far = waving(5, 6), twice = waving(5, 6);
  far.keyframes[0].positions[7] = -3e38F;
  far.keyframes[4].positions[7] = 3e38F;
  twice.keyframes[3].time = twice.keyframes[2].time;
  for (const Motion* const motion : {&far, &twice}) {
    std::string glb = "old";
    const Result<SequenceBake> expected = bake_sequence(*motion, {}, glb);
    ASSERT_FALSE(expected.ok());
    EXPECT_EQ(glb, "old");
    std::size_t most_held = 0;
    MotionStream in_memory(*motion), stream = test::strict(in_memory, most_held);
    const Result<SequenceBake> found = bake_sequence(stream, {}, folder / "out.glb", false);
    ASSERT_FALSE(found.ok());
    EXPECT_EQ(found.error().text(), expected.error().text());
    EXPECT_EQ(found.error().code, ErrorCode::kInvalidInput);
    EXPECT_EQ(folder.entry_count(), 0U);
  }
}

TEST(BakeStream, a_file_that_is_there_stays_unless_it_may_be_replaced) {
  const TemporaryFolder folder;
  folder.write("out.glb", "old");
  const Motion motion = waving(5, 3);
  MotionStream stream(motion);
  const Result<SequenceBake> refused = bake_sequence(stream, {}, folder / "out.glb", false);
  ASSERT_FALSE(refused.ok());
  EXPECT_NE(refused.error().message.find("exists already"), std::string::npos);
  BakeOptions small;
  small.most_bytes = 100;
  EXPECT_FALSE(bake_sequence(stream, small, folder / "out.glb", true).ok());
  EXPECT_EQ(test::read_whole(folder / "out.glb"), "old");
  EXPECT_EQ(folder.entry_count(), 1U);
}

}  // namespace
}  // namespace chronormal::bake_stream_test
