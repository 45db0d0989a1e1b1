// Reads the face of MPFB, an add-on for Blender, and its 102 targets. The test is skipped unless the environment
// variable CHRONORMAL_DATA names the folder of these files.
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "chronormal/motion/motion.h"
#include "tests/support/read_input.h"

namespace chronormal::real_targets_test {
namespace {

namespace fs = std::filesystem;

std::vector<float> vertices_of_obj(const fs::path& path) {
  std::vector<float> positions;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (line.compare(0, 2, "v ") != 0) continue;
    const char* at = line.c_str() + 2;
    for (int axis = 0; axis < 3; ++axis) {
      char* end = nullptr;
      positions.push_back(std::strtof(at, &end));
      at = end;
    }
  }
  return positions;
}

// Adds the deltas of a target, a text file compressed by gzip, to the positions. Returns the number of lines in the
// target.
std::size_t add_target(const fs::path& path, std::vector<float>& positions) {
  const gzFile file = ::gzopen(path.c_str(), "rb");
  std::size_t lines = 0;
  char line[512];
  while (::gzgets(file, line, sizeof line) != nullptr) {
    char* at = nullptr;
    const unsigned long vertex = std::strtoul(line, &at, 10);
    for (std::size_t axis = 0; axis < 3; ++axis) positions.at(3 * vertex + axis) += std::strtof(at, &at);
    ++lines;
  }
  (void)::gzclose(file);
  return lines;
}

TEST(RealTargets, face_and_all_its_targets_are_one_star_of_base_plus_deltas) {
  const char* const data = std::getenv("CHRONORMAL_DATA");
  if (data == nullptr) GTEST_SKIP() << "set CHRONORMAL_DATA to the folder of the real data to run this test";
  const fs::path face = fs::path(data) / "face_mpfb2";
  const Result<Motion> result =
      test::read_motion(test::targets_over((face / "base.obj").string(), {(face / "targets").string()}));
  ASSERT_TRUE(result.ok()) << result.error().text();
  const Motion& motion = result.value();
  EXPECT_TRUE(validate(motion).ok());

  std::vector<fs::path> paths;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(face / "targets")) {
    if (entry.path().extension() == ".gz") paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());  // the names have no digits, so the order is alphabetical
  ASSERT_EQ(paths.size(), 102U);
  ASSERT_EQ(motion.keyframes.size(), 103U);
  ASSERT_EQ(motion.segments.size(), 102U);
  const std::vector<float> base = vertices_of_obj(face / "base.obj");
  ASSERT_EQ(base.size(), 3U * 19158U);
  EXPECT_EQ(motion.keyframes[0].positions, base);
  std::size_t lines = 0;
  for (std::size_t k = 1; k < 103; ++k) {
    std::vector<float> expected = base;
    lines += add_target(paths[k - 1], expected);
    EXPECT_EQ(motion.keyframes[k].positions, expected) << paths[k - 1];
    EXPECT_NE(motion.keyframes[k].positions, base) << paths[k - 1];
    EXPECT_EQ(motion.keyframes[k].name, paths[k - 1].stem().stem().string());
    EXPECT_EQ(motion.segments[k - 1].from, 0U);
    EXPECT_EQ(motion.segments[k - 1].to, k);
  }
  EXPECT_EQ(lines, 37558U);
}

}  // namespace
}  // namespace chronormal::real_targets_test
