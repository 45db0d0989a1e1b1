#include "workflow/shading/gltf_shading.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "tests/support/gltf_builder.h"
#include "tests/support/shaded_mesh.h"

namespace chronormal::gltf_shading_test {
namespace {

using test::GltfBuilder;
using test::GltfFixture;
using test::hinge;
using test::ShadedMesh;
using Json = GltfBuilder::Json;

constexpr std::uint32_t kNone = GltfShading::kNoElement;

GltfShading read(const GltfBuilder& builder, const GltfShadingOptions& options = {}) {
  const GltfFixture fixture(builder);
  EXPECT_TRUE(fixture.ok()) << fixture.error();
  Result<GltfShading> shading = read_gltf_shading(*fixture, 0, options);
  EXPECT_TRUE(shading.ok()) << shading.error().text();
  return std::move(shading).value();
}

std::string error_of(const GltfBuilder& builder, const GltfShadingOptions& options = {}) {
  const GltfFixture fixture(builder);
  EXPECT_TRUE(fixture.ok()) << fixture.error();
  const Result<GltfShading> shading = read_gltf_shading(*fixture, 0, options);
  return shading.ok() ? "" : shading.error().text();
}

// Returns one of the two triangles of the hinge as a separate mesh. In a file of both halves, the vertices at their
// common edge are separate.
ShadedMesh half(std::size_t which) {
  const ShadedMesh whole = hinge();
  ShadedMesh part;
  for (std::size_t c = 3 * which; c < 3 * which + 3; ++c) {
    const std::size_t v = whole.corners[c];
    part.corners.push_back(static_cast<std::uint32_t>(c - 3 * which));
    part.targets.resize(1);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      part.positions.push_back(whole.positions[3 * v + axis]);
      part.normals.push_back(whole.normals[3 * v + axis]);
      part.targets[0].positions.push_back(whole.targets[0].positions[3 * v + axis]);
    }
  }
  return part;
}

GltfBuilder halves(const ShadedMesh& a, const ShadedMesh& b) {
  GltfBuilder builder;
  const std::size_t mesh = builder.add_mesh(a.primitive(builder));
  builder.add_primitive(mesh, b.primitive(builder));
  builder.add_node(mesh);
  return builder;
}

TEST(GltfShading, vertices_at_one_point_share_an_element_across_primitives) {
  const GltfShading shading = read(halves(half(0), half(1)));
  ASSERT_EQ(shading.element_of_vertex.size(), 6U);
  const std::vector<std::uint32_t>& e = shading.element_of_vertex;
  EXPECT_EQ(e[1], e[4]);
  EXPECT_EQ(e[2], e[3]);
  EXPECT_EQ(std::set<std::uint32_t>(e.begin(), e.end()).size(), 4U);
  EXPECT_EQ(shading.groups.corners(e[1]).size(), 2U);
  ASSERT_EQ(shading.parts.size(), 2U);
  EXPECT_EQ(shading.parts[1].first_vertex, 3U);
  EXPECT_EQ(shading.parts[1].first_face, 1U);
}

TEST(GltfShading, other_base_normals_or_other_deltas_keep_vertices_apart) {
  ShadedMesh second = half(1);
  second.normals = {1, 0, 0, 0, 0, 1, 0, 0, 1};  // vertex 3 is at the position of vertex 2
  GltfShading shading = read(halves(half(0), second));
  EXPECT_NE(shading.element_of_vertex[2], shading.element_of_vertex[3]);
  EXPECT_EQ(shading.element_of_vertex[1], shading.element_of_vertex[4]);
  second = half(1);
  second.targets[0].positions[0] = 0.5F;
  shading = read(halves(half(0), second));
  EXPECT_NE(shading.element_of_vertex[2], shading.element_of_vertex[3]);
  EXPECT_EQ(shading.element_of_vertex[1], shading.element_of_vertex[4]);
}

TEST(GltfShading, negative_zero_is_zero_when_vertices_are_welded) {
  ShadedMesh second = half(1);
  for (float& v : second.targets[0].positions) v = v == 0 ? -0.0F : v;
  for (float& v : second.positions) v = v == 0 ? -0.0F : v;
  const GltfShading shading = read(halves(half(0), second));
  EXPECT_EQ(shading.element_of_vertex[2], shading.element_of_vertex[3]);
}

TEST(GltfShading, deltas_of_several_targets_weld_as_a_comparison_of_all_pairs_does) {
  fixtures::Random random(7);
  for (int round = 0; round < 50; ++round) {
    ShadedMesh mesh;
    constexpr std::size_t kVertices = 12;
    mesh.targets.resize(3);
    const auto push = [&](std::vector<float>& values, std::size_t kinds) {
      values.insert(values.end(), {static_cast<float>(random.below(kinds)), 0, 0});
    };
    for (std::size_t v = 0; v < kVertices; ++v) {
      push(mesh.positions, 2);
      mesh.normals.insert(mesh.normals.end(), {0, 0, 1});
      for (auto& target : mesh.targets) push(target.positions, 2);
      mesh.corners.push_back(static_cast<std::uint32_t>(v));
    }
    const GltfShading shading = read(mesh.file());
    for (std::size_t a = 0; a < kVertices; ++a)
      for (std::size_t b = 0; b < kVertices; ++b)
        EXPECT_EQ(shading.element_of_vertex[a] == shading.element_of_vertex[b], mesh.same_element(a, b));
  }
}

TEST(GltfShading, faces_of_flat_primitives_count_for_no_element) {
  ShadedMesh flat = half(1);
  flat.normals.clear();
  const GltfShading shading = read(halves(half(0), flat));
  for (std::size_t v = 3; v < 6; ++v) EXPECT_EQ(shading.element_of_vertex[v], kNone);
  const std::vector<double> folded = {1};
  const std::vector<Vec3d> normals = normals_from_positions(shading, folded);
  for (std::size_t v = 0; v < 3; ++v) {
    EXPECT_EQ(normals[shading.element_of_vertex[v]], (Vec3d{0, 0, 4})) << v;  // the normal of the face at rest
    EXPECT_EQ(shading.groups.faces(shading.element_of_vertex[v]).size(), 1U);
  }
}

TEST(GltfShading, zero_normals_do_not_join_a_flat_primitive) {
  ShadedMesh zero = half(0), flat = half(1);
  zero.normals.assign(9, 0);
  flat.normals.clear();
  const GltfShading shading = read(halves(zero, flat));
  EXPECT_EQ(shading.groups.faces(shading.element_of_vertex[1]).size(), 1U);
  EXPECT_EQ(shading.element_of_vertex[4], kNone);
}

TEST(GltfShading, smooth_primitives_share_among_themselves_by_the_crease_angle) {
  ShadedMesh first = half(0), second = half(1);
  first.normals.clear();
  second.normals.clear();
  second.positions[8] = 2;  // the base is folded by 45 degrees
  GltfShading shading = read(halves(first, second), {.smooth = true, .crease_angle = 60});
  EXPECT_EQ(shading.element_of_vertex[1], shading.element_of_vertex[4]);
  EXPECT_EQ(shading.split_by_crease, 0U);
  shading = read(halves(first, second), {.smooth = true, .crease_angle = 30});
  EXPECT_NE(shading.element_of_vertex[1], shading.element_of_vertex[4]);
  EXPECT_NE(shading.element_of_vertex[4], kNone);
  // If one half of the hinge has stored normals and the other half has none, the halves share no normals.
  shading = read(halves(half(0), second), {.smooth = true, .crease_angle = 180});
  EXPECT_NE(shading.element_of_vertex[1], shading.element_of_vertex[4]);
  EXPECT_EQ(shading.groups.faces(shading.element_of_vertex[1]).size(), 1U);
}

TEST(GltfShading, a_vertex_that_a_crease_would_split_stays_whole_and_is_counted) {
  ShadedMesh mesh = hinge();
  mesh.normals.clear();
  mesh.positions[11] = 2;
  const GltfShading shading = read(mesh.file(), {.smooth = true, .crease_angle = 30});
  EXPECT_EQ(shading.split_by_crease, 2U);
  for (const std::size_t v : {1U, 2U}) EXPECT_EQ(shading.groups.faces(shading.element_of_vertex[v]).size(), 2U);
  EXPECT_NE(error_of(mesh.file(), {.smooth = true, .crease_angle = 181}), "");
}

TEST(GltfShading, parts_on_both_sides_of_such_a_vertex_are_joined_where_copies_show_them) {
  // A third triangle continues the second triangle in its plane. Vertices 4 and 5 of the third triangle are copies of
  // vertices 2 and 3.
  ShadedMesh mesh = hinge();
  mesh.normals.clear();
  mesh.positions[11] = 2;
  mesh.positions.insert(mesh.positions.end(), {0, 1, 0, 2, 0, 2, 2, 1, 2});
  mesh.corners.insert(mesh.corners.end(), {4, 5, 6});
  mesh.targets[0].positions.assign(21, 0);
  const GltfShading shading = read(mesh.file(), {.smooth = true, .crease_angle = 30});
  EXPECT_EQ(shading.split_by_crease, 2U);
  EXPECT_EQ(shading.element_of_vertex[2], shading.element_of_vertex[4]);
  EXPECT_EQ(shading.groups.faces(shading.element_of_vertex[4]).size(), 3U);
  EXPECT_EQ(shading.groups.faces(shading.element_of_vertex[1]).size(), 2U);
}

TEST(GltfShading, normals_from_positions_are_those_of_an_independent_sum) {
  const ShadedMesh mesh = test::random_sheet(3, 6, 3, 0.2);
  const GltfShading shading = read(mesh.file());
  for (const std::vector<double>& weights : {std::vector<double>{0, 0, 0}, {1, 0, 0}, {0.3, -0.7, 1.9}}) {
    const std::vector<Vec3d> normals = normals_from_positions(shading, weights);
    for (std::size_t v = 0; v < mesh.vertices(); ++v) {
      const Vec3d n = normals[shading.element_of_vertex[v]];
      const test::Vector expected = mesh.normal(v, weights);
      EXPECT_NEAR(n.x, static_cast<double>(expected[0]), 1e-13);
      EXPECT_NEAR(n.y, static_cast<double>(expected[1]), 1e-13);
      EXPECT_NEAR(n.z, static_cast<double>(expected[2]), 1e-13);
    }
  }
}

TEST(GltfShading, triangles_that_name_a_vertex_twice_are_left_out) {
  const ShadedMesh mesh = hinge();
  ShadedMesh strip = mesh;
  strip.corners = {0, 0, 1, 0, 1, 2, 3, 0, 3, 1, 3, 3, 2, 1, 3, 2, 2, 2};
  const GltfShading shading = read(strip.file());
  const auto corners = shading.set.topology.corners();
  EXPECT_EQ(std::vector<std::uint32_t>(corners.begin(), corners.end()), mesh.corners);
  EXPECT_EQ(shading.parts[0].face_count, 2U);
  EXPECT_EQ(shading.groups.faces(shading.element_of_vertex[3]).size(), 1U);
  // The second primitive begins after the triangles of the first that are left.
  EXPECT_EQ(read(halves(strip, half(1))).parts[1].first_face, 2U);
  // A primitive without any other triangle keeps them.
  strip.corners = {0, 1, 1};
  EXPECT_EQ(read(strip.file()).set.topology.face_count(), 1U);
}

TEST(GltfShading, stored_arrays_have_zeros_where_a_primitive_has_none) {
  ShadedMesh first = half(0), second = half(1);
  first.normals.clear();
  second.targets[0].normals = {1, 0, 0, 2, 0, 0, 3, 0, 0};
  second.tangents = {1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, -1};
  const GltfShading shading = read(halves(first, second));
  EXPECT_EQ(shading.normals, (std::vector<float>{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 1}));
  EXPECT_EQ(shading.normal_deltas[0], (std::vector<float>{0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 0}));
  ASSERT_EQ(shading.tangents.size(), 24U);
  EXPECT_EQ(shading.tangents[23], -1);
  EXPECT_TRUE(shading.tangent_deltas[0].empty());
  const GltfShading turned = read(halves(second, first));
  EXPECT_EQ(turned.tangents.size(), 24U);
  EXPECT_EQ(turned.normal_deltas[0].size(), 18U);
  EXPECT_EQ(turned.normals.size(), 18U);
}

TEST(GltfShading, shown_direction_keeps_the_turn_of_the_author) {
  const Vec3d stored = unit(Vec3d{1, 0, 1}), up{0, 0, 3};
  EXPECT_LT(length(shown_direction(stored, up, up) - stored), 1e-15);
  // The rotation by 45 degrees about y keeps (0, 1, 0), and lowers (1, 0, 0).
  EXPECT_LT(length(shown_direction(stored, up, {0, 2, 0}) - Vec3d{0, 1, 0}), 1e-15);
  EXPECT_LT(length(shown_direction(stored, up, {5, 0, 0}) - unit(Vec3d{1, 0, -1})), 1e-15);
  EXPECT_EQ(shown_direction({}, up, {0, 2, 0}), (Vec3d{0, 1, 0}));
  EXPECT_EQ(shown_direction(stored, {}, {0, 2, 0}), (Vec3d{0, 1, 0}));
  EXPECT_EQ(shown_direction(stored, up, {}), Vec3d{});
}

// Makes a hinge with two targets of the author and two correction targets, and with a mark of a bake.
GltfBuilder marked(const Json& mark) {
  ShadedMesh mesh = hinge();
  mesh.targets.push_back(mesh.targets[0]);
  for (int extra = 0; extra < 2; ++extra)
    mesh.targets.push_back({std::vector<float>(12, 0), std::vector<float>(12, 0.5F), {}});
  GltfBuilder builder = mesh.file();
  builder.json["meshes"][0]["extras"]["chronormal"] = mark;
  return builder;
}

// Returns the mark that a bake leaves in the extras, in version 1. The mark means the same as good_mark(), which has
// version 2.
Json mark_of_factors() {
  return {{"version", 1},
          {"encode", "exact"},
          {"sequence", false},
          {"extras", {{{"target", 2}, {"factors", {0, 0}}}, {{"target", 3}, {"factors", {1, "base"}}}}}};
}
Json good_mark() {
  return R"({"version": 2, "encode": "exact", "sequence": false, "extras": [
    {"target": 2, "linear": [], "quadratic": [[0, 0, 1]]},
    {"target": 3, "linear": [[1, 1]], "quadratic": [[0, 1, -1], [1, 1, -1]]}]})"_json;
}

