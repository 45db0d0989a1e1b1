// docs/weightings.md is what its generator writes: byte for byte but for the blocks of times, and for those that cannot
// be measured here. Of those, the rows must be there.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "chronormal/normals/normal_groups.h"
#include "chronormal/normals/weighting.h"
#include "tests/support/child_process.h"
#include "tests/support/generated_page.h"
#include "tests/support/process.h"

namespace chronormal::weightings_test {
namespace {

TEST(Weightings, page_and_picture_are_what_the_generator_writes) {
  if (test::is_sanitized()) GTEST_SKIP() << "the generator takes minutes under sanitizers; the release build runs it";
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
    // Other libraries and files are compared where they are.
    if (block != "times" && !anew.inside.empty()) continue;
    if (block != "times") std::printf("not measured here, so not compared: %s\n", block.c_str());
    committed = ours.page, generated = anew.page;
  }
  test::expect_same_text(committed, generated, "docs/weightings.md");
  EXPECT_EQ(test::expect_same_pictures(folder, committed), 1u);
}

TEST(Weightings, page_has_a_row_for_every_library_and_file_that_it_was_measured_with) {
  const std::string page = test::read_whole((test::kDocs / "weightings.md").string());
  const std::string peers = test::without_blocks(page, "peers").inside,
                    golden = test::without_blocks(page, "golden").inside;
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
