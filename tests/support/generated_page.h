/// Compares a page that a program has just written with the committed one.
#ifndef TESTS_SUPPORT_GENERATED_PAGE_H_
#define TESTS_SUPPORT_GENERATED_PAGE_H_

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "tests/support/places.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::test {

inline const std::filesystem::path kDocs = std::filesystem::path(kSourceFolder) / "docs";

/// A page without the text in the blocks of one name, <!-- NAME --> to <!-- end of NAME -->.
struct WithoutBlocks {
  std::string page;
  std::size_t count = 0;  ///< number of blocks
  std::string inside;     ///< text of the last block
};

[[nodiscard]] inline WithoutBlocks without_blocks(std::string page, const std::string& name) {
  const std::string begin = "<!-- " + name + " -->\n", end = "<!-- end of " + name + " -->\n";
  WithoutBlocks result;
  for (std::size_t at = 0; (at = page.find(begin, at)) != std::string::npos; ++result.count) {
    at += begin.size();
    const std::size_t last = page.find(end, at);
    EXPECT_NE(last, std::string::npos) << "a block does not end: " << name;
    if (last == std::string::npos) break;
    result.inside = page.substr(at, last - at);
    page.erase(at, last - at);
  }
  result.page = std::move(page);
  return result;
}

/// Expects the same text, and shows the first line in which they differ.
inline void expect_same_text(const std::string& committed, const std::string& generated, const std::string& name) {
  if (committed == generated) return;
  const auto shorter = std::min(committed.size(), generated.size());
  const auto parted =
      std::mismatch(committed.begin(), committed.begin() + static_cast<std::ptrdiff_t>(shorter), generated.begin());
  const auto at = static_cast<std::size_t>(parted.first - committed.begin());
  const auto line_at = [at](const std::string& text) {
    const std::size_t before = at == 0 ? std::string::npos : text.rfind('\n', at - 1);
    const std::size_t start = before == std::string::npos ? 0 : before + 1;
    return text.substr(start, text.find('\n', at) - start);
  };
  ADD_FAILURE() << name << " is not what its program writes\ncommitted: " << line_at(committed)
                << "\ngenerated: " << line_at(generated) << "\n(tools/make_* writes it anew)";
}

/// Expects every picture in FOLDER/pictures to be committed, the same, and used in the page. Returns their number.
inline std::size_t expect_same_pictures(const TemporaryFolder& folder, const std::string& page) {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "pictures")) {
    const std::string name = entry.path().filename().string();
    expect_same_text(read_whole((kDocs / "pictures" / name).string()), read_whole(entry.path().string()), name);
    EXPECT_NE(page.find("(pictures/" + name + ")"), std::string::npos) << name << " is not shown";
    ++count;
  }
  return count;
}

}  // namespace chronormal::test

#endif  // TESTS_SUPPORT_GENERATED_PAGE_H_
