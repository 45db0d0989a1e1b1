// Tests the tangents of morphs with normal maps, for viewers that add up tangents. If a target has weight 1, a tangent
// must have length 1, be perpendicular to the true normal, and follow the texture. The oracle follows the texture
// coordinates in long double.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "chronormal/workflow/audit.h"
#include "tests/support/bake_fixture.h"
#include "tests/support/shaded_mesh.h"

namespace chronormal::bake_tangents_test {
namespace {

using test::bake_bytes;
using test::Baked;
using test::ShadedMesh;
using test::Vector;

// Makes a bumpy sheet with texture coordinates whose u runs along x. The tangents of the sheet have length 1 and are
// perpendicular to the stored normals.
ShadedMesh sheet(std::uint64_t seed, double tilt) {
  ShadedMesh mesh = test::random_sheet(seed, 6, 2, tilt);
  for (std::size_t v = 0; v < mesh.vertices(); ++v) {
    const Vector n = test::vector_at(mesh.normals, v);
    const Vector t = test::unit_of(test::plus({1, 0, 0}, n, -test::dotted({1, 0, 0}, n)));
    for (const auto c : {t[0], t[1], t[2]}) mesh.tangents.push_back(static_cast<float>(c));
    mesh.tangents.push_back(-1);
  }
  for (ShadedMesh::Target& target : mesh.targets) target.normals.clear();
  return mesh;
}

Vector tangent_of(const ShadedMesh& mesh, std::size_t v) {
  return {mesh.tangents[4 * v], mesh.tangents[4 * v + 1], mesh.tangents[4 * v + 2]};
}

// Returns the true normal of a vertex at weight 1: the normal of the geometry, turned by the rotation that takes the
// geometry's normal in the base to the stored normal.
Vector right_normal(const ShadedMesh& mesh, std::size_t v, std::size_t target) {
  std::vector<double> none(mesh.targets.size()), one = none;
  one[target] = 1;
  const Vector base = test::unit_of(mesh.normal(v, none));
  return test::rotated(base, test::unit_of(test::vector_at(mesh.normals, v)), test::unit_of(mesh.normal(v, one)));
}

std::vector<float> new_deltas(const Baked& baked, std::size_t target) {
  return baked.numbers(baked.mesh()["primitives"][0]["targets"][target]["TANGENT"]);
}

BakeOptions by_area(std::vector<Viewer> viewers = {kViewers.begin(), kViewers.end()}) {
  BakeOptions options;
  options.weighting = Weighting::kArea;
  options.viewers = std::move(viewers);
  return options;
}

TEST(BakeTangents, are_unit_and_perpendicular_to_the_right_normal_at_weight_1) {
  for (const std::uint64_t seed : {11U, 12U, 13U}) {
    const ShadedMesh mesh = sheet(seed, seed == 12 ? 0.3 : 0);
    const Baked baked = bake_bytes(mesh.file().glb(), by_area());
    ASSERT_TRUE(baked.ok()) << baked.error;
    EXPECT_EQ(baked.report.meshes[0].new_tangents, 2U);
    for (std::size_t k = 0; k < 2; ++k) {
      const std::vector<float> deltas = new_deltas(baked, k);
      for (std::size_t v = 0; v < mesh.vertices(); ++v) {
        const Vector t = test::plus(tangent_of(mesh, v), test::vector_at(deltas, v));
        EXPECT_NEAR(static_cast<double>(test::length_of(t)), 1, 1e-6) << "seed " << seed << ", vertex " << v;
        EXPECT_NEAR(static_cast<double>(test::dotted(t, right_normal(mesh, v, k))), 0, 1e-5)
            << "seed " << seed << ", vertex " << v;
      }
    }
    // An audit, which computes normals independently, must find no errors.
    const test::GltfFixture after(baked.bytes);
    const Result<Audit> audit = chronormal::audit(*after, {});
    ASSERT_TRUE(audit.ok());
    for (const AuditFinding& finding : audit.value().findings)
      EXPECT_NE(finding.kind, AuditFinding::Kind::kStaleTangents);
  }
}

TEST(BakeTangents, stay_where_the_normals_stay) {
  for (const std::uint64_t seed : {21U, 22U, 23U}) {
    const ShadedMesh mesh = sheet(seed, 0);
    BakeOptions options = by_area();
    options.tolerance = 90;  // the normals of the file are within this tolerance
    const Baked baked = bake_bytes(mesh.file().glb(), options);
    ASSERT_TRUE(baked.ok()) << baked.error;
    EXPECT_FALSE(baked.report.changed) << "seed " << seed;
    EXPECT_EQ(baked.report.meshes[0].new_tangents, 0U) << "seed " << seed;
  }
}

// A linear map of a flat sheet also maps the directions of the texture, so its matrix gives the tangents.
TEST(BakeTangents, follow_the_texture_through_shears_and_turns) {
  ShadedMesh mesh = sheet(3, 0);
  const auto map = [](const Vector& p) {
    return Vector{p[0] + 0.7L * p[1] + 0.2L * p[2], 0.3L * p[0] - p[2] + 0.5L * p[1], 0.9L * p[1] + 0.4L * p[2]};
  };
  for (std::size_t v = 0; v < mesh.vertices(); ++v) {
    for (const std::size_t c : {0U, 1U}) mesh.normals[3 * v + c] = 0;
    mesh.normals[3 * v + 2] = 1;
    mesh.positions[3 * v + 2] = 0;
    mesh.tangents[4 * v] = 1;
    mesh.tangents[4 * v + 1] = mesh.tangents[4 * v + 2] = 0;
    const Vector p = test::vector_at(mesh.positions, v), moved = test::plus(map(p), p, -1);
    for (const std::size_t c : {0U, 1U, 2U}) mesh.targets[0].positions[3 * v + c] = static_cast<float>(moved[c]);
  }
  const Baked baked = bake_bytes(mesh.file().glb(), by_area());
  ASSERT_TRUE(baked.ok()) << baked.error;
  const std::vector<float> deltas = new_deltas(baked, 0);
  const Vector expected = test::unit_of(map({1, 0, 0}));
  for (std::size_t v = 0; v < mesh.vertices(); ++v) {
    const Vector t = test::plus(tangent_of(mesh, v), test::vector_at(deltas, v));
    for (const std::size_t c : {0U, 1U, 2U})
      EXPECT_NEAR(static_cast<double>(t[c]), static_cast<double>(expected[c]), 1e-5) << "vertex " << v;
  }
}

TEST(BakeTangents, stay_where_they_are_right_and_where_no_viewer_adds_them_up) {
  ShadedMesh mesh = sheet(21, 0);
  const Baked first = bake_bytes(mesh.file().glb(), by_area());
  ASSERT_TRUE(first.ok()) << first.error;
  for (std::size_t k = 0; k < 2; ++k) mesh.targets[k].tangents = new_deltas(first, k);
  const Baked again = bake_bytes(mesh.file().glb(), by_area());
  ASSERT_TRUE(again.ok()) << again.error;
  EXPECT_EQ(again.report.meshes[0].new_tangents, 0U);
  for (std::size_t k = 0; k < 2; ++k) EXPECT_EQ(new_deltas(again, k), mesh.targets[k].tangents);

  const Baked three = bake_bytes(sheet(21, 0).file().glb(), by_area(find_viewers("three,playcanvas").value()));
  ASSERT_TRUE(three.ok()) << three.error;
  EXPECT_EQ(three.report.meshes[0].new_tangents, 0U);
  EXPECT_FALSE(three.mesh()["primitives"][0]["targets"][0].contains("TANGENT"));
}

TEST(BakeTangents, count_against_a_limit_of_bytes_and_stay_where_it_has_no_room) {
  const ShadedMesh mesh = sheet(13, 0);
  const Baked whole = bake_bytes(mesh.file().glb(), by_area());
  ASSERT_TRUE(whole.ok()) << whole.error;
  const std::size_t of_tangents = 2 * 12 * mesh.vertices();
  for (const std::size_t most : {whole.report.meshes[0].bytes, of_tangents, of_tangents - 1}) {
    BakeOptions options = by_area();
    options.most_delta_bytes = most;
    const Baked baked = bake_bytes(mesh.file().glb(), options);
    ASSERT_TRUE(baked.ok()) << baked.error;
    EXPECT_LE(baked.report.meshes[0].bytes, most);
    // If there is room for tangents but not for new normals, the normals stay, and so do the tangents, which fit them.
    EXPECT_EQ(baked.report.meshes[0].new_tangents, most <= of_tangents ? 0U : 2U) << most;
    EXPECT_EQ(baked.report.meshes[0].left_tangents, most < of_tangents ? 2U : 0U) << most;
  }
}

// If the normals of a file are right before a bake, the bake may need to write only tangents.
TEST(BakeTangents, are_written_alone_where_the_normals_are_right) {
  ShadedMesh mesh = test::hinge();
  mesh.positions = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
  mesh.tangents = {1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1};
  // The target turns the square by 90 degrees about y. The normal deltas of the target are exact at weights 0, 1/2 and
  // 1.
  mesh.targets = {{{0, 0, 0, -1, 0, -1, 0, 0, 0, -1, 0, -1}, {1, 0, -1, 1, 0, -1, 1, 0, -1, 1, 0, -1}, {}}};
  BakeOptions options = by_area();
  options.tolerance = 180;
  const Baked baked = bake_bytes(mesh.file().glb(), options);
  ASSERT_TRUE(baked.ok()) << baked.error;
  EXPECT_EQ(baked.report.meshes[0].new_tangents, 1U);
  EXPECT_TRUE(baked.report.changed);
  EXPECT_FALSE(baked.mesh().contains("extras"));
  EXPECT_EQ(baked.numbers(baked.mesh()["primitives"][0]["targets"][0]["NORMAL"]), mesh.targets[0].normals);
  const std::vector<float> deltas = new_deltas(baked, 0);
  for (std::size_t v = 0; v < 4; ++v) {
    EXPECT_NEAR(deltas[3 * v], -1, 1e-6) << v;
    EXPECT_NEAR(deltas[3 * v + 1], 0, 1e-6) << v;
    EXPECT_NEAR(deltas[3 * v + 2], -1, 1e-6) << v;
  }
}

}  // namespace
}  // namespace chronormal::bake_tangents_test
