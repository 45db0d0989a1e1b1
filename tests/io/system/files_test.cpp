#include "io/system/files.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cerrno>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/system/names.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::files_test {
namespace {

using test::read_whole;
using test::TemporaryFolder;

TEST(SystemFiles, a_file_that_must_be_new_replaces_nothing) {
  const TemporaryFolder folder;
  const std::string there = folder.write("there", "old"), other = folder.write("other", "new");
  EXPECT_FALSE(open_file(there, {.writes = true, .makes = Opening::Makes::kNew}).is_open());
  EXPECT_EQ(errno, EEXIST);
  EXPECT_FALSE(rename_file(other.c_str(), there.c_str(), false));
  EXPECT_EQ(errno, EEXIST);
  EXPECT_EQ(read_whole(there), "old");
  EXPECT_TRUE(rename_file(other.c_str(), there.c_str(), true));
  EXPECT_EQ(read_whole(there), "new");
  EXPECT_FALSE(status_of(other));
  EXPECT_EQ(errno, ENOENT);
}

TEST(SystemFiles, bytes_lie_where_they_were_written) {
  const TemporaryFolder folder;
  const std::string path = folder / "bytes";
  const Descriptor file = open_file(path, {.reads = true, .writes = true, .makes = Opening::Makes::kNew});
  ASSERT_TRUE(file.is_open());
  EXPECT_TRUE(write_bytes(file.number(), "abcdef"));
  EXPECT_TRUE(write_at(file.number(), 2, "XY"));
  std::string read(10, '-');
  const std::optional<std::span<char>> missing = read_at(file.number(), 1, read);
  ASSERT_TRUE(missing);
  EXPECT_EQ(missing->size(), 5U);
  EXPECT_EQ(read, "bXYef-----");
  EXPECT_TRUE(set_end(file.number(), 3));
  EXPECT_TRUE(write_bytes(file.number(), "!"));
  EXPECT_EQ(read_whole(path), "abX!");
}

TEST(SystemFiles, a_removed_file_has_no_name_and_keeps_its_number) {
  const TemporaryFolder folder;
  const std::string path = folder.write("a", "1");
  const Descriptor file = open_file(path, {.reads = true});
  const std::optional<FileStatus> before = status_of(path), own = status_of(file.number());
  ASSERT_TRUE(before && own);
  EXPECT_TRUE(own->is_file());
  EXPECT_EQ(own->size, 1U);
  EXPECT_EQ(own->number, before->number);
  EXPECT_FALSE(own->is_removed);
  EXPECT_TRUE(remove_file(path.c_str()));
  EXPECT_TRUE(status_of(file.number())->is_removed);
  EXPECT_EQ(status_of(folder / "")->kind, FileStatus::Kind::kFolder);
}

TEST(SystemFiles, patterns_match_names_and_folders) {
  const TemporaryFolder folder;
  for (const char* name : {"w_1.obj", "w_2.obj", "w_x.obj", "w_1.ply", ".w_3.obj"}) (void)folder.write(name, "");
  const auto found = [&](const std::string& pattern) {
    std::vector<std::string> names = match_pattern(folder / pattern, true);
    for (std::string& name : names) name = file_name(name);
    std::sort(names.begin(), names.end());
    return names;
  };
  EXPECT_EQ(found("*.obj"), (std::vector<std::string>{"w_1.obj", "w_2.obj", "w_x.obj"}));
  EXPECT_EQ(found("w_[0-9].*"), (std::vector<std::string>{"w_1.obj", "w_1.ply", "w_2.obj"}));
  EXPECT_EQ(found("w_?.ply"), (std::vector<std::string>{"w_1.ply"}));
  EXPECT_TRUE(found("v*").empty());
}

TEST(SystemNames, a_name_begins_behind_the_last_separator) {
  EXPECT_EQ(begin_of_name("a/b/c.obj"), 4U);
  EXPECT_EQ(begin_of_name("c.obj"), 0U);
  EXPECT_EQ(begin_of_name("a/"), 2U);
  EXPECT_EQ(file_name("a/\xC3\xA4 \xE6\xB3\x95.obj"), "\xC3\xA4 \xE6\xB3\x95.obj");
  EXPECT_EQ(folder_of("\xC3\xA4/b"), "\xC3\xA4");
  EXPECT_EQ(folder_of("b"), "");
  const std::string no_utf8 = "a/\xFF\xC3.obj";
  EXPECT_EQ(utf8_of(path_of(no_utf8)), no_utf8);  // on a POSIX system, a name may have any bytes
}

}  // namespace
}  // namespace chronormal::files_test
