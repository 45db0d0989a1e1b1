// Tests that no two headers of the product use one name for different things. The check is that every_header.cpp, which
// CMake makes from every_header.cpp.in, compiles. This file makes sure that every_header.cpp leaves out no header.

#include "tests/architecture/every_header.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/support/places.h"

namespace chronormal::every_header_test {
namespace {

namespace fs = std::filesystem;

TEST(EveryHeader, is_compiled_in_one_translation_unit) {
  std::size_t count = 0;
  for (const char* folder : {"include", "src"}) {
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(kSourceFolder) / folder)) {
      const std::string name = entry.path().filename().string();
      if (name.ends_with(".h") && !name.ends_with("-inl.h")) ++count;
    }
  }
  EXPECT_GT(count, 100U);
  EXPECT_EQ(chronormal::kEveryHeaderCount, count);
}

}  // namespace
}  // namespace chronormal::every_header_test
