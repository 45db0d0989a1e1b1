#include "chronormal/io/motion_files.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "chronormal/motion/motion.h"
#include "tests/support/cache_bytes.h"
#include "tests/support/random_mesh.h"
#include "tests/support/temporary_folder.h"

namespace chronormal {
namespace {

constexpr const char* kObj = "v 9 9 9\nv 8 8 8\nv 7 7 7\nf 1 2 3\n";

class MotionFiles : public ::testing::Test {
 protected:
  MotionFiles() {
    folder_.write("body.obj", kObj);
    folder_.write("walk.pc2", test::small_pc2(40, 2));
    folder_.write("walk.mdd", test::small_mdd(0, 0.5F));
    folder_.write("walk.npy",
                  test::npy(test::npy_header("<f4", "(2, 3, 3)"), test::raw(test::turning_elements<float>(false))));
    folder_.write("c.xml", test::maya_xml("OneFile", "mcx", 125, 250, 375));
    folder_.write("c.mcx", test::small_maya<double>(true));
    folder_.write("walk.npz", test::small_npz(true));
    folder_.write("imp.md2", test::small_md2());
    folder_.write("unnamed", test::small_npz(true));
  }
  [[nodiscard]] Result<Motion> read(const std::vector<std::string>& names, double frames_per_second = 1) const {
    std::vector<std::string> paths;
    for (const std::string& name : names) paths.push_back(folder_ / name);
    return read_motion(paths, {frames_per_second, "", false, false});
  }
  void expect_turning(const std::vector<std::string>& names, double first, double second, double rate = 1) const {
    SCOPED_TRACE(names.front());
    const Result<Motion> motion = read(names, rate);
    ASSERT_TRUE(motion.ok()) << motion.error().text();
    EXPECT_TRUE(validate(motion.value()).ok());
    EXPECT_EQ(motion.value().topology, Topology::triangles(3, {0, 1, 2}).value());
    ASSERT_EQ(motion.value().keyframes.size(), 2U);
    EXPECT_EQ(motion.value().keyframes[0].time, first);
    EXPECT_EQ(motion.value().keyframes[1].time, second);
    EXPECT_EQ(motion.value().keyframes[0].positions, test::kTurning[0]);
    EXPECT_EQ(motion.value().keyframes[1].positions, test::kTurning[1]);
  }
  void expect_error(const std::vector<std::string>& names, ErrorCode code, const std::string& part) const {
    const Result<Motion> motion = read(names);
    ASSERT_FALSE(motion.ok()) << part;
    EXPECT_EQ(motion.error().code, code) << motion.error().text();
    EXPECT_NE(motion.error().text().find(part), std::string::npos) << motion.error().text();
  }

