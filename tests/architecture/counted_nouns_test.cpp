// Tests that no message joins a number and a plural noun by hand, since such a message is wrong for the number 1: "1
// vertices". Messages use counted() (core/text.h) instead.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>

#include "tests/support/places.h"

namespace chronormal::counted_nouns_test {
namespace {

namespace fs = std::filesystem;

// Returns the first text of a source file in which a number is joined to a plural noun, such as the C++ code
// `to_string(n) + " vertices`. Returns an empty text if there is none.
std::string joined_noun(const std::string& source) {
  const std::regex joined(
      R"((to_string|grouped|number|rounded_text|with_digits)\([^;"{}]*\)\s*\+\s*" )"
      "(vertices|faces|triangles|corners|edges|normals|positions|points|keyframes|frames|segments|keys|samples|cases|"
      "targets|weights|poses|deltas|joints|elements|entries|indices|values|numbers|coordinates|bytes|degrees)\\b");
  std::smatch found;
  return std::regex_search(source, found, joined) ? found.str() : "";
}

TEST(CountedNouns, no_source_joins_a_number_and_a_plural_noun) {
  std::size_t files = 0;
  for (const std::string folder : {"src", "cli", "capi"}) {
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(kSourceFolder) / folder)) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".cpp" && extension != ".h") continue;
      ++files;
      std::ifstream file(entry.path());
      const std::string source{std::istreambuf_iterator<char>(file), {}};
      EXPECT_EQ(joined_noun(source), "") << entry.path().string()
                                         << " is wrong for one; counted() of core/text.h is right";
    }
  }
  EXPECT_GT(files, 200U);
}

TEST(CountedNouns, are_told_from_others) {
  EXPECT_NE(joined_noun("\"the file has \" + std::to_string(count(a)) +\n    \" vertices in\""), "");
  EXPECT_EQ(joined_noun("counted(count, \"vertex\", \"vertices\") + \" of \" + std::to_string(n) + \" is\""), "");
  EXPECT_EQ(joined_noun("to_string(c) + \" of face \" + grouped(f) + (f == 1 ? \" key\" : \" keys\")"), "");
}

}  // namespace
}  // namespace chronormal::counted_nouns_test
