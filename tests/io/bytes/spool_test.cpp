// Checks that a spool (a temporary store for output) returns all of its data, whether it keeps them in memory or on
// disk, and that its file is never visible in a folder.
#include "io/bytes/spool.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstddef>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "tests/support/child_process.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::spool_test {
namespace {

using test::TemporaryFolder;

std::string all_of(const Spool& spool, std::uint64_t at, std::uint64_t size) {
  std::string bytes;
  const Status status = spool.hand_over(at, size, [&](std::string_view part) -> Status {
    EXPECT_FALSE(part.empty());
    bytes += part;
    return Success{};
  });
  EXPECT_TRUE(status.ok());
  return bytes;
}

// Returns byte strings of various lengths. One of them is longer than the buffer through which files are read.
std::vector<std::string> parts() {
  std::vector<std::string> result = {"a", "", "bc", "def", std::string(1, '\0'), ""};
  std::string large;
  for (std::size_t i = 0; i < 2500000; ++i) large += static_cast<char>(i * 2654435761U >> 13U);
  result.push_back(std::move(large));
  result.emplace_back("the end");
  return result;
}

class Spools : public testing::TestWithParam<bool> {
 protected:
  [[nodiscard]] Spool make() const {
    return GetParam() ? Spool::beside(folder_ / "out.glb", "out.glb").value() : Spool();
  }
  TemporaryFolder folder_;
};

TEST_P(Spools, give_back_any_part_of_what_they_got) {
  Spool spool = make();
  std::string whole;
  for (const std::string& part : parts()) {
    EXPECT_EQ(spool.size(), whole.size());
    spool.add(part);
    whole += part;
  }
  ASSERT_TRUE(spool.status().ok());
  ASSERT_EQ(spool.size(), whole.size());
  EXPECT_TRUE(all_of(spool, 0, whole.size()) == whole);
  for (std::size_t at = 0; at < 9; ++at) {
    for (std::size_t size = 0; size < 9; ++size) EXPECT_EQ(all_of(spool, at, size), whole.substr(at, size));
    EXPECT_TRUE(all_of(spool, at, whole.size() - at) == whole.substr(at)) << at;
    EXPECT_EQ(all_of(spool, whole.size() - at, at), whole.substr(whole.size() - at));
  }
  const Spool moved = std::move(spool);
  EXPECT_TRUE(all_of(moved, 0, whole.size()) == whole);
}

TEST_P(Spools, know_what_lies_where) {
  Spool spool = make();
  std::string whole;
  for (const std::string& part : parts()) {
    spool.add(part);
    whole += part;
  }
  EXPECT_TRUE(spool.has(0, whole));
  EXPECT_TRUE(spool.has(3, "def"));
  EXPECT_TRUE(spool.has(5, ""));
  EXPECT_FALSE(spool.has(4, "def"));
  for (const std::size_t at : {std::size_t{0}, std::size_t{7}, whole.size() / 2, whole.size() - 1}) {
    std::string other = whole;
    other[at] = static_cast<char>(other[at] + 1);
    EXPECT_FALSE(spool.has(0, other)) << at;
  }
  EXPECT_TRUE(spool.status().ok());
}

TEST_P(Spools, end_where_the_taker_does_not_want_more) {
  Spool spool = make();
  for (const std::string& part : parts()) spool.add(part);
  std::size_t calls = 0;
  const Status status = spool.hand_over(0, spool.size(), [&](std::string_view) -> Status {
    ++calls;
    return Error{ErrorCode::kFailed, "taker", "enough"};
  });
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().text(), "taker: enough");
  EXPECT_EQ(calls, 1U);
}

TEST_P(Spools, give_everything_away_and_begin_again) {
  Spool spool = make();
  std::string whole;
  for (int time = 0; time < 8; ++time) {
    for (const std::string& part : parts()) {
      spool.append(part);
      whole += part;
    }
  }
  std::string given;
  const auto take = [&](std::string_view bytes) -> Status {
    given += bytes;
    return Success{};
  };
  ASSERT_TRUE(spool.give_away(0, 5, take).ok());
  EXPECT_TRUE(all_of(spool, 5, whole.size() - 5) == whole.substr(5));
  ASSERT_TRUE(spool.give_away(5, whole.size() - 5, take).ok());
  EXPECT_TRUE(given == whole);
  spool.clear();
  EXPECT_EQ(spool.size(), 0U);
  spool.add("other");
  spool.append(" bytes");
  EXPECT_EQ(all_of(spool, 0, spool.size()), "other bytes");
  EXPECT_TRUE(spool.status().ok());
}

