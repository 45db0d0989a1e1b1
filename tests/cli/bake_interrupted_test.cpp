// Checks that after a failed or killed write, a file has either all of its old content or all of its new content.

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <string>

#include "tests/support/places.h"
#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::bake_interrupted_test {
namespace {

namespace fs = std::filesystem;

class InterruptedBake : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(run("convert --sample cloth -o 'cloth_%d.obj'").exit_code, 0);
    ASSERT_EQ(run("bake 'cloth_*.obj' -o new.glb --no-audit").exit_code, 0);
    whole_ = test::read_whole(folder_ / "new.glb");
    ASSERT_GT(whole_.size(), 1000000u);
  }

  [[nodiscard]] ProcessResult run(const std::string& arguments, const std::string& before = "") const {
    return run_shell(before + kProgram + " " + arguments, folder_.path());
  }
  // Bakes over a file in a folder, and checks that the bake fails with exit code 1 and leaves the file as it was.
  void expect_refused(const std::string& folder) const {
    const ProcessResult result = run("bake 'cloth_*.obj' --force --no-audit -o " + folder + "/old.glb");
    EXPECT_EQ(result.exit_code, 1) << result.err;
    EXPECT_NE(result.err.find(folder + "/old.glb"), std::string::npos) << result.err;
    EXPECT_TRUE(test::read_whole(folder_ / (folder + "/old.glb")) == kOld);
    EXPECT_EQ(entries(folder), 1) << "a temporary file is left";
  }
  // Mounts a disk of the given size in kilobytes as the folder `small`. Only root can mount a disk, so the test is
  // skipped for other users.
  void mount_disk_of(std::size_t kilobytes) const {
    fs::create_directory(folder_ / "small");
    const std::string mount = "mount -t tmpfs -o size=" + std::to_string(kilobytes) + "k none small";
    if (run_shell(mount, folder_.path()).exit_code != 0) GTEST_SKIP() << "no small file system can be mounted here";
  }
  void expect_refused_on_a_disk_of(std::size_t kilobytes) const {
    mount_disk_of(kilobytes);
    if (IsSkipped()) return;
    folder_.write("small/old.glb", kOld);
    expect_refused("small");
    EXPECT_EQ(run_shell("umount small", folder_.path()).exit_code, 0);
  }
  [[nodiscard]] std::ptrdiff_t entries(const std::string& folder) const {
    return std::distance(fs::directory_iterator(folder_ / folder), {});
  }

  static constexpr const char* kOld = "what was there before";
  test::TemporaryFolder folder_;
  std::string whole_;
};

TEST_F(InterruptedBake, full_device_is_an_error_and_stays_a_device) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "there is no /dev/full";
  const ProcessResult result = run("bake 'cloth_*.obj' --no-audit -o /dev/full");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("/dev/full: No space left on device"), std::string::npos) << result.err;
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

TEST_F(InterruptedBake, folder_that_cannot_be_written_keeps_its_file) {
  fs::create_directory(folder_ / "closed");
  folder_.write("closed/old.glb", kOld);
  if (::geteuid() != 0) {
    fs::permissions(folder_ / "closed", fs::perms::owner_read | fs::perms::owner_exec);
    expect_refused("closed");
    fs::permissions(folder_ / "closed", fs::perms::owner_all);
    return;
  }
  // Permissions do not stop root from writing, but a read-only mount does.
  const std::string mount = "mount --bind closed closed && mount -o remount,bind,ro closed";
  if (run_shell(mount, folder_.path()).exit_code != 0) GTEST_SKIP() << "root may not mount here";
  expect_refused("closed");
  EXPECT_EQ(run_shell("umount closed", folder_.path()).exit_code, 0);
}

TEST_F(InterruptedBake, full_disk_keeps_its_file) { expect_refused_on_a_disk_of(64); }

// The bake writes the arrays to a separate file until it knows the JSON, which precedes the arrays in the result. The
// bake frees the disk space of each array after it has copied the array into the result. The largest array has 214 KB.
// The disk has room for all arrays, but not for another copy of the largest array.
TEST_F(InterruptedBake, disk_that_is_full_at_the_end_keeps_its_file) {
  expect_refused_on_a_disk_of(whole_.size() / 1024 + 100);
}

TEST_F(InterruptedBake, disk_with_room_for_the_result_and_a_little_more_suffices) {
  mount_disk_of(whole_.size() / 1024 + 1024);
  if (IsSkipped()) return;
  const ProcessResult result = run("bake 'cloth_*.obj' --no-audit -o small/new.glb");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(test::read_whole(folder_ / "small/new.glb") == whole_);
  EXPECT_EQ(run_shell("umount small", folder_.path()).exit_code, 0);
}

TEST_F(InterruptedBake, files_that_may_not_be_so_large_keep_what_was_there) {
  fs::create_directory(folder_ / "limited");
  folder_.write("limited/old.glb", kOld);
  for (const char* const blocks : {"100", "1000"}) {
    const ProcessResult result =
        run("bake 'cloth_*.obj' --force --no-audit -o limited/old.glb", std::string("ulimit -f ") + blocks + "; ");
    EXPECT_EQ(result.exit_code, 1) << result.err;
    EXPECT_NE(result.err.find("limited/old.glb: File too large"), std::string::npos) << result.err;
    EXPECT_EQ(test::read_whole(folder_ / "limited/old.glb"), kOld);
    EXPECT_EQ(entries("limited"), 1) << "a temporary file is left";
  }
}

TEST_F(InterruptedBake, killed_at_any_moment_leaves_the_old_file_or_the_new_one) {
  constexpr int kTimes = 50;
  const auto start = std::chrono::steady_clock::now();
  ASSERT_EQ(run("bake 'cloth_*.obj' --force --no-audit -o killed.glb").exit_code, 0);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  int killed = 0;
  for (int k = 0; k < kTimes; ++k) {
    folder_.write("killed.glb", kOld);
    const ProcessResult result = run("bake 'cloth_*.obj' --force --no-audit -o killed.glb",
                                     "timeout --signal=KILL " + std::to_string(1.1 * seconds * (k + 1) / kTimes) + " ");
    killed += result.exit_code != 0 ? 1 : 0;
    const std::string left = test::read_whole(folder_ / "killed.glb");
    if (result.exit_code == 0)
      EXPECT_TRUE(left == whole_) << k << ": " << left.size() << " of " << whole_.size() << " bytes";
    else
      EXPECT_TRUE(left == kOld || left == whole_) << k << ": " << left.size() << " of " << whole_.size() << " bytes";
  }
  EXPECT_GT(killed, kTimes / 5);
}

}  // namespace
}  // namespace chronormal::bake_interrupted_test