TEST(GltfShading, mark_of_a_bake_says_which_weights_follow_in_both_versions) {
  for (const Json& mark : {good_mark(), mark_of_factors()}) {
    const GltfShading shading = read(marked(mark));
    ASSERT_TRUE(shading.mark.has_value());
    EXPECT_EQ(shading.mark->encoding, BakeEncoding::kExact);
    EXPECT_FALSE(shading.mark->sequence);
    EXPECT_EQ(shading.mark->extras,
              (std::vector<GltfExtraTarget>{{2, {}, {{0, 0, 1}}}, {3, {{1, 1}}, {{0, 1, -1}, {1, 1, -1}}}}));
    EXPECT_EQ(shading.own_targets(), 2U);
    std::vector<double> weights = {0.5, 0.25, 9, 9};
    fill_extra_weights(shading, weights);
    EXPECT_EQ(weights, (std::vector<double>{0.5, 0.25, 0.25, 0.0625}));
  }
}

TEST(GltfShading, weight_of_an_extra_target_is_the_sum_of_its_terms) {
  Json mark = good_mark();
  mark["extras"][1]["linear"] = {{0, -2.5}, {1, 0.5}};
  mark["extras"][1]["quadratic"] = {{0, 1, 3}, {1, 1, 0.25}};
  const GltfExtraTarget extra = read(marked(mark)).mark->extras[1];
  EXPECT_DOUBLE_EQ(extra.weight(std::vector<double>{2, 4, 0, 0}), -5 + 2 + 24 + 4);
  EXPECT_TRUE(extra.follows(0));
  EXPECT_TRUE(extra.follows(1));
  mark["extras"][1]["linear"] = Json::array();
  EXPECT_FALSE(read(marked(mark)).mark->extras[1].follows(0)) << "alone, a factor of a product makes nothing";
  EXPECT_TRUE(read(marked(mark)).mark->extras[1].follows(1));
}

