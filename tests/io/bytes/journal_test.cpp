// Checks that a journal returns the records that were written completely, even if the end of the file is damaged.
#include "io/bytes/journal.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace chronormal::journal_test {
namespace {

constexpr const char* kRun = R"({"command": "audit"})";

std::string written(const test::TemporaryFolder& folder, const std::vector<std::string>& records) {
  Result<Journal> journal = Journal::open(folder / "out.journal", kRun);
  EXPECT_TRUE(journal.ok());
  for (const std::string& record : records) EXPECT_TRUE(journal.value().append(record).ok());
  return journal.value().path();
}

TEST(Journal, records_are_read_back_by_the_next_run) {
  const test::TemporaryFolder folder;
  const std::string path = written(folder, {"one", "", "three"});
  Result<Journal> next = Journal::open(path, "another run");
  ASSERT_TRUE(next.ok());
  EXPECT_EQ(next.value().run(), kRun);
  EXPECT_EQ(next.value().records(), (std::vector<std::string>{"one", "", "three"}));
  EXPECT_FALSE(next.value().is_empty());
  ASSERT_TRUE(next.value().keep_first(1).ok());
  ASSERT_TRUE(next.value().append("two").ok());
  next = Journal::open(folder / "other", kRun);  // the assignment closes the first journal
  EXPECT_EQ(Journal::open(path, kRun).value().records(), (std::vector<std::string>{"one", "two"}));
  ASSERT_TRUE(next.value().remove().ok());
  EXPECT_EQ(folder.entry_count(), 1U);
}

TEST(Journal, a_record_that_is_cut_or_damaged_is_dropped_with_all_behind_it) {
  const test::TemporaryFolder folder;
  const std::string whole = test::read_whole(written(folder, {"one", "two", "three"}));
  const std::size_t begin = whole.find("two") - 9;  // the checksum is before the record
  for (std::size_t size = begin; size < whole.size(); ++size) {
    const std::string path = folder.write("cut.journal", whole.substr(0, size));
    Result<Journal> journal = Journal::open(path, kRun);
    ASSERT_TRUE(journal.ok());
    const std::size_t left = size < whole.find("three") - 9 ? 1 : 2;
    EXPECT_EQ(journal.value().records().size(), left) << size;
    ASSERT_TRUE(journal.value().append("next").ok());
    journal = Journal::open(folder / "other", kRun);
    EXPECT_EQ(Journal::open(path, kRun).value().records().back(), "next") << size;
  }
  for (std::size_t i = begin; i + 1 < whole.find("three") - 9; ++i) {
    std::string damaged = whole;
    damaged[i] = damaged[i] == '0' ? '1' : '0';
    const std::string path = folder.write("damaged.journal", damaged);
    EXPECT_EQ(Journal::open(path, kRun).value().records(), std::vector<std::string>{"one"}) << i;
  }
}

TEST(Journal, other_files_are_refused_and_left_alone) {
  const test::TemporaryFolder folder;
  for (const std::string bytes : {"", "my diary\n", "00000000 {}\n"}) {
    const std::string path = folder.write("out.journal", bytes);
    const Result<Journal> journal = Journal::open(path, kRun);
    ASSERT_FALSE(journal.ok()) << bytes;
    EXPECT_EQ(journal.error().code, ErrorCode::kFailed);
    EXPECT_EQ(test::read_whole(path), bytes);
  }
  EXPECT_FALSE(Journal::open(folder.path(), kRun).ok());
  EXPECT_FALSE(Journal::open(folder / "no/such/folder", kRun).ok());
}

TEST(Journal, belongs_to_one_run_at_a_time) {
  const test::TemporaryFolder folder;
  Result<Journal> one = Journal::open(folder / "out.journal", kRun);
  ASSERT_TRUE(one.ok());
  const Result<Journal> two = Journal::open(folder / "out.journal", kRun);
  ASSERT_FALSE(two.ok());
  EXPECT_NE(two.error().message.find("another run is writing"), std::string::npos);
}

// A limit on the size of files makes a write fail as a full disk does.
TEST(Journal, a_record_that_the_disk_refuses_is_an_error_with_the_path) {
  const test::TemporaryFolder folder;
  Result<Journal> journal = Journal::open(folder / "out.journal", kRun);
  ASSERT_TRUE(journal.ok());
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit small{64, before.rlim_max};
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const Status appended = journal.value().append(std::string(1000, 'x'));
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, old_handler);
  ASSERT_FALSE(appended.ok());
  EXPECT_EQ(appended.error().code, ErrorCode::kFailed);
  EXPECT_EQ(appended.error().text(), folder / "out.journal" + ": File too large");
}

TEST(Journal, one_that_cannot_be_removed_is_an_error_and_one_that_is_gone_is_none) {
  const test::TemporaryFolder folder;
  std::filesystem::create_directory(folder / "runs");
  Result<Journal> journal = Journal::open(folder / "runs/out.journal", kRun);
  ASSERT_TRUE(journal.ok());
  std::filesystem::remove_all(folder / "runs");
  EXPECT_TRUE(journal.value().remove().ok());
  folder.write("runs", "a file now");
  EXPECT_EQ(journal.value().remove().error().text(), folder / "runs/out.journal" + ": Not a directory");
}

}  // namespace
}  // namespace chronormal::journal_test
