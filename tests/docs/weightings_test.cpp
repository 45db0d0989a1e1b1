// docs/weightings.md is what its generator writes: byte for byte but for the blocks of times, and for those that cannot
// be measured here. Of those, the rows must be there.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "chronormal/normals/normal_groups.h"
#include "chronormal/normals/weighting.h"
#include "tests/support/child_process.h"
#include "tests/support/places.h"
#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::weightings_test {
namespace {

namespace fs = std::filesystem;

const fs::path kDocs = fs::path(kSourceFolder) / "docs";

std::string begin_of(const std::string& block) { return "<!-- " + block + " -->\n"; }
std::string end_of(const std::string& block) { return "<!-- end of " + block + " -->\n"; }

// What stands in a block, "" where it is not there.
std::string inside(const std::string& page, const std::string& block) {
  const std::size_t begin = page.find(begin_of(block)), end = page.find(end_of(block));
  if (begin == std::string::npos || end == std::string::npos) return "";
  const std::size_t first = begin + begin_of(block).size();
  return first <= end ? page.substr(first, end - first) : "";
}

// The page without what stands in any block of this name, and how many of them there are.
std::string without(std::string page, const std::string& block, std::size_t& count) {
  count = 0;
  for (std::size_t at = 0; (at = page.find(begin_of(block), at)) != std::string::npos; ++count) {
    at += begin_of(block).size();
    const std::size_t end = page.find(end_of(block), at);
    if (end == std::string::npos) return "";
    page.erase(at, end - at);
  }
  return page;
}

// Where two texts part, with the line as the one has it and as the other does.
std::string first_difference(const std::string& a, const std::string& b) {
  const auto parted = std::mismatch(a.begin(), a.end(), b.begin(), b.end()).first;
  const auto at = static_cast<std::size_t>(parted - a.begin());
  const std::size_t start = at == 0 ? 0 : a.rfind('\n', at - 1) + 1;
  return "committed: " + a.substr(start, a.find('\n', at) - start) +
         "\ngenerated: " + b.substr(start, b.find('\n', std::min(at, b.size())) - start) +
         "\n(tools/make_weightings writes it anew)";
}

TEST(Weightings, page_and_picture_are_what_the_generator_writes) {
  if (test::is_sanitized()) GTEST_SKIP() << "the generator takes minutes under sanitizers; the release build runs it";
  const test::TemporaryFolder folder;
  const ProcessResult result =
      run_shell(std::string(kBuildFolder) + "/tools/weightings/chronormal_weightings --partial .", folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string page = test::read_whole((kDocs / "weightings.md").string());
  std::string committed = page, generated = test::read_whole(folder / "weightings.md");
  for (const std::string block : {"times", "peers", "golden"}) {
    // Other libraries and files are compared where they are.
    if (block != "times" && !inside(generated, block).empty()) continue;
    if (block != "times") std::printf("not measured here, so not compared: %s\n", block.c_str());
    std::size_t in_committed = 0, in_generated = 0;
    committed = without(committed, block, in_committed);
    generated = without(generated, block, in_generated);
    EXPECT_EQ(in_committed, in_generated) << block;
    EXPECT_GE(in_committed, 1u) << block;
  }
  EXPECT_TRUE(committed == generated) << first_difference(committed, generated);

  std::size_t pictures = 0;
  for (const auto& entry : fs::directory_iterator(folder.path() + "/pictures")) {
    const std::string name = entry.path().filename().string();
    ASSERT_TRUE(fs::exists(kDocs / "pictures" / name)) << name;
    EXPECT_TRUE(test::read_whole((kDocs / "pictures" / name).string()) == test::read_whole(entry.path().string()))
        << name;
    EXPECT_NE(page.find("(pictures/" + name + ")"), std::string::npos) << name;
    ++pictures;
  }
  EXPECT_EQ(pictures, 1u);
}

TEST(Weightings, page_has_a_row_for_every_library_and_file_that_it_was_measured_with) {
  const std::string page = test::read_whole((kDocs / "weightings.md").string());
  const std::string peers = inside(page, "peers"), golden = inside(page, "golden");
  for (const std::string row : {"OpenMesh 9.0 `calc_vertex_normal_fast`", "OpenMesh 9.0 `calc_vertex_normal_correct`",
                                "OpenMesh 9.0 `calc_vertex_normal_loop`", "VTK 9.1 `vtkPolyDataNormals`",
                                "VTK 9.1 `vtkTriangleMeshPointNormals`", "CGAL 5.5 `compute_vertex_normals`"}) {
    std::size_t rows = 0;
    for (std::size_t at = 0; (at = peers.find("| " + row, at)) != std::string::npos; ++at) ++rows;
    EXPECT_EQ(rows, 3u) << row << ": one for each mesh";
  }
  for (const std::string file :
       {"maya_blend_inbetween_*.obj", "maya_cache_sine_12.obj", "max_cache_box_44.obj", "textured_tetrahedron.obj",
        "groups.obj", "blender_279_sausage_*.obj", "spider.obj", "test_meshes.py"})
    EXPECT_NE(golden.find("| `" + file + "`"), std::string::npos) << file;
}

// docs/theory.md, eq. 19: two triangles with an edge in common, one of which stands still.
TEST(Weightings, are_along_what_the_theory_says_of_two_triangles) {
  Motion motion{Topology::triangles(4, {0, 1, 2, 1, 0, 3}).value(), std::vector<Motion::Keyframe>(2), {}};
  motion.keyframes[0] = {{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, -1, 0}, 0, {}};
  motion.keyframes[1] = {{0, 0, 0, 1, 0, 0, 0, 1, 1, 0, -1, 0}, 1, {}};
  motion.connect_as_sequence();
  const NormalGroups groups = NormalGroups::of_vertices(motion.topology, separate_points(4));
  for (const double t : {0.0, 0.25, 0.5, 1.0}) {
    const double r = std::sqrt(1 + t * t);
    const auto slope = [&](Weighting weighting, std::size_t vertex) {
      const Vec3d n = all_weighted_normals_at(motion.segment(0), groups, weighting, t)[vertex];
      EXPECT_NEAR(n.x, 0, 1e-15);
      return n.y / n.z;
    };
    EXPECT_NEAR(slope(Weighting::kArea, 0), -t / 2, 1e-14);
    EXPECT_NEAR(slope(Weighting::kUniform, 0), -t / (1 + r), 1e-14);
    EXPECT_NEAR(slope(Weighting::kAngle, 0), -t / (1 + r), 1e-14);
    EXPECT_NEAR(slope(Weighting::kAreaAngle, 1), -t / (1 + std::numbers::pi / (4 * std::atan(r))), 1e-14);
    EXPECT_NEAR(slope(Weighting::kMax, 0), -t / (2 + t * t), 1e-14);
  }
}

}  // namespace
}  // namespace chronormal::weightings_test
