// Tests the reading of meshes in world space, to which the transformations of the scene's nodes move them.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "chronormal/normals/control_normals.h"
#include "io/gltf/gltf_motion.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/gltf_weights.h"

namespace chronormal::gltf_world_test {
namespace {

using test::GltfBuilder, test::GltfFixture;
using Json = GltfBuilder::Json;

// Makes a triangle in the plane z = 0 with one target, in which the third vertex rises by 1.
GltfBuilder triangle() {
  GltfBuilder builder;
  const auto base = builder.add_positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
  const auto lift = builder.add_positions({0, 0, 0, 0, 0, 0, 0, 0, 1});
  builder.add_mesh(GltfBuilder::primitive(base, std::nullopt, Json::array({{{"POSITION", lift}}})));
  return builder;
}

Result<GltfMotion> world_motion(const GltfBuilder& builder, const std::string& animation = "") {
  const GltfFixture file(builder);
  EXPECT_TRUE(file.ok()) << file.error();
  if (!file.ok()) return invalid_input("", "no document");
  GltfMotionOptions options;
  options.animation = animation;
  options.world = true;
  return read_gltf_motion(*file, options);
}

void expect_near(const std::vector<float>& actual, const std::vector<float>& expected) {
  ASSERT_EQ(actual.size(), expected.size());
  for (std::size_t i = 0; i < actual.size(); ++i) EXPECT_NEAR(actual[i], expected[i], 1e-6) << i;
}

Vec3d first_normal_at_start(const Motion& motion, std::size_t face) {
  ControlNormals normals;
  face_control_normals(motion.segment(0), {face, 1}, {&normals, 1});
  return normals.n0;
}

TEST(GltfWorld, scale_rotation_and_translation_of_a_node_and_its_parent_apply_in_that_order) {
  GltfBuilder builder = triangle();
  const double half = std::sqrt(0.5);
  // The child node scales the mesh by 2 and moves it by 3 along z. The parent node turns it by 90 degrees about z and
  // moves it by 10 along x.
  builder.add_node(0, {{"scale", {2, 2, 2}}, {"translation", {0, 0, 3}}});
  builder.json["nodes"].push_back({{"children", {0}}, {"rotation", {0, 0, half, half}}, {"translation", {10, 0, 0}}});
  const auto motion = world_motion(builder);
  ASSERT_TRUE(motion.ok()) << motion.error().text();
  expect_near(motion.value().motion.keyframes[0].positions, {10, 0, 3, 10, 2, 3, 8, 0, 3});
  expect_near(motion.value().motion.keyframes[1].positions, {10, 0, 3, 10, 2, 3, 8, 0, 5});
  EXPECT_EQ(motion.value().parts.at(0).node, std::optional<std::size_t>(0));
}

TEST(GltfWorld, a_matrix_is_column_by_column) {
  GltfBuilder builder = triangle();
  builder.add_node(0, {{"matrix", {0, 1, 0, 0, /**/ -1, 0, 0, 0, /**/ 0, 0, 1, 0, /**/ 5, 6, 7, 1}}});
  const auto motion = world_motion(builder);
  ASSERT_TRUE(motion.ok()) << motion.error().text();
  expect_near(motion.value().motion.keyframes[0].positions, {5, 6, 7, 5, 7, 7, 4, 6, 7});
}

TEST(GltfWorld, mirrored_faces_keep_their_outward_side) {
  GltfBuilder builder = triangle();
  builder.add_node(0);
  builder.add_node(0, {{"scale", {-1, 1, 1}}});
  builder.add_node(0, {{"scale", {1, 1, -1}}});
  const auto result = world_motion(builder);
  ASSERT_TRUE(result.ok()) << result.error().text();
  const Motion& motion = result.value().motion;
  ASSERT_EQ(motion.topology.face_count(), 3U);
  // The normal of the triangle points along +z. A node that mirrors the mesh in x keeps this direction, and a node that
  // mirrors the mesh in z reverses it.
  EXPECT_GT(first_normal_at_start(motion, 0).z, 0);
  EXPECT_GT(first_normal_at_start(motion, 1).z, 0);
  EXPECT_LT(first_normal_at_start(motion, 2).z, 0);
  EXPECT_EQ(std::vector<std::uint32_t>(motion.topology.face(1).begin(), motion.topology.face(1).end()),
            (std::vector<std::uint32_t>{3, 5, 4}));
}

TEST(GltfWorld, every_node_with_the_mesh_is_a_part_and_one_with_a_skin_stays) {
  GltfBuilder builder = triangle();
  builder.add_node(0, {{"translation", {1, 0, 0}}});
  builder.add_node(0, {{"translation", {2, 0, 0}}, {"skin", 0}});
  const auto result = world_motion(builder);
  ASSERT_TRUE(result.ok()) << result.error().text();
  ASSERT_EQ(result.value().parts.size(), 2U);
  expect_near(result.value().motion.keyframes[0].positions,
              {1, 0, 0, 2, 0, 0, 1, 1, 0, /**/ 0, 0, 0, 1, 0, 0, 0, 1, 0});
}

TEST(GltfWorld, without_it_nodes_do_not_matter_and_with_it_an_animation_is_placed_too) {
  GltfBuilder builder = triangle();
  builder.add_node(0, {{"translation", {0, 0, 4}}, {"scale", {1, 1, 3}}});
  builder.add_track<float>(builder.add_animation("rise"), 0, {0, 2}, {0, 1});
  const GltfFixture file(builder);
  ASSERT_TRUE(file.ok()) << file.error();
  const auto still = read_gltf_motion(*file, {});
  ASSERT_TRUE(still.ok());
  expect_near(still.value().motion.keyframes[1].positions, {0, 0, 0, 1, 0, 0, 0, 1, 1});
  const auto placed = world_motion(builder, "rise");
  ASSERT_TRUE(placed.ok()) << placed.error().text();
  expect_near(placed.value().motion.keyframes[1].positions, {0, 0, 4, 1, 0, 4, 0, 1, 7});
  EXPECT_EQ(placed.value().motion.keyframes[1].time, 2);
}

TEST(GltfWorld, cut_splines_state_their_error_in_the_world) {
  const auto curve_error = [](double scale) {
    GltfBuilder builder = triangle();
    builder.add_node(0, {{"scale", {scale, scale, scale}}});
    builder.add_track<float>(builder.add_animation("rise"), 0, {0, 1}, {0, 0, 2, 2, 1, 0}, "CUBICSPLINE");
    return world_motion(builder, "rise").value().curve_error;
  };
  const double small = curve_error(1), large = curve_error(100);
  EXPECT_GT(small, 0);
  EXPECT_NEAR(large, 100 * small, 1e-9 * large);
}

TEST(GltfWorld, transforms_that_are_none_are_refused_with_their_place) {
  const std::pair<Json, std::string> cases[] = {
      {{{"translation", {1, 2}}}, "/nodes/0/translation"},
      {{{"scale", {1, 2, "three"}}}, "/nodes/0/scale/2"},
      {{{"rotation", {0, 0, 0, 0}}}, "/nodes/0/rotation"},
      {{{"matrix", Json::array({1, 0, 0})}}, "/nodes/0/matrix"},
      {{{"matrix", Json::array({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1})}, {"scale", {1, 1, 1}}},
       "/nodes/0/matrix"},
  };
  for (const auto& [extra, pointer] : cases) {
    GltfBuilder builder = triangle();
    builder.add_node(0, extra);
    const GltfFixture file(builder);
    EXPECT_FALSE(file.ok()) << pointer;
    EXPECT_NE(file.error().find(pointer), std::string::npos) << file.error();
  }
}

}  // namespace
}  // namespace chronormal::gltf_world_test
