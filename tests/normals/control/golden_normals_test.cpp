// Checks that one weighting and one grouping of chronormal reproduce the normals that other tools store. The tests are
// skipped unless the environment variable CHRONORMAL_DATA names the folder of their files.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "chronormal/normals/normal_groups.h"
#include "chronormal/normals/weighting.h"
#include "io/bytes/file.h"
#include "io/mesh/obj.h"
#include "tests/support/fixtures.h"

namespace chronormal::golden_normals_test {
namespace {

namespace fs = std::filesystem;

// A mesh file from another tool: the mesh as a motion, the stored normal of each corner, and the smoothing group of
// each face. read_obj() does not return the normals and groups here, so this test reads them from the file itself.
struct Golden {
  Motion motion;  // a motion whose two keyframes are both the mesh
  std::vector<float> normal_of_corner;
  std::vector<std::uint32_t> group_of_face;
};

Golden read_golden(const fs::path& path) {
  Golden golden;
  const auto file = FileBytes::open(path.string());
  const auto mesh = read_obj(file.value().bytes(), path.filename().string());
  golden.motion.topology = mesh.value().topology;
  for (const double time : {0.0, 1.0}) golden.motion.keyframes.push_back({mesh.value().positions, time, {}});
  golden.motion.connect_as_sequence();

  std::vector<std::array<float, 3>> normals;
  std::uint32_t group = 0;
  std::ifstream text(path);
  for (std::string line; std::getline(text, line);) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "vn") {
      auto& n = normals.emplace_back();
      words >> n[0] >> n[1] >> n[2];
    } else if (word == "s") {
      words >> word;
      group = 0;
      if (word != "off") std::from_chars(word.data(), word.data() + word.size(), group);
    } else if (word == "f") {
      golden.group_of_face.push_back(group);
      while (words >> word) {
        std::size_t index = 0;
        const std::size_t begin = word.rfind('/') + 1;
        std::from_chars(word.data() + begin, word.data() + word.size(), index);
        golden.normal_of_corner.insert(golden.normal_of_corner.end(), normals.at(index - 1).begin(),
                                       normals.at(index - 1).end());
      }
    }
  }
  EXPECT_EQ(golden.group_of_face.size(), golden.motion.topology.face_count());
  EXPECT_EQ(golden.normal_of_corner.size(), 3 * golden.motion.topology.corner_count());
  return golden;
}

VectorView<const float> stored(const Golden& golden) {
  return VectorView<const float>::packed(golden.normal_of_corner.data(), golden.normal_of_corner.size() / 3);
}

// Returns the largest angle, in degrees, between the normals of the elements and the normals that the file stores for
// the same corners.
double largest_difference(const Golden& golden, const NormalGroups& groups, Weighting weighting) {
  const auto normals = all_weighted_normals_at(golden.motion.segment(0), groups, weighting, 0);
  double worst = 0;
  for (std::size_t c = 0; c < golden.motion.topology.corner_count(); ++c) {
    const Vec3d found = normals[groups.element_of_corner()[c]], expected = to_double(stored(golden)[c]);
    EXPECT_EQ(found == Vec3d{}, expected == Vec3d{}) << "corner " << c << ": spider has faces without area";
    worst = std::max(worst, angle_between(found, expected) * kDegreesPerRadian);
  }
  return worst;
}

class GoldenNormals : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* const folder = std::getenv("CHRONORMAL_DATA");
    if (folder == nullptr) GTEST_SKIP() << "set CHRONORMAL_DATA to the folder of the real data to run this test";
    data_ = folder;
  }

  fs::path data_;
};

Points no_welding(const Golden& golden) { return separate_points(golden.motion.topology.vertex_count()); }

NormalGroups vertices_of(const Golden& golden) {
  return NormalGroups::of_vertices(golden.motion.topology, no_welding(golden));
}

NormalGroups smoothing_groups_of(const Golden& golden) {
  return NormalGroups::by_smoothing_group(golden.motion.topology, no_welding(golden), golden.group_of_face).value();
}

NormalGroups split_normals_of(const Golden& golden) {
  return NormalGroups::by_split_normals(golden.motion.topology, no_welding(golden), stored(golden)).value();
}

// Checks that the normals of a file follow the weighting of the tool that wrote it, within 0.01 degrees, whether hard
// edges are found from smoothing groups or from the stored normals. The weightings `others` must have larger errors;
// otherwise the file could not tell the weightings apart.
void expect_weighting(const Golden& golden, Weighting weighting, const std::vector<Weighting>& others) {
  for (const NormalGroups& groups : {smoothing_groups_of(golden), split_normals_of(golden)}) {
    EXPECT_LT(largest_difference(golden, groups, weighting), 0.01);
    for (const Weighting other : others) EXPECT_GT(largest_difference(golden, groups, other), 0.02);
  }
}

