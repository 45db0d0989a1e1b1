// Checks that the generator writes docs/paper.md: figures, prose and pictures, byte for byte, except for the block of
// times.

#include <gtest/gtest.h>

#include <string>

#include "tests/support/generated_page.h"
#include "tests/support/process.h"

namespace chronormal::paper_test {
namespace {

TEST(Paper, page_and_pictures_are_what_the_generator_writes) {
  const test::TemporaryFolder folder;
  const ProcessResult result = run_shell(std::string(kBuildFolder) + "/tools/paper/chronormal_paper .", folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;

  const auto committed = test::without_blocks(test::read_whole((test::kDocs / "paper.md").string()), "times");
  const auto generated = test::without_blocks(test::read_whole(folder / "paper.md"), "times");
  EXPECT_EQ(committed.count, 1u);
  test::expect_same_text(committed.page, generated.page, "docs/paper.md");
  EXPECT_EQ(test::expect_same_pictures(folder, committed.page), 10u);
}

}  // namespace
}  // namespace chronormal::paper_test