  test::TemporaryFolder folder_;
};

TEST_F(MotionFiles, caches_over_a_mesh_are_read_in_either_order) {
  expect_turning({"body.obj", "walk.pc2"}, 40, 42);
  expect_turning({"walk.pc2", "body.obj"}, 20, 21, 2);
  expect_turning({"body.obj", "walk.mdd"}, 0, 0.5, 2);
  expect_turning({"body.obj", "walk.npy"}, 0, 0.5, 2);
  expect_turning({"body.obj", "c.xml"}, 250.0 / 6000, 375.0 / 6000);
  expect_turning({"c.xml#body", "body.obj"}, 250.0 / 6000, 375.0 / 6000);
  expect_turning({"body.obj", "c.mcx"}, 250.0 / 6000, 375.0 / 6000);
  expect_turning({"body.obj", "c.mcx#body"}, 250.0 / 6000, 375.0 / 6000);
  expect_turning({"b*.obj", "walk.pc2"}, 40, 42);
}

TEST_F(MotionFiles, whole_motions_are_read_by_name_and_by_content) {
  expect_turning({"walk.npz"}, 0.5, 2, 7);
  expect_turning({"unnamed"}, 0.5, 2);
  const Result<Motion> imp = read({"imp.md2"}, 10);
  ASSERT_TRUE(imp.ok()) << imp.error().text();
  EXPECT_EQ(imp.value().keyframes[1].time, 0.1);
}

TEST_F(MotionFiles, everything_else_is_a_sequence) {
  folder_.write("body2.obj", kObj);
  EXPECT_TRUE(read({"body.obj", "body2.obj"}).ok());
  EXPECT_TRUE(read({"body*.obj"}).ok());
  expect_error({"body.obj"}, ErrorCode::kInvalidInput, "a sequence needs two frames or more");
  expect_error({"none.obj", "body.obj"}, ErrorCode::kFailed, "o such file");
}

TEST_F(MotionFiles, inputs_that_do_not_go_together_are_misuse) {
  expect_error({"walk.pc2"}, ErrorCode::kUsage, "give it together with one mesh");
  expect_error({"walk.pc2", "walk.mdd"}, ErrorCode::kUsage, "give it together with one mesh");
  expect_error({"body.obj", "walk.pc2", "body.obj"}, ErrorCode::kUsage, "give it together with one mesh");
  expect_error({"body.obj", "walk.npz"}, ErrorCode::kUsage, "give it alone");
  folder_.write("body2.obj", kObj);
  expect_error({"body*.obj", "walk.pc2"}, ErrorCode::kUsage, "stands for 2 files");
  EXPECT_EQ(read({"walk.npz"}, 0).error().code, ErrorCode::kUsage);
}

TEST_F(MotionFiles, errors_name_the_file) {
  folder_.write("small.obj", "v 0 0 0\nf 1 1 1\n");
  expect_error({"small.obj", "walk.pc2"}, ErrorCode::kInvalidInput,
               "walk.pc2: it has 3 vertices, but the mesh small.obj has 1");
  folder_.write("cut.mdd", test::small_mdd(0, 1).substr(0, 40));
  expect_error({"body.obj", "cut.mdd"}, ErrorCode::kInvalidInput, "cut.mdd, byte 8: ");
  folder_.write("twice.mdd", test::small_mdd(1, 1));
  expect_error({"body.obj", "twice.mdd"}, ErrorCode::kInvalidInput, "twice.mdd, sample 1: its time, 1 s, is not after");
  folder_.write("text", "hello");
  expect_error({"text"}, ErrorCode::kInvalidInput, "text: neither the name nor the content");
  expect_error({"body.obj", "none.mdd"}, ErrorCode::kFailed, "none.mdd");
  expect_error({"none.npz"}, ErrorCode::kFailed, "none.npz");
}

TEST_F(MotionFiles, progress_counts_files) {
  std::vector<std::size_t> calls;
  const auto progress = [&](std::size_t done, std::size_t total) { calls.push_back(10 * done + total); };
  ASSERT_TRUE(read_motion(std::vector{folder_ / "body.obj", folder_ / "walk.mdd"}, {}, progress).ok());
  ASSERT_TRUE(read_motion(std::vector{folder_ / "walk.npz"}, {}, progress).ok());
  EXPECT_EQ(calls, (std::vector<std::size_t>{12, 22, 11}));
}

TEST_F(MotionFiles, what_was_written_reads_back) {
  const Motion motion = test::turning_motion(3, 5);
  for (const char* const name : {"out.npz", "out.PC2", "out.mdd"})
    ASSERT_TRUE(write_motion(motion, folder_ / name, false).ok()) << name;
  expect_turning({"out.npz"}, 3, 5);
  expect_turning({"body.obj", "out.PC2"}, 3, 5);
  expect_turning({"body.obj", "out.mdd"}, 3, 5);
  ASSERT_TRUE(write_motion(motion, folder_ / "out_%d.ply", false).ok());
  expect_turning({"out_*.ply"}, 0, 1);
}

TEST_F(MotionFiles, nothing_is_overwritten_without_force_or_left_after_an_error) {
  Motion motion = test::turning_motion(3, 5);
  const Status status = write_motion(motion, folder_ / "walk.npz", false);
  ASSERT_FALSE(status.ok());
  EXPECT_NE(status.error().message.find("--force"), std::string::npos);
  EXPECT_TRUE(write_motion(motion, folder_ / "walk.npz", true).ok());
  motion.segments.clear();
  const std::size_t entries = folder_.entry_count();
  const Status refused = write_motion(motion, folder_ / "new.mdd", false);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::kUsage);
  EXPECT_EQ(refused.error().place, folder_ / "new.mdd");
  EXPECT_EQ(folder_.entry_count(), entries);
}

}  // namespace
}  // namespace chronormal