TEST(GltfShading, mark_whose_flag_became_a_number_is_read) {
  Json mark = good_mark();
  for (const int flag : {0, 1}) {
    mark["sequence"] = flag;
    EXPECT_EQ(read(marked(mark)).mark->sequence, flag == 1);
  }
  mark["sequence"] = 2;
  EXPECT_NE(error_of(marked(mark)).find("/sequence: the value must be true or false"), std::string::npos);
}

TEST(GltfShading, mark_whose_extra_targets_all_turn_nothing_is_none) {
  const auto emptied = [](std::initializer_list<std::size_t> targets) {
    GltfBuilder builder = marked(good_mark());
    Json& all = builder.json["meshes"][0]["primitives"][0]["targets"];
    for (const std::size_t k : targets) all[k]["NORMAL"] = all[k]["POSITION"];
    return builder;
  };
  const GltfShading half = read(emptied({2}));
  EXPECT_TRUE(half.mark.has_value());
  EXPECT_EQ(half.emptied, 0U);
  const GltfShading none = read(emptied({2, 3}));
  EXPECT_FALSE(none.mark.has_value());
  EXPECT_EQ(none.emptied, 2U);
  EXPECT_EQ(none.own_targets(), 4U);
}

TEST(GltfShading, mark_without_extra_targets_is_a_mark) {
  Json mark = good_mark();
  mark["extras"] = Json::array();
  EXPECT_TRUE(read(marked(mark)).mark->extras.empty());
  mark.erase("extras");
  EXPECT_TRUE(read(marked(mark)).mark->extras.empty());
}

