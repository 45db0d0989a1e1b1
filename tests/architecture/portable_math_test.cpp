// Checks that no code calls a function of the standard library that rounds differently on different systems. Results
// must be the same on every machine.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>

#include "tests/support/places.h"

namespace chronormal::portable_math_test {
namespace {

namespace fs = std::filesystem;

TEST(PortableMath, no_source_calls_functions_whose_bits_differ_between_systems) {
  const std::regex inexact(
      R"(std::(sin|cos|tan|asin|acos|atan|atan2|exp|exp2|expm1|log|log2|log10|log1p|pow|cbrt|hypot)f?\()");
  std::size_t files = 0;
  for (const std::string folder : {"src", "cli", "include", "capi"}) {
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(kSourceFolder) / folder)) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".cpp" && extension != ".h") continue;
      ++files;
      std::ifstream file(entry.path());
      std::ostringstream text;
      text << file.rdbuf();
      std::smatch found;
      const std::string all = text.str();
      EXPECT_FALSE(std::regex_search(all, found, inexact))
          << entry.path().string() << " calls " << found.str()
          << "), and core/portable_math.h has one with the same bits everywhere";
    }
  }
  EXPECT_GT(files, 200U);
}

}  // namespace
}  // namespace chronormal::portable_math_test