TEST_F(GoldenNormals, maya_weighs_by_area_times_angle_of_the_polygon) {
  std::size_t files = 0;
  for (const char* const folder : {"golden/maya_blend_inbetween", "golden/maya_cache_sine"}) {
    for (const auto& entry : fs::directory_iterator(data_ / folder)) {
      if (entry.path().extension() != ".obj") continue;
      SCOPED_TRACE(entry.path().filename().string());
      expect_weighting(read_golden(entry.path()), Weighting::kAreaAngle,
                       {Weighting::kAngle, Weighting::kUniform, Weighting::kMax});
      ++files;
    }
  }
  EXPECT_EQ(files, 9u);
}

TEST_F(GoldenNormals, blender_shades_flat_by_the_vector_area_of_quads_that_are_not_planar) {
  for (const char* const name : {"blender_279_sausage_base_0.obj", "blender_279_sausage_spin_15.obj"}) {
    SCOPED_TRACE(name);
    const Golden golden = read_golden(data_ / "golden/blender_flat" / name);
    const NormalGroups groups = smoothing_groups_of(golden);
    EXPECT_EQ(groups.size(), golden.motion.topology.corner_count()) << "s off";
    EXPECT_LT(largest_difference(golden, groups, Weighting::kArea), 0.01);
  }
}

TEST_F(GoldenNormals, spider_is_weighted_uniformly_within_smoothing_groups) {
  expect_weighting(read_golden(data_ / "golden/static/spider.obj"), Weighting::kUniform,
                   {Weighting::kArea, Weighting::kAngle, Weighting::kAreaAngle, Weighting::kMax});
}

TEST_F(GoldenNormals, the_tetrahedron_is_weighted_by_angle) {
  expect_weighting(read_golden(data_ / "golden/static/textured_tetrahedron.obj"), Weighting::kAngle,
                   {Weighting::kArea, Weighting::kUniform, Weighting::kAreaAngle, Weighting::kMax});
}

TEST_F(GoldenNormals, max_weighs_by_angle) {
  const Golden golden = read_golden(data_ / "caches/max_cache_box/max_cache_box_44.obj");
  EXPECT_LT(largest_difference(golden, split_normals_of(golden), Weighting::kAngle), 0.01);
  for (const Weighting other : {Weighting::kArea, Weighting::kUniform, Weighting::kAreaAngle, Weighting::kMax})
    EXPECT_GT(largest_difference(golden, split_normals_of(golden), other), 0.02);
}

TEST_F(GoldenNormals, trimesh_weighs_vertices_by_area) {
  const Golden golden = read_golden(data_ / "golden/static/groups.obj");
  for (const NormalGroups& groups : {vertices_of(golden), split_normals_of(golden)}) {
    EXPECT_LT(largest_difference(golden, groups, Weighting::kArea), 0.01);
    EXPECT_GT(largest_difference(golden, groups, Weighting::kAngle), 0.02);
  }
}

TEST_F(GoldenNormals, pytorch3d_sums_areas_and_leaves_faces_without_area_zero) {
  std::ifstream file(data_ / "golden/pytorch3d_test_compute_normals.json");
  const auto cases = nlohmann::json::parse(file)["cases"];
  EXPECT_EQ(cases.size(), 2u);
  for (const auto& one : cases) {
    SCOPED_TRACE(one["name"].get<std::string>());
    const auto points = one["verts"].get<std::vector<fixtures::Point>>();
    std::vector<std::uint32_t> corners;
    for (const auto& face : one["faces"]) {
      for (const auto& vertex : face) corners.push_back(vertex.get<std::uint32_t>());
    }
    const Motion motion = fixtures::make_motion(fixtures::make_triangles(points.size(), corners), points, points);
    const NormalGroups groups = NormalGroups::of_vertices(motion.topology, separate_points(points.size()));
    const auto normals = all_group_control_normals(motion.segment(0), groups);
    const auto expected = one["verts_normals"].get<std::vector<fixtures::Point>>();
    for (std::size_t v = 0; v < points.size(); ++v) {
      const Vec3d found = unit_normal_at(normals[v], 0.5).vector;
      const double tolerance = one["atol"].get<double>();
      EXPECT_NEAR(found.x, expected[v][0], tolerance) << v;
      EXPECT_NEAR(found.y, expected[v][1], tolerance) << v;
      EXPECT_NEAR(found.z, expected[v][2], tolerance) << v;
    }
  }
}

}  // namespace
}  // namespace chronormal::golden_normals_test
