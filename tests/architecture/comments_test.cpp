// Tests that no comment begins like a fragment. The words in refused_openers.txt begin phrases that are not whole
// sentences. The comment of a function must begin with a verb, the comment of a type with a noun, and a note inside a
// function must be a sentence.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/places.h"

namespace chronormal::comments_test {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = chronormal::kSourceFolder;

std::vector<std::string> refused_openers() {
  std::ifstream file(kRoot / "tests/architecture/refused_openers.txt");
  std::vector<std::string> openers;
  for (std::string line; std::getline(file, line);) openers.push_back(line);
  return openers;
}

// Returns the text of a comment line that begins with `mark` and has no code before it. Returns nothing for other
// lines.
std::optional<std::string_view> comment_in(std::string_view line, std::string_view mark) {
  const std::size_t begin = line.find_first_not_of(' ');
  if (begin == std::string_view::npos || !line.substr(begin).starts_with(mark)) return std::nullopt;
  line.remove_prefix(begin + mark.size());
  if (mark == "//" && line.starts_with('/')) line.remove_prefix(1);
  if (!line.starts_with(' ')) return std::nullopt;  // skips code that was commented out, and lines of dashes
  return line.substr(1);
}

std::optional<std::string> refused(std::string_view comment, const std::vector<std::string>& openers) {
  const auto found = std::find_if(openers.begin(), openers.end(), [&](const std::string& opener) {
    return comment.starts_with(opener) && (comment.size() == opener.size() || comment[opener.size()] == ' ');
  });
  return found == openers.end() ? std::nullopt : std::optional(*found);
}

TEST(Comments, open_with_a_verb_a_noun_or_a_sentence) {
  const std::vector<std::string> openers = refused_openers();
  ASSERT_GT(openers.size(), 10U);
  std::size_t blocks = 0;
  for (const char* const folder :
       {"include", "src", "cli", "capi", "python", "js", "web", "vtk", "bench", "fuzz", "tools", "tests", "examples"}) {
    for (auto entry = fs::recursive_directory_iterator(kRoot / folder); entry != fs::end(entry); ++entry) {
      const fs::path& path = entry->path();
      const std::string name = path.filename().string(), extension = path.extension().string();
      if (entry->is_directory() && (name == "node_modules" || name == "dist" || name == "build")) {
        entry.disable_recursion_pending();
        continue;
      }
      const bool is_python = extension == ".py";
      constexpr std::string_view kOthers[] = {".h", ".cpp", ".c", ".js", ".mjs", ".ts"};
      if (!is_python && std::find(std::begin(kOthers), std::end(kOthers), extension) == std::end(kOthers)) continue;
      std::ifstream file(path);
      bool goes_on = false;
      std::size_t number = 0;
      for (std::string line; std::getline(file, line);) {
        ++number;
        const std::optional<std::string_view> comment = comment_in(line, is_python ? "#" : "//");
        if (comment && !goes_on) {
          ++blocks;
          if (const std::optional<std::string> opener = refused(*comment, openers))
            ADD_FAILURE() << path.lexically_relative(kRoot).string() << ':' << number << " opens with '" << *opener
                          << "': " << *comment;
        }
        goes_on = comment.has_value();
      }
    }
  }
  EXPECT_GT(blocks, 5000U);
}

TEST(Comments, that_open_like_a_fragment_are_told_from_others) {
  const std::vector<std::string> openers = refused_openers();
  const auto is_refused = [&](std::string_view line) { return refused(*comment_in(line, "//"), openers).has_value(); };
  EXPECT_TRUE(is_refused("// Whether it is open."));
  EXPECT_TRUE(is_refused("  /// The same of a segment."));
  EXPECT_FALSE(is_refused("// Tells whether it is open."));
  EXPECT_FALSE(is_refused("/// Offers more."));
  EXPECT_FALSE(comment_in("int a;  // Of an edge", "//").has_value());
  EXPECT_FALSE(comment_in("// ---- Of edges", "# ").has_value());
}

}  // namespace
}  // namespace chronormal::comments_test
