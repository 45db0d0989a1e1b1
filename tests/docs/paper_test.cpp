// docs/paper.md is what its generator writes: figures, prose and pictures, byte for byte, but for the block of times.

#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>

#include "tests/support/child_process.h"
#include "tests/support/places.h"
#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::paper_test {
namespace {

namespace fs = std::filesystem;

const fs::path kDocs = fs::path(kSourceFolder) / "docs";

// The page without what stands between the marks of the block of times; "" where there is not one such block.
std::string without_times(const std::string& page) {
  const std::string first = "<!-- times -->", last = "<!-- end of times -->";
  const std::size_t begin = page.find(first), end = page.find(last);
  if (begin == std::string::npos || end == std::string::npos || end < begin) return "";
  if (page.find(first, begin + 1) != std::string::npos) return "";
  return page.substr(0, begin + first.size()) + page.substr(end);
}

std::set<std::string> names_in(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename().string());
  return names;
}

// Where two texts part, with the line as the one has it and as the other does.
std::string first_difference(const std::string& a, const std::string& b) {
  std::size_t at = 0;
  while (at < a.size() && at < b.size() && a[at] == b[at]) ++at;
  const auto line_at = [at](const std::string& text) {
    if (at >= text.size()) return std::string("(nothing)");
    const std::size_t before = at == 0 ? std::string::npos : text.rfind('\n', at - 1);
    const std::size_t start = before == std::string::npos ? 0 : before + 1;
    return text.substr(start, text.find('\n', at) - start);
  };
  return "committed: " + line_at(a) + "\ngenerated: " + line_at(b) + "\n(tools/make_paper writes it anew)";
}

TEST(Paper, page_and_pictures_are_what_the_generator_writes) {
  if (test::is_sanitized()) GTEST_SKIP() << "the generator takes minutes under sanitizers; the release build runs it";
  const test::TemporaryFolder folder;
  const ProcessResult result = run_shell(std::string(kBuildFolder) + "/tools/paper/chronormal_paper .", folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;

  const std::string committed = without_times(test::read_whole((kDocs / "paper.md").string()));
  const std::string generated = without_times(test::read_whole(folder / "paper.md"));
  ASSERT_FALSE(committed.empty()) << "docs/paper.md has no block of times, or several";
  EXPECT_TRUE(committed == generated) << first_difference(committed, generated);

  const std::set<std::string> pictures = names_in(folder.path() + "/pictures");
  EXPECT_FALSE(pictures.empty());
  for (const std::string& name : pictures) {
    const fs::path path = kDocs / "pictures" / name;
    ASSERT_TRUE(fs::exists(path)) << "docs/pictures/" << name << " is missing: tools/make_paper";
    const std::string before = test::read_whole(path.string()), now = test::read_whole(folder / ("pictures/" + name));
    EXPECT_TRUE(before == now) << name << "\n" << first_difference(before, now);
    EXPECT_NE(committed.find("(pictures/" + name + ")"), std::string::npos) << name << " is not shown in docs/paper.md";
  }
}

}  // namespace
}  // namespace chronormal::paper_test