TEST(GltfShading, mark_that_makes_no_sense_is_an_error_with_its_place_and_nothing_else_is) {
  Json good = good_mark();
  const auto with = [&good](const char* pointer, const Json& value) {
    Json mark = good;
    mark[Json::json_pointer(pointer)] = value;
    return error_of(marked(mark));
  };
  const auto has = [](const std::string& text, const std::string& word) {
    return text.find(word) != std::string::npos ? "" : text + " has no " + word;
  };
  const std::string at = "a.gltf, /meshes/0/extras/chronormal";
  EXPECT_EQ(has(with("/version", 3), at + "/version"), "");
  EXPECT_EQ(has(with("/encode", "best"), at + "/encode"), "");
  EXPECT_EQ(has(with("/encode", 3), at + "/encode"), "");
  EXPECT_EQ(has(with("/sequence", "no"), at + "/sequence"), "");
  EXPECT_EQ(has(with("/extras", 5), at + "/extras"), "");
  EXPECT_EQ(has(with("/extras/0", 5), at + "/extras/0"), "");
  EXPECT_EQ(has(with("/extras/1/target", 2), at + "/extras/1/target"), "");
  EXPECT_EQ(has(with("/extras/1/target", 4), at + "/extras/1/target"), "");
  EXPECT_EQ(has(with("/extras/0/linear", 1), at + "/extras/0/linear"), "");
  EXPECT_EQ(has(with("/extras/1/linear/0", {1, 1, 1}), at + "/extras/1/linear/0"), "");
  EXPECT_EQ(has(with("/extras/1/linear/0/1", "1"), at + "/extras/1/linear/0/1"), "");
  EXPECT_EQ(has(with("/extras/1/linear/0/0", 4), at + "/extras/1/linear/0/0"), "");
  EXPECT_EQ(has(with("/extras/1/linear/0/0", 2), at + "/extras/1"), "") << "an extra target follows from no other";
  EXPECT_EQ(has(with("/extras/0/quadratic/0", {0, 1}), at + "/extras/0/quadratic/0"), "");
  EXPECT_EQ(has(with("/extras/0/quadratic/0/1", 2.5), at + "/extras/0/quadratic/0/1"), "");
  EXPECT_EQ(has(with("/extras/0/quadratic/0/1", 3), at + "/extras/0"), "");
  EXPECT_EQ(has(with("/extras/0/quadratic/0/2", nullptr), at + "/extras/0/quadratic/0/2"), "");
  good = mark_of_factors();
  EXPECT_EQ(has(with("/extras/0/factors/1", 2), at + "/extras/0"), "");
  EXPECT_EQ(has(with("/extras/1/factors/0", "base"), at + "/extras/1/factors"), "");
  EXPECT_EQ(has(with("/extras/0/factors/1", "all"), at + "/extras/0/factors/1"), "");
  EXPECT_EQ(has(with("/extras/0/factors", {1}), at + "/extras/0/factors"), "");
  EXPECT_EQ(has(error_of(marked("none")), at), "");
  EXPECT_EQ(has(error_of(marked(Json::array())), at), "");
  // According to this mark, target 1 is a correction target, although it moves vertices.
  Json mark = good_mark();
  mark["extras"] = {{{"target", 1}, {"factors", {0, 0}}}};
  EXPECT_EQ(has(error_of(marked(mark)), at + "/extras/0/target"), "");
  // Extras that are not from a bake may have any content.
  GltfBuilder builder = hinge().file();
  builder.json["meshes"][0]["extras"] = 17;
  EXPECT_EQ(error_of(builder), "");
}

TEST(GltfShading, mesh_without_faces_is_refused) {
  GltfBuilder builder;
  builder.add_node(builder.add_mesh(GltfBuilder::primitive(builder.add_positions({0, 0, 0}), {}, {}, 0)));
  EXPECT_EQ(error_of(builder),
            "a.gltf, /meshes/0: the mesh has no faces, so it has no normals; export a mesh with faces");
}

TEST(ShownDirection, is_turned_as_the_base_is_and_stays_on_the_side_that_the_author_shows) {
  const Vec3d n0{0, 0, 2}, n{0, -3, 3};
  const auto expect_near = [](const Vec3d& a, const Vec3d& b) { EXPECT_LT(length(a - b), 1e-12); };
  expect_near(shown_direction({0, 0, 1}, n0, n), unit({0, -1, 1}));
  expect_near(shown_direction({0, 0, -1}, n0, n), unit({0, 1, -1}));
  expect_near(shown_direction({1, 0, 0}, n0, n), unit({1, -1, 0}));
  expect_near(shown_direction({0, 0, 0}, n0, n), unit({0, -1, 1}));
}

}  // namespace
}  // namespace chronormal::gltf_shading_test
