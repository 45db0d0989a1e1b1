// Tests morph targets over a base, read by open_input().
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "chronormal/motion/motion.h"
#include "tests/support/no_descriptors.h"
#include "tests/support/read_input.h"
#include "tests/support/target_bytes.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::targets_test {
namespace {

using test::gzip, test::kLiftTarget, test::kSquare, test::kSquareObj, test::TemporaryFolder;
using Names = std::vector<std::string>;

// A square whose last vertex is raised.
const std::string kRaisedObj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 2\nf 1 2 3\nf 1 3 4\n";
const std::vector<float> kLifted = {0, 0, 0, 0.75F, 0.125F, 0.1F, 1, 1, 0, 0, 1, 0.5F};

Error error_of(const Result<Motion>& result) {
  if (result) {
    ADD_FAILURE() << "no error";
    return {};
  }
  return result.error();
}

// Returns the names of the keyframes, or a list with only the error.
Names names_of(const Result<Motion>& motion) {
  if (!motion) return {motion.error().text()};
  Names names;
  for (const Motion::Keyframe& keyframe : motion.value().keyframes) names.push_back(keyframe.name);
  return names;
}

Result<Motion> read_over(const std::string& base, const Names& inputs,
                         const std::function<void(std::size_t done, std::size_t total)>& progress = {}) {
  InputOptions options = test::targets_over(base, inputs);
  options.progress = progress;
  return test::read_motion(options);
}

class Targets : public ::testing::Test {
 protected:
  [[nodiscard]] Result<Motion> read(const Names& inputs) const { return read_over(base_, inputs); }
  void make_folder(const std::string& name) const { std::filesystem::create_directories(folder_ / name); }