INSTANTIATE_TEST_SUITE_P(Spool, Spools, testing::Bool(),
                         [](const auto& tested) { return tested.param ? "in_a_file" : "in_memory"; });

TEST(Spool, in_a_file_has_no_name) {
  const TemporaryFolder folder;
  Spool spool = Spool::beside(folder / "out.glb", "out.glb").value();
  EXPECT_EQ(folder.entry_count(), 0U);
  spool.add("bytes");
  EXPECT_EQ(folder.entry_count(), 0U);
}

TEST(Spool, in_a_folder_that_is_not_there_says_so) {
  const TemporaryFolder folder;
  const Result<Spool> spool = Spool::beside(folder / "none/out.glb", "none/out.glb");
  ASSERT_FALSE(spool.ok());
  EXPECT_EQ(spool.error().text(),
            "none/out.glb: the folder of the output cannot be written to: No such file or directory");
}

// Returns the path in /proc through which the unnamed file of a spool can be opened.
std::string file_of_spool(const TemporaryFolder& folder) {
  std::string found;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    std::error_code none;
    const std::string file = std::filesystem::read_symlink(entry.path(), none).string();
    if (file.starts_with(folder / ".chronormal-")) found = entry.path().string();
  }
  return found;
}

TEST(Spool, room_of_what_is_given_away_is_free_again) {
  const TemporaryFolder folder;
  Spool spool = Spool::beside(folder / "out.glb", "out.glb").value();
  spool.add(std::string(std::size_t{32} << 20, 'a'));
  const std::string file = file_of_spool(folder);
  const auto blocks = [&file] {
    struct stat status {};
    EXPECT_EQ(::stat(file.c_str(), &status), 0);
    return status.st_blocks;
  };
  const auto before = blocks();
  std::size_t given = 0;
  decltype(blocks()) most = 0;  // the largest number of blocks on disk while the last quarter is read
  const Status status = spool.give_away(0, spool.size(), [&](std::string_view bytes) -> Status {
    given += bytes.size();
    if (given > std::size_t{25} << 20) most = std::max(most, blocks());
    return Success{};
  });
  ASSERT_TRUE(status.ok());
  EXPECT_LT(2 * most, before) << "the rest of the file takes room, or the file system cannot free it";
  EXPECT_EQ(given, std::size_t{32} << 20);
}

TEST(Spool, bytes_that_are_gone_from_the_file_are_an_error) {
  const TemporaryFolder folder;
  Spool spool = Spool::beside(folder / "out.glb", "out.glb").value();
  spool.add(std::string(100, 'a'));
  const std::string found = file_of_spool(folder);
  ASSERT_NE(found, "");
  ASSERT_EQ(::truncate(found.c_str(), 50), 0);
  EXPECT_EQ(all_of(spool, 0, 50), std::string(50, 'a'));
  const Status status = spool.hand_over(0, 51, [](std::string_view) -> Status { return Success{}; });
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().text(), "out.glb: Input/output error");
  EXPECT_FALSE(spool.has(0, std::string(100, 'a')));
  EXPECT_FALSE(spool.status().ok());
}

TEST(Spool, what_could_not_be_written_once_is_an_error_from_then_on) {
  const TemporaryFolder folder;
  const test::ChildRun run = test::run_in_child(10, [&]() -> std::string {
    Spool spool = Spool::beside(folder / "out.glb", "out.glb").value();
    const auto limit_files = [](rlim_t bytes) {
      rlimit limit{};
      ::getrlimit(RLIMIT_FSIZE, &limit);
      limit.rlim_cur = bytes;
      ::setrlimit(RLIMIT_FSIZE, &limit);
    };
    (void)std::signal(SIGXFSZ, SIG_IGN);
    limit_files(1000);
    spool.add(std::string(600, 'a'));
    if (!spool.status()) return "too early";
    spool.add(std::string(600, 'b'));
    limit_files(RLIM_INFINITY);
    spool.add(std::string(600, 'c'));
    const Status found = spool.hand_over(0, 600, [](std::string_view) -> Status { return Success{}; });
    return spool.status() || found ? "no error" : spool.status().error().text() + "; " + found.error().text();
  });
  ASSERT_TRUE(run.finished) << run.text;
  EXPECT_EQ(run.text, "out.glb: File too large; out.glb: File too large");
}

}  // namespace
}  // namespace chronormal::spool_test
