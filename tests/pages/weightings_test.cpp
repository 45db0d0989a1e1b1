// Checks that the generator writes docs/weightings.md, byte for byte except for the blocks of times and for blocks that
// cannot be measured here.

#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "tests/support/generated_page.h"
#include "tests/support/process.h"

namespace chronormal::weightings_test {
namespace {

TEST(Weightings, page_is_what_the_generator_writes) {
  const test::TemporaryFolder folder;
  const ProcessResult result =
      run_shell(std::string(kBuildFolder) + "/tools/weightings/chronormal_weightings --partial .", folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  std::string committed = test::read_whole((test::kDocs / "weightings.md").string());
  std::string generated = test::read_whole(folder / "weightings.md");
  for (const std::string block : {"times", "peers", "golden"}) {
    const auto ours = test::without_blocks(committed, block), anew = test::without_blocks(generated, block);
    EXPECT_EQ(ours.count, anew.count) << block;
    EXPECT_GE(ours.count, 1u) << block;
    // Other libraries and files are compared where they are available.
    if (block != "times" && !anew.inside.empty()) continue;
    if (block != "times") std::printf("not measured here, so not compared: %s\n", block.c_str());
    committed = ours.page, generated = anew.page;
  }
  test::expect_same_text(committed, generated, "docs/weightings.md");
}

}  // namespace
}  // namespace chronormal::weightings_test
