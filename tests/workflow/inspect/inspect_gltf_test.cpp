#include "chronormal/workflow/inspect.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "io/gltf/gltf_motion.h"
#include "tests/support/gltf_builder.h"

namespace chronormal::inspect_gltf_test {
namespace {

using test::GltfBuilder, test::GltfFixture;

GltfInspection inspect_document(const GltfBuilder& builder) {
  const GltfFixture file(builder);
  EXPECT_TRUE(file.ok()) << file.error();
  auto found = inspect(*file);
  EXPECT_TRUE(found.ok()) << found.error().text();
  return std::move(found).value();
}

TEST(InspectGltf, targets_with_and_without_normals_are_counted) {
  GltfBuilder builder = test::quad_document();
  auto& primitive = builder.json["meshes"][0]["primitives"][0];
  const std::vector<float> up = {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, none(12, 0.0F);
  primitive["attributes"]["NORMAL"] = builder.add_accessor("VEC3", up);
  primitive["targets"][1]["NORMAL"] = builder.add_accessor("VEC3", none);
  const GltfInspection found = inspect_document(builder);
  ASSERT_EQ(found.primitives.size(), 1U);
  EXPECT_EQ(found.primitives[0].triangles, 2U);
  EXPECT_EQ(found.primitives[0].moving, 2U);
  EXPECT_EQ(found.primitives[0].moving_normals, 1U);
  EXPECT_EQ(found.primitives[0].moving_tangents, 0U);
  EXPECT_EQ(found.primitives[0].off_length, 0U);
  EXPECT_EQ(found.primitives[0].doubled, 0U);
  EXPECT_EQ(found.instances, std::vector<std::size_t>{1});
  EXPECT_EQ(found.skinned_nodes, 0U);
}

TEST(InspectGltf, normals_that_differ_at_one_place_are_split_and_wrong_lengths_are_counted) {
  // Vertices 2, 3 and 4 are at the position of vertex 0. Vertex 2 has the same normal as vertex 0, vertex 3 has a
  // different normal, and the normal of vertex 4 differs only by rounding.
  GltfBuilder builder;
  const std::vector<float> places = {0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, -0.0F, 0, 0, 1, 0};
  const std::vector<float> normals = {0, 0, 1, 0, 0, 1.2F, 0, 0, 1, 0, 1, 0, 0, 1e-4F, 1, 0, 0, 0};
  auto primitive = GltfBuilder::primitive(builder.add_positions(places),
                                          builder.add_indices<std::uint8_t>({0, 1, 5, 2, 1, 5, 3, 4, 5}));
  primitive["attributes"]["NORMAL"] = builder.add_accessor("VEC3", normals);
  builder.add_mesh(primitive);
  const GltfInspection found = inspect_document(builder);
  EXPECT_EQ(found.primitives[0].doubled, 3U);
  EXPECT_EQ(found.primitives[0].split, 1U);
  EXPECT_EQ(found.primitives[0].off_length, 2U);
  EXPECT_EQ(found.instances, std::vector<std::size_t>{0});
}

TEST(InspectGltf, tracks_tell_their_time_and_their_weights) {
  GltfBuilder builder = test::quad_document();
  const std::size_t animation = builder.add_animation("a");
  builder.add_track(animation, 0, {0.5F, 2}, std::vector<float>{0, 0.25F, 1.5F, -0.5F});
  const std::size_t spline = builder.add_animation("b");
  // The tangent before the first key and the tangent after the last key have no effect.
  builder.add_track(spline, 0, {1, 3}, std::vector<float>{9, 9, 0, 1, 0, 0, 0, 0, 0.5F, 0.75F, 9, 9}, "CUBICSPLINE");
  const GltfInspection found = inspect_document(builder);
  ASSERT_EQ(found.tracks.size(), 2U);
  EXPECT_EQ(found.tracks[0].first_time, 0.5);
  EXPECT_EQ(found.tracks[0].last_time, 2);
  EXPECT_EQ(found.tracks[0].lowest, -0.5);
  EXPECT_EQ(found.tracks[0].highest, 1.5);
  EXPECT_EQ(found.tracks[1].animation, 1U);
  EXPECT_EQ(found.tracks[1].lowest, 0);
  EXPECT_EQ(found.tracks[1].highest, 1);
}

TEST(InspectGltf, range_of_a_spline_is_what_it_reaches_between_its_keys) {
  GltfBuilder builder = test::quad_document();
  const std::size_t animation = builder.add_animation("a");
  // Between the first and the second key, which are two seconds apart, the first weight is 20 t (1 - t), with the
  // maximum 5 in the middle. The second weight is -9 t (1 - t)^2 / 2, with the minimum -2/3 at t = 1/3. Both weights
  // are zero from the second to the third key.
  builder.add_track(animation, 0, {1, 3, 4},
                    std::vector<float>{0, 0, 0, 0, 10, -2.25F, -10, 0, 0, 0, 0, 0, 0, 0, 0, 0, 7, 7}, "CUBICSPLINE");
  const GltfInspection found = inspect_document(builder);
  EXPECT_NEAR(found.tracks[0].highest, 5, 1e-12);
  EXPECT_NEAR(found.tracks[0].lowest, -2.0 / 3, 1e-12);
}

TEST(InspectGltf, split_normals_of_a_motion_are_at_vertices_that_stay_together) {
  // Vertices 3 and 4 are at the positions of vertices 0 and 1, with different normals. In the target, vertex 3
  // separates from vertex 0. The second primitive coincides with the first.
  GltfBuilder builder;
  const std::size_t base = builder.add_positions({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -1, 0});
  const std::size_t target = builder.add_positions({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0});
  auto primitive =
      GltfBuilder::primitive(base, builder.add_indices<std::uint8_t>({0, 1, 2, 3, 4, 5}), {{{"POSITION", target}}});
  const auto with_normals = [&](const std::vector<float>& normals) {
    primitive["attributes"]["NORMAL"] = builder.add_accessor("VEC3", normals);
    return primitive;
  };
  const std::size_t mesh = builder.add_mesh(with_normals({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 1, 0, 0, 1, 0}));
  const auto split_of = [](const GltfBuilder& document) {
    const GltfFixture file(document);
    const GltfMotion read = read_gltf_motion(*file, {}).value();
    return count_split_normals(*file, read.motion, read.parts).value();
  };
  EXPECT_EQ(split_of(builder), 1U);
  builder.add_primitive(mesh, with_normals({1, 0, 0, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 0, 1, 0, 1, 0}));
  EXPECT_EQ(split_of(builder), 2U);
  // The third primitive is at another place, so it shares no normals with the others.
  const std::size_t elsewhere = builder.add_positions({5, 0, 0, 6, 0, 0, 5, 1, 0, 5, 0, 1, 6, 0, 1, 5, -1, 0});
  auto third = with_normals({0, 0, -1, 0, 0, -1, 0, 0, -1, 0, -1, 0, 0, -1, 0, 0, -1, 0});
  third["attributes"]["POSITION"] = elsewhere;
  builder.add_primitive(mesh, third);
  EXPECT_EQ(split_of(builder), 2U);
}

TEST(InspectGltf, points_skins_and_instances_are_counted) {
  GltfBuilder builder = test::quad_document();
  builder.add_primitive(0, GltfBuilder::primitive(0, std::nullopt, {{{"POSITION", 2}}, {{"POSITION", 3}}}, 0));
  builder.add_node(0);
  const std::size_t joint = builder.add("nodes", GltfBuilder::Json::object());
  builder.add("skins", {{"joints", {joint}}});
  builder.add_node(0, {{"skin", 0}});
  const GltfInspection found = inspect_document(builder);
  EXPECT_EQ(found.primitives.size(), 1U);
  EXPECT_EQ(found.without_faces, 1U);
  EXPECT_EQ(found.instances, std::vector<std::size_t>{3});
  EXPECT_EQ(found.skinned_nodes, 1U);
}

TEST(InspectGltf, broken_geometry_is_an_error) {
  GltfBuilder builder = test::quad_document();
  builder.json["accessors"][1]["count"] = 60000;
  const GltfFixture file(builder);
  EXPECT_TRUE(!file.ok() || !inspect(*file).ok());
}

}  // namespace
}  // namespace chronormal::inspect_gltf_test