  TemporaryFolder folder_;
  std::string base_ = folder_.write("base.obj", kSquareObj);
};

TEST_F(Targets, are_a_star_from_the_base_with_names_and_times) {
  const std::string lift = folder_.write("lift.target", kLiftTarget),
                    packed = folder_.write("packed.target.gz", gzip(kLiftTarget)),
                    raised = folder_.write("raised.v2.obj", kRaisedObj);
  Names steps;
  const Result<Motion> result = read_over(base_, Names{raised, lift, packed}, [&](std::size_t done, std::size_t total) {
    steps.push_back(std::to_string(done) + "/" + std::to_string(total));
  });
  ASSERT_TRUE(result.ok()) << result.error().text();
  const Motion& motion = result.value();
  EXPECT_TRUE(validate(motion).ok());
  EXPECT_EQ(names_of(result), (Names{"base", "raised.v2", "lift", "packed"}));
  EXPECT_EQ(steps, (Names{"1/4", "2/4", "3/4", "4/4"}));
  EXPECT_EQ(motion.topology.face_count(), 2U);
  ASSERT_EQ(motion.segments.size(), 3U);
  for (std::size_t s = 0; s < 3; ++s) {
    EXPECT_EQ(motion.segments[s].from, 0U);
    EXPECT_EQ(motion.segments[s].to, s + 1);
    EXPECT_EQ(motion.segment(s).start_time, 0.0);
    EXPECT_EQ(motion.segment(s).end_time, 1.0);
  }
  EXPECT_EQ(motion.keyframes[0].positions, kSquare);
  EXPECT_EQ(motion.keyframes[1].positions[11], 2.0F);
  EXPECT_EQ(motion.keyframes[2].positions, kLifted);
  EXPECT_EQ(motion.keyframes[3].positions, kLifted);
}

TEST_F(Targets, one_target_is_a_motion) {
  const Result<Motion> motion = read({folder_.write("lift.target", kLiftTarget)});
  ASSERT_TRUE(motion.ok()) << motion.error().text();
  EXPECT_EQ(motion.value().segments.size(), 1U);
}

TEST_F(Targets, names_lose_their_extensions_in_upper_and_lower_case) {
  EXPECT_EQ(names_of(read({folder_.write("a.TARGET", kLiftTarget), folder_.write("b.Target.GZ", gzip(kLiftTarget)),
                           folder_.write("c.d.target", kLiftTarget), folder_.write("e.target.target", kLiftTarget),
                           folder_.write("f.target.obj", kRaisedObj)})),
            (Names{"base", "a", "b", "c.d", "e.target", "f.target"}));
}

TEST_F(Targets, folder_is_read_with_all_folders_in_it_by_path_and_number) {
  make_folder("t/10");
  make_folder("t/9/deep");
  make_folder("t/.hidden");
  folder_.write("t/10/a.target", kLiftTarget);
  folder_.write("t/9/b_10.target.gz", gzip(kLiftTarget));
  folder_.write("t/9/b_2.target", kLiftTarget);
  folder_.write("t/9/deep/c.target", kLiftTarget);
  folder_.write("t/.hidden/d.target", "not a target");
  folder_.write("t/.e.target", "not a target");
  folder_.write("t/notes.txt", "notes");
  std::filesystem::create_symlink(folder_ / "nowhere", folder_ / "t/dangling.txt");
  std::filesystem::create_directory_symlink(folder_ / "t", folder_ / "t/loop");
  const Names expected = {"base", "b_2", "b_10", "c", "a"};
  EXPECT_EQ(names_of(read({folder_ / "t"})), expected);
  EXPECT_EQ(names_of(read({folder_ / "t/"})), expected);
  EXPECT_EQ(names_of(read({folder_ / "t/*/b_*.target*"})), (Names{"base", "b_2", "b_10"}));
}

TEST_F(Targets, base_may_lie_among_its_targets) {
  folder_.write("smile.obj", kRaisedObj);
  const Names expected = {"base", "smile"};
  EXPECT_EQ(names_of(read({folder_.path()})), expected);
  EXPECT_EQ(names_of(read({folder_ / "*.obj"})), expected);
  EXPECT_EQ(names_of(read({base_, folder_ / "smile.obj"})), expected);
  EXPECT_EQ(names_of(read_over(folder_ / "./base.obj", Names{folder_.path()})), expected);
  const Error alone = error_of(read({base_}));
  EXPECT_EQ(alone.code, ErrorCode::kInvalidInput);
  EXPECT_EQ(alone.text(), base_ + ": there is no target beside the base; name the files of the targets");
  // A folder of MakeHuman targets may also contain the base, an OBJ file. The base then does not count as a second
  // format.
  make_folder("mh");
  const std::string base = folder_.write("mh/base.obj", kSquareObj);
  folder_.write("mh/lift.target", kLiftTarget);
  EXPECT_EQ(names_of(read_over(base, Names{folder_ / "mh"})), (Names{"base", "lift"}));
}

TEST_F(Targets, folder_without_targets_or_with_several_formats_is_an_error) {
  make_folder("t/in");
  const Error none = error_of(read({folder_ / "t"}));
  EXPECT_EQ(none.code, ErrorCode::kInvalidInput);
  EXPECT_EQ(none.text(), folder_ / "t" +
                             ": the folder has no targets beside the base; put targets there (.obj, .ply, .target or "
                             ".target.gz), or name other files");
  folder_.write("t/a.obj", kRaisedObj);
  folder_.write("t/in/b.target", kLiftTarget);
  const Error both = error_of(read({folder_ / "t"}));
  EXPECT_EQ(both.code, ErrorCode::kInvalidInput);
  EXPECT_EQ(both.place, folder_ / "t");
  EXPECT_NE(both.message.find("the folder has both "), std::string::npos) << both.message;
  EXPECT_NE(both.message.find(folder_ / "t/in/b.target"), std::string::npos) << both.message;
  EXPECT_EQ(names_of(read({folder_ / "t/*.obj", folder_ / "t/in"})), (Names{"base", "a", "b"}));
}

TEST_F(Targets, folder_that_cannot_be_listed_is_an_error_with_its_name) {
  make_folder("t");
  const Error error = [&] {
    const test::NoDescriptors none;
    return error_of(read({folder_ / "t"}));
  }();
  EXPECT_EQ(error.code, ErrorCode::kFailed);
  EXPECT_EQ(error.text(), folder_ / "t" + ": Too many open files");
}

TEST_F(Targets, errors_have_the_file_as_their_place) {
  const auto place_of = [&](const std::string& name, const std::string& bytes) {
    const Error error = error_of(read({folder_.write(name, bytes)}));
    EXPECT_EQ(error.code, ErrorCode::kInvalidInput) << error.text();
    return error.place;
  };
  EXPECT_EQ(place_of("a.target", "0 1 1 1\n9 1 1 1\n"), folder_ / "a.target" + ", line 2");
  EXPECT_EQ(place_of("b.target.gz", gzip(kLiftTarget).substr(0, 30)), folder_ / "b.target.gz" + ", byte 30");
  EXPECT_EQ(place_of("c.obj", "v 0 0 nan\n"), folder_ / "c.obj" + ", line 1");
  EXPECT_EQ(place_of("d.obj", "v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n"), folder_ / "d.obj");
  EXPECT_EQ(place_of("e.stl", "solid\n"), folder_ / "e.stl");
  const Error faces = error_of(read({folder_.write("f.obj", kSquareObj.substr(0, 32) + "f 1 3 2\nf 1 3 4\n")}));
  EXPECT_EQ(faces.text(),
            folder_ / "f.obj" + ": face 0 differs from the base; give files that all have the same faces");

  const Error missing = error_of(read({folder_ / "no.target"}));
  EXPECT_EQ(missing.code, ErrorCode::kFailed);
  EXPECT_TRUE(missing.text().starts_with(folder_ / "no.target")) << missing.text();
  const std::string lift = folder_.write("lift.target", kLiftTarget);
  const Error no_base = error_of(read_over(folder_ / "no.obj", Names{lift}));
  EXPECT_EQ(no_base.code, ErrorCode::kFailed);
  EXPECT_EQ(no_base.place, folder_ / "no.obj");
  const Error bad_base = error_of(read_over(lift, Names{base_}));
  EXPECT_EQ(bad_base.place, lift);
  EXPECT_EQ(error_of(read_over("-", Names{"-"})).code, ErrorCode::kUsage);
  EXPECT_EQ(error_of(read({})).code, ErrorCode::kUsage);
}

}  // namespace
}  // namespace chronormal::targets_test
