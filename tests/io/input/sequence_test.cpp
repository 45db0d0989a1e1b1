#include "io/input/sequence.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "chronormal/io/output.h"
#include "chronormal/motion/motion.h"
#include "io/mesh/ply.h"
#include "tests/support/no_descriptors.h"
#include "tests/support/ply_bytes.h"
#include "tests/support/read_input.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::sequence_test {
namespace {

using test::TemporaryFolder;
using Names = std::vector<std::string>;

std::string obj(int height, const std::string& faces = "f 1 2 3\nf 1 3 4\n") {
  return "v 0 0 " + std::to_string(height) + "\nv 1 0 0\nv 1 1 0\nv 0 1 0\n" + faces;
}

template <class T>
Error error_of(const Result<T>& result) {
  if (result) {
    ADD_FAILURE() << "no error";
    return {};
  }
  return result.error();
}

Names names_of(const Result<Names>& files) {
  Names names;
  if (!files) return {files.error().text()};
  for (const std::string& file : files.value()) names.push_back(std::filesystem::path(file).filename().string());
  return names;
}

Result<Motion> read(const Names& inputs, double frames_per_second = 1) {
  InputOptions options = test::files(inputs, frames_per_second);
  const Result<Names> files = find_frames(options);
  if (!files) return files.error();
  Result<ReadMotion> read = read_sequence(files.value(), options);
  if (!read) return read.error();
  return std::move(read).value().motion;
}

TEST(FindFrames, folder_and_pattern_are_sorted_by_number) {
  const TemporaryFolder folder;
  for (const char* const name : {"f_10.obj", "f_2.obj", "f_1.OBJ", "f_03.obj", "f_99999999999999999999.obj",
                                 "f_100000000000000000000.obj", "notes.txt", ".hidden.obj"})
    folder.write(name, "");
  const Names expected = {
      "f_1.OBJ", "f_2.obj", "f_03.obj", "f_10.obj", "f_99999999999999999999.obj", "f_100000000000000000000.obj"};
  EXPECT_EQ(names_of(find_frames(test::files(Names{folder.path()}))), expected);
  EXPECT_EQ(names_of(find_frames(test::files(Names{folder.path() + "/"}))), expected);
  EXPECT_EQ(names_of(find_frames(test::files(Names{folder / "f_[0-9]*.obj"}))),
            (Names{"f_2.obj", "f_03.obj", "f_10.obj", "f_99999999999999999999.obj", "f_100000000000000000000.obj"}));
  EXPECT_EQ(names_of(find_frames(test::files(Names{folder / "f_?.obj"}))), (Names{"f_2.obj"}));
}

TEST(FindFrames, folder_and_pattern_of_several_sequences_are_errors_that_list_them) {
  const TemporaryFolder folder;
  for (const char* const name : {"walk_1.obj", "walk_2.obj", "run_1.obj", "run_2.obj", "run_3.obj"})
    folder.write(name, "");
  for (const std::string& input : {folder.path(), folder / "*.obj"}) {
    const Error error = error_of(find_frames(test::files(Names{input})));
    EXPECT_EQ(error.code, ErrorCode::kInvalidInput);
    EXPECT_EQ(error.place, input);
    EXPECT_NE(error.message.find("run_1.obj ... run_3.obj (3 files), walk_1.obj ... walk_2.obj (2 files)"),
              std::string::npos)
        << error.message;
  }
  EXPECT_EQ(names_of(find_frames(test::files(Names{folder / "walk_*.obj", folder / "run_*.obj"}))).size(), 5U);
}

TEST(FindFrames, files_that_a_shell_lists_are_sorted_with_a_note) {
  const TemporaryFolder folder;
  Names listed;
  for (const int k : {0, 1, 10, 11, 2}) listed.push_back(folder.write("f" + std::to_string(k) + ".obj", obj(k)));
  Result<Input> input = open_input(test::files(listed));
  ASSERT_TRUE(input.ok()) << input.error().text();
  EXPECT_EQ(input.value().name(), "f0.obj ... f11.obj");
  ASSERT_EQ(input.value().notes().size(), 2U);
  EXPECT_NE(input.value().notes()[0].find("in the order of their numbers"), std::string::npos)
      << input.value().notes()[0];
  EXPECT_NE(input.value().notes()[1].find("not evenly spaced"), std::string::npos) << input.value().notes()[1];
  std::vector<double> times, heights;
  for (const Motion::Keyframe& keyframe : input.value().motion().value()->keyframes) {
    times.push_back(keyframe.time);
    heights.push_back(keyframe.positions[2]);
  }
  EXPECT_EQ(times, (std::vector<double>{0, 1, 2, 10, 11}));
  EXPECT_EQ(heights, times);
}

TEST(ReadSequence, fractions_in_names_are_seconds_and_refuse_a_frame_rate) {
  const TemporaryFolder folder;
  for (const char* const time : {"0", "0.05", "0.1", "0.15", "0.2"})
    folder.write(std::string("t_") + time + ".obj", obj(0));
  for (const bool stream : {false, true}) {
    InputOptions options = test::files({folder.path()});
    options.stream = stream;
    options.kept_bytes = 0;
    Result<Input> input = open_input(options);
    ASSERT_TRUE(input.ok()) << input.error().text();
    EXPECT_EQ(input.value().key_times().value(), (std::vector<double>{0, 0.05, 0.1, 0.15, 0.2}));
    EXPECT_EQ(input.value().series()->last, 0.2);
    options.frames_per_second = 24;
    const Error error = error_of(open_input(options));
    EXPECT_EQ(error.code, ErrorCode::kUsage);
    EXPECT_EQ(error.place, "--fps");
  }
}

TEST(FindFrames, listed_files_keep_their_order_and_may_come_twice) {
  const TemporaryFolder folder;
  const std::string a = folder.write("a_1.obj", ""), b = folder.write("a_2.obj", "");
  EXPECT_EQ(names_of(find_frames(test::files(Names{b, a, b}))), (Names{"a_2.obj", "a_1.obj", "a_2.obj"}));
  EXPECT_EQ(names_of(find_frames(test::files(Names{b, "-"}))), (Names{"a_2.obj", "-"}));
}

TEST(FindFrames, file_whose_name_looks_like_a_pattern_is_a_file) {
  const TemporaryFolder folder;
  folder.write("a1.obj", "");
  EXPECT_EQ(names_of(find_frames(test::files(Names{folder / "a[1].obj"}))), (Names{"a1.obj"}));
  folder.write("a[1].obj", "");
  EXPECT_EQ(names_of(find_frames(test::files(Names{folder / "a[1].obj"}))), (Names{"a[1].obj"}));
}

TEST(FindFrames, a_name_that_outputs_are_given_by_stands_for_its_numbered_files) {
  const TemporaryFolder folder;
  for (const char* name : {"a_2.obj", "a_10.obj", "a_1b.obj", "a_.obj", "a_003.obj", "b_1.obj", "a_4.ply"})
    (void)folder.write(name, "");
  const Names expected{"a_2.obj", "a_003.obj", "a_10.obj"};
  EXPECT_EQ(names_of(find_frames(test::files(Names{folder / "a_%d.obj"}))), expected);
  EXPECT_EQ(names_of(find_frames(test::files(Names{folder / "a_%04d.obj"}))), expected);
  for (const char* name : {"c_%d.obj", "a_%x.obj", "a_%.obj", "%d_%d.obj"}) {
    const Error missing = error_of(find_frames(test::files(Names{folder / name})));
    EXPECT_EQ(missing.code, ErrorCode::kFailed) << name;
    EXPECT_NE(missing.text().find(folder / name + ": "), std::string::npos) << missing.text();
  }
  (void)folder.write("d\\\\\\e_7.obj", "");
  EXPECT_EQ(names_of(find_frames(test::files(Names{folder / "d\\\\\\e_%d.obj"}))), (Names{"d\\\\\\e_7.obj"}));
  (void)folder.write("fg_7.obj", "");
  EXPECT_EQ(error_of(find_frames(test::files(Names{folder / "\\f\\g_%d.obj"}))).code, ErrorCode::kFailed);
  // If a file has exactly the name a_%d.obj, this name is not a pattern.
  (void)folder.write("a_%d.obj", "");
  EXPECT_EQ(names_of(find_frames(test::files(Names{folder / "a_%d.obj"}))), (Names{"a_%d.obj"}));
}

TEST(FindFrames, what_is_not_there_is_an_error_with_its_name) {
  const TemporaryFolder folder;
  const Error missing = error_of(find_frames(test::files(Names{folder / "no.obj"})));
  EXPECT_EQ(missing.code, ErrorCode::kFailed);
  EXPECT_EQ(missing.text(), folder / "no.obj" + ": No such file or directory");
  const Error unmatched = error_of(find_frames(test::files(Names{folder / "no_*.obj"})));
  EXPECT_EQ(unmatched.code, ErrorCode::kFailed);
  EXPECT_EQ(unmatched.text(),
            folder / "no_*.obj" + ": no file has this name or matches this pattern; check the name and the folder");
  EXPECT_EQ(error_of(find_frames(test::files(Names{"-", "-"}))).code, ErrorCode::kUsage);
  const Error empty = error_of(find_frames(test::files(Names{folder.path()})));
  EXPECT_EQ(empty.code, ErrorCode::kInvalidInput);
  EXPECT_EQ(empty.text(),
            folder.path() +
                ": the folder has no mesh files (.obj or .ply) to be keyframes; name another folder, or a single file");
}

TEST(FindFrames, folder_that_cannot_be_listed_is_an_error_with_its_name) {
  const TemporaryFolder folder;
  (void)folder.write("a.obj", obj(0));
  const Error error = [&] {
    const test::NoDescriptors none;
    return error_of(find_frames(test::files(Names{folder.path()})));
  }();
  EXPECT_EQ(error.code, ErrorCode::kFailed);
  EXPECT_EQ(error.text(), folder.path() + ": Too many open files");
}

TEST(FindFrames, folder_of_two_formats_is_an_error_that_says_what_to_do) {
  const TemporaryFolder folder;
  folder.write("a.obj", "");
  folder.write("a.ply", "");
  const Error error = error_of(find_frames(test::files(Names{folder.path()})));
  EXPECT_EQ(error.code, ErrorCode::kInvalidInput);
  EXPECT_EQ(error.place, folder.path());
  EXPECT_NE(error.message.find("choose one kind with a pattern such as '" + folder / "*."), std::string::npos)
      << error.message;
}

TEST(ReadSequence, frames_become_keyframes_with_names_and_times) {
  const TemporaryFolder folder;
  for (const int k : {1, 2, 10}) folder.write("w_" + std::to_string(k) + ".obj", obj(k));
  Names steps;
  InputOptions options = test::files({folder.path()}, 4);
  options.progress = [&](std::size_t done, std::size_t total) {
    steps.push_back(std::to_string(done) + "/" + std::to_string(total));
  };
  const Result<Motion> motion = test::read_motion(options);
  ASSERT_TRUE(motion.ok()) << motion.error().text();
  ASSERT_EQ(motion.value().keyframes.size(), 3U);
  EXPECT_EQ(motion.value().segments.size(), 2U);
  EXPECT_EQ(motion.value().keyframes[2].name, "w_10.obj");
  EXPECT_EQ(motion.value().keyframes[2].positions[2], 10.0F);
  EXPECT_EQ(motion.value().keyframes[2].time, 2.25);  // number 10 is 9 frames after number 1
  EXPECT_EQ(steps, (Names{"1/3", "2/3", "3/3"}));
  EXPECT_TRUE(validate(motion.value()).ok());
}

TEST(ReadSequence, obj_and_ply_of_one_topology_make_a_motion) {
  const TemporaryFolder folder;
  const std::string ply = folder.write("a.ply", test::small_binary_ply(true));
  const std::string text = folder.write("b.obj", "v 0 0 1\nv 1 0 1\nv 0 1 1\nf 1 2 3\n");
  EXPECT_TRUE(read({ply, text}).ok());
}

// Makes a PLY file of a triangle at z = `height`, with velocities.
std::string moving_ply(int height, const std::string& names = "v") {
  std::string text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  for (const char* const axis : {"x", "y", "z"}) text += "property float " + names + axis + "\n";
  text += "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  for (const char* const place : {"0 0 ", "1 0 ", "0 1 "})
    text += place + std::to_string(height) + " 1 2 " + std::to_string(height) + "\n";
  return text + "3 0 1 2\n";
}

TEST(ReadSequence, velocities_are_kept_where_they_are_asked_for_and_every_frame_has_them) {
  const TemporaryFolder folder;
  Names files;
  for (int k = 0; k < 3; ++k) files.push_back(folder.write(std::to_string(k) + ".ply", moving_ply(k)));
  const std::string other = folder.write("9.ply", moving_ply(9, "w"));
  EXPECT_TRUE(read(files).value().keyframes[2].velocities.empty());
  const auto open = [](const Names& names, bool stream) -> Result<std::vector<float>> {
    InputOptions options = test::files(names);
    options.velocities = true;
    options.stream = stream;
    options.kept_bytes = 0;
    Result<Input> input = open_input(options);
    if (!input) return input.error();
    const Result<MotionStream*> motion = input.value().stream();
    if (!motion) return motion.error();
    if (const Status held = motion.value()->hold_all(); !held) return held.error();
    return motion.value()->motion().keyframes.back().velocities;
  };
  for (const bool stream : {false, true}) {
    EXPECT_EQ(open(files, stream).value(), (std::vector<float>{1, 2, 2, 1, 2, 2, 1, 2, 2}));
    EXPECT_EQ(error_of(open({files[0], files[1], other}, stream)).text(),
              "frame 2 (9.ply): the file has no velocities, but frame 0 (0.ply) has some; write velocities into all "
              "files of the sequence, or into none");
    const Error late = error_of(open({other, files[1]}, stream));
    EXPECT_EQ(late.place, "frame 1 (1.ply)");
    EXPECT_EQ(late.message.find("the file has velocities, but frame 0"), 0U) << late.message;
  }
}

TEST(ReadSequence, fewer_than_two_frames_is_an_error_that_counts_them) {
  const TemporaryFolder folder;
  const Error one = error_of(read({folder.write("a.obj", obj(0))}));
  EXPECT_EQ(one.code, ErrorCode::kInvalidInput);
  EXPECT_EQ(one.text(), folder / "a.obj" +
                            ": a sequence needs at least two keyframes, but 1 was found; give several .obj or "
                            ".ply files, a quoted pattern or a folder");
  EXPECT_NE(error_of(read({})).text().find("but 0 were found"), std::string::npos);
}

TEST(ReadSequence, topology_that_changes_is_an_error_with_frame_and_face) {
  const TemporaryFolder folder;
  const std::string first = folder.write("w_0.obj", obj(0)), second = folder.write("w_1.obj", obj(1));
  const auto third = [&](const std::string& bytes) {
    const Error error = error_of(read({first, second, folder.write("w_2.obj", bytes)}));
    EXPECT_EQ(error.code, ErrorCode::kInvalidInput);
    return error.text();
  };
  EXPECT_EQ(third(obj(2, "f 1 2 3\nf 1 3 2\n")),
            "frame 2 (w_2.obj): face 1 differs from frame 0; give files that all have the same faces");
  EXPECT_EQ(third(obj(2, "f 1 2 3\nf 1 2 3 4\n")),
            "frame 2 (w_2.obj): face 1 differs from frame 0; give files that all have the same faces");
  EXPECT_EQ(third(obj(2, "f 1 2 3\n")),
            "frame 2 (w_2.obj): this mesh has 1 face, but frame 0 has 2; give files that all have the same faces");
  EXPECT_EQ(third("v 9 9 9\n" + obj(2)),
            "frame 2 (w_2.obj): this mesh has 5 vertices, but frame 0 has 4; give files that all have the same faces");
}

TEST(ReadSequence, error_inside_a_file_has_the_frame_in_its_place) {
  const TemporaryFolder folder;
  const std::string good = folder.write("w_0.obj", obj(0));
  const auto second = [&](const std::string& name, const std::string& bytes) {
    return error_of(read({good, folder.write(name, bytes)}));
  };
  const Error line = second("w_1.obj", "v 0 0 0\nv nan 0 0\n");
  EXPECT_EQ(line.code, ErrorCode::kInvalidInput);
  EXPECT_EQ(line.text(), "frame 1 (w_1.obj), line 2: x of vertex 1: 'nan' is NaN or infinite; write a finite number");
  const std::string ply = test::small_binary_ply(false);
  const Error byte = second("w_1.ply", ply.substr(0, ply.size() - 1));
  EXPECT_TRUE(byte.place.starts_with("frame 1 (w_1.ply), byte ")) << byte.text();
  EXPECT_EQ(second("w_1.stl", "solid\n").place, "frame 1 (w_1.stl)");

  // If the system cannot read a file, the error is kFailed, not kInvalidInput.
  const std::string link = folder / "w_3.obj";
  std::filesystem::create_symlink("/proc/self/mem", link);
  EXPECT_EQ(error_of(read({good, link})).code, ErrorCode::kFailed);
  EXPECT_EQ(error_of(read({good, link})).place, "frame 1 (w_3.obj)");
}

TEST(ReadSequence, frame_rate_must_be_finite_and_positive) {
  const TemporaryFolder folder;
  const std::string a = folder.write("a.obj", obj(0));
  for (const double rate :
       {0.0, -1.0, 1e-320, 1e300, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()})
    EXPECT_EQ(error_of(test::read_motion(test::files({a, a}, rate))).code, ErrorCode::kUsage);
}

Motion three_frames() {
  const TemporaryFolder folder;
  Names files;
  for (int k = 0; k < 3; ++k) files.push_back(folder.write(std::to_string(k) + ".obj", obj(k)));
  return read(files).value();
}

TEST(WriteSequence, what_was_written_reads_back) {
  const Motion motion = three_frames();
  for (const std::string extension : {".obj", ".ply", ".PLY"}) {
    const TemporaryFolder folder;
    const Status status = write_motion(motion, folder / "w_%03d" + extension, false);
    ASSERT_TRUE(status.ok()) << status.error().text();
    EXPECT_EQ(folder.entry_count(), 3U);
    const Result<Motion> back = read({folder.path()});
    ASSERT_TRUE(back.ok()) << back.error().text();
    EXPECT_EQ(back.value().topology, motion.topology);
    EXPECT_EQ(back.value().keyframes[2].name, "w_002" + extension);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(back.value().keyframes[k].positions, motion.keyframes[k].positions);
  }
}

TEST(WriteSequence, pattern_of_another_form_is_a_usage_error) {
  const TemporaryFolder folder;
  const Motion motion = three_frames();
  for (const char* const name : {"w.obj", "w_%d.stl", "w_%d", "w_%d_%d.obj", "w_%3d.obj", "w_%0d.obj", "w_%00d.obj",
                                 "w_%s.obj", "w_%.obj", "w_%%.obj", "w_%0123d.obj", "%d/w.obj"})
    EXPECT_EQ(error_of(write_motion(motion, folder / name, false)).code, ErrorCode::kUsage) << name;
  EXPECT_EQ(folder.entry_count(), 0U);
}

TEST(WriteSequence, one_keyframe_needs_no_number) {
  const TemporaryFolder folder;
  Motion motion = three_frames();
  motion.keyframes.resize(1);
  EXPECT_TRUE(write_motion(motion, folder / "w.obj", false).ok());
  EXPECT_EQ(test::read_whole(folder / "w.obj"), obj(0));
}

TEST(WriteSequence, one_file_that_exists_keeps_all_from_being_written) {
  const TemporaryFolder folder;
  const Motion motion = three_frames();
  folder.write("w_2.obj", "old");
  const Error error = error_of(write_motion(motion, folder / "w_%d.obj", false));
  EXPECT_EQ(error.code, ErrorCode::kFailed);
  EXPECT_EQ(error.place, folder / "w_2.obj");
  EXPECT_EQ(folder.entry_count(), 1U);
  EXPECT_TRUE(write_motion(motion, folder / "w_%d.obj", true).ok());
  EXPECT_EQ(test::read_whole(folder / "w_2.obj"), obj(2));
}

}  // namespace
}  // namespace chronormal::sequence_test
