// Checks that the library recognises an author's weighting in the stored normals, and that it finds none if the normals
// fit no weighting. Compares the result with an independent oracle for each weighting.
#include "workflow/shading/authored_weighting.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "chronormal/motion/motion.h"
#include "chronormal/workflow/audit.h"
#include "tests/support/audit_fixture.h"
#include "tests/support/bake_fixture.h"
#include "tests/support/fixtures.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/reference_elements.h"
#include "tests/support/shaded_mesh.h"

namespace chronormal::authored_weighting_test {
namespace {

using test::audit_of;
using test::GltfBuilder;
using test::GltfFixture;
using test::ShadedMesh;

// Makes the mesh for the oracle, with these faces, which may be polygons.
reference::Mesh polygons(const ShadedMesh& mesh, const std::vector<std::vector<std::size_t>>& faces) {
  reference::Mesh result;
  result.faces = faces;
  for (std::size_t v = 0; v < mesh.vertices(); ++v) {
    const test::Vector p = test::vector_at(mesh.positions, v);
    result.from.push_back({p[0], p[1], p[2]});
  }
  result.to = result.from;
  return result;
}

std::vector<std::vector<std::size_t>> triangles_of(const ShadedMesh& mesh) {
  std::vector<std::vector<std::size_t>> faces;
  for (std::size_t c = 0; c < mesh.corners.size(); c += 3)
    faces.push_back({mesh.corners[c], mesh.corners[c + 1], mesh.corners[c + 2]});
  return faces;
}

// Returns the quads of a sheet. random_sheet() has split each of them into two triangles.
std::vector<std::vector<std::size_t>> quads_of(const ShadedMesh& mesh) {
  std::vector<std::vector<std::size_t>> faces;
  for (std::size_t c = 0; c < mesh.corners.size(); c += 6)
    faces.push_back({mesh.corners[c], mesh.corners[c + 1], mesh.corners[c + 2], mesh.corners[c + 5]});
  return faces;
}

void store(const std::string& weighting, const std::vector<std::vector<std::size_t>>& faces, ShadedMesh& mesh) {
  const reference::Mesh truth = polygons(mesh, faces);
  std::vector<std::vector<reference::Corner>> around(mesh.vertices());
  for (const reference::Corner& corner : reference::corners_of(truth))
    around[reference::vertex_of(truth, corner)].push_back(corner);
  for (std::size_t v = 0; v < mesh.vertices(); ++v) {
    const reference::Vector n = reference::normalised(reference::element_normal(truth, around[v], weighting, 0));
    for (std::size_t c = 0; c < 3; ++c) mesh.normals[3 * v + c] = static_cast<float>(n[c]);
  }
}

// Makes a bumpy sheet whose normals follow a weighting, with one target that lifts a corner.
ShadedMesh sheet(const std::string& weighting, std::uint64_t seed = 1, std::size_t side = 8) {
  ShadedMesh mesh = test::random_sheet(seed, side, 0, 0);
  store(weighting, triangles_of(mesh), mesh);
  mesh.targets.emplace_back().positions.resize(mesh.positions.size());
  mesh.targets[0].positions.back() = 1;
  return mesh;
}

std::string_view detected_in(const ShadedMesh& mesh) {
  const Audit audit = audit_of(mesh.file());
  EXPECT_EQ(audit.offsets.size(), 1U);
  EXPECT_TRUE(audit.offsets[0].is_detected);
  EXPECT_EQ(audit.weighting, audit.offsets[0].weighting);
  return weighting_name(audit.offsets[0].weighting);
}

// Rounds each component of the stored normals to this number of bits.
void quantise(int bits, ShadedMesh& mesh) {
  const float most = static_cast<float>((1 << (bits - 1)) - 1);
  for (float& c : mesh.normals) c = std::round(c * most) / most;
}

// Turns a share of the stored normals by about 20 degrees.
void bend(double share, ShadedMesh& mesh) {
  fixtures::Random random(7);
  for (std::size_t v = 0; v < mesh.vertices(); ++v) {
    const bool bends = random.uniform(0, 1) < share;
    for (std::size_t c = 0; c < 3; ++c)
      mesh.normals[3 * v + c] += bends ? static_cast<float>(random.uniform(-0.4, 0.4)) : 0.0F;
  }
}

TEST(AuthoredWeighting, each_is_detected_where_normals_follow_it) {
  for (const WeightingInfo& info : kWeightings) {
    const Audit audit = audit_of(sheet(std::string(info.name)).file());
    EXPECT_EQ(audit.weighting, info.weighting) << info.name;
    EXPECT_LT(audit.offsets[0].worst, 1e-4) << info.name;
    EXPECT_EQ(audit.subjects[0].weighting, info.weighting) << info.name;
  }
}

TEST(AuthoredWeighting, of_a_sequence_is_found_in_normals_that_show_the_other_side) {
  for (const WeightingInfo& info : kWeightings) {
    const ShadedMesh mesh = sheet(std::string(info.name));
    Motion motion;
    motion.topology = Topology::triangles(mesh.vertices(), mesh.corners).value();
    motion.keyframes = {{mesh.positions, 0, ""}, {mesh.positions, 1, ""}};
    motion.keyframes[1].positions.back() += 1;
    motion.connect_as_sequence();
    std::vector<float> of_corners;
    for (const std::uint32_t v : mesh.corners)
      for (std::size_t c = 0; c < 3; ++c)
        of_corners.push_back(v % 2 == 0 ? mesh.normals[3 * v + c] : -mesh.normals[3 * v + c]);
    const Result<Audit> found = audit(motion, StoredNormals{{of_corners, of_corners}}, {});
    ASSERT_TRUE(found) << found.error().text();
    EXPECT_EQ(found.value().offsets.at(0).weighting, info.weighting) << info.name;
    EXPECT_LT(found.value().offsets.at(0).worst, 1e-4) << info.name;
  }
}

TEST(AuthoredWeighting, survives_eight_bits_and_normals_that_an_author_bent) {
  for (const WeightingInfo& info : kWeightings) {
    ShadedMesh mesh = sheet(std::string(info.name));
    quantise(8, mesh);
    EXPECT_EQ(detected_in(mesh), info.name);
    mesh = sheet(std::string(info.name), 2, 12);
    bend(0.3, mesh);
    EXPECT_EQ(detected_in(mesh), info.name);
  }
}

TEST(AuthoredWeighting, of_quads_is_found_after_they_were_cut_into_triangles) {
  for (const std::string weighting : {"area", "angle"}) {
    // Columns of quads grow in width, and a wave runs across them. Large quads are therefore beside small quads, and
    // all of them are nearly flat.
    ShadedMesh mesh = sheet(weighting);
    for (std::size_t v = 0; v < mesh.vertices(); ++v) {
      float* const p = mesh.positions.data() + 3 * v;
      const float column = p[0];
      p[0] = 0.5F * column * column;
      p[2] = 0.02F * p[2] + std::sin(2 * column);
    }
    store(weighting, quads_of(mesh), mesh);
    EXPECT_EQ(detected_in(mesh), weighting);
  }
}

TEST(AuthoredWeighting, is_area_where_all_agree_or_none_comes_close) {
  // In a plane, every weighting gives the same normals.
  ShadedMesh plane = sheet("max");
  for (std::size_t v = 0; v < plane.vertices(); ++v) plane.positions[3 * v + 2] = 0;
  store("max", triangles_of(plane), plane);
  EXPECT_EQ(detected_in(plane), "area");
  quantise(6, plane);
  bend(1, plane);
  EXPECT_EQ(detected_in(plane), "area");
  // All edges are hard, so each face has its own normals.
  ShadedMesh flat = sheet("angle"), apart;
  for (const std::uint32_t v : flat.corners) {
    for (std::size_t c = 0; c < 3; ++c) apart.positions.push_back(flat.positions[3 * v + c]);
    apart.corners.push_back(static_cast<std::uint32_t>(apart.corners.size()));
  }
  apart.normals.resize(apart.positions.size());
  store("angle", triangles_of(apart), apart);
  apart.targets.emplace_back().positions.resize(apart.positions.size());
  apart.targets[0].positions.back() = 1;
  EXPECT_EQ(detected_in(apart), "area");
  // The stored normals are those of a sphere far below the sheet, so they follow none of the weightings.
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    ShadedMesh bent = sheet("angle", seed);
    for (std::size_t v = 0; v < bent.vertices(); ++v) {
      const test::Vector up = test::unit_of(test::plus(test::vector_at(bent.positions, v), {-4, -4, 10}));
      for (std::size_t c = 0; c < 3; ++c) bent.normals[3 * v + c] = static_cast<float>(up[c]);
    }
    EXPECT_EQ(detected_in(bent), "area") << seed;
    ShadedMesh random = sheet("angle", seed);
    bend(1, random);
    EXPECT_EQ(detected_in(random), "area") << seed;
  }
}

TEST(AuthoredWeighting, what_was_asked_for_goes_before) {
  const Audit audit = audit_of(sheet("angle").file(), {.weighting = Weighting::kUniform});
  EXPECT_EQ(audit.weighting, Weighting::kUniform);
  EXPECT_FALSE(audit.offsets[0].is_detected);
  EXPECT_EQ(audit.offsets[0].weighting, Weighting::kUniform);
  EXPECT_EQ(audit.offsets[0].closest, Weighting::kAngle);
  EXPECT_GT(audit.offsets[0].area_mean, 0.1);
}

TEST(AuthoredWeighting, is_of_each_mesh_and_the_file_has_one_where_all_agree) {
  GltfBuilder builder;
  builder.add_node(builder.add_mesh(sheet("angle").primitive(builder)));
  builder.add_node(builder.add_mesh(sheet("area").primitive(builder)));
  const Audit both = audit_of(builder);
  EXPECT_EQ(both.weighting, std::nullopt);
  EXPECT_EQ(both.subjects[0].weighting, Weighting::kAngle);
  EXPECT_EQ(both.subjects[1].weighting, Weighting::kArea);
  EXPECT_EQ(audit_of(builder, {.weighting = Weighting::kMax}).weighting, Weighting::kMax);
}

TEST(AuthoredWeighting, no_fault_is_found_in_targets_that_follow_it_too) {
  ShadedMesh mesh = test::random_sheet(4, 6, 0, 0), moved = mesh;
  store("angle", triangles_of(mesh), mesh);
  ShadedMesh::Target target;
  fixtures::Random random(5);
  for (float& c : moved.positions) c += static_cast<float>(random.uniform(-0.3, 0.3));
  store("angle", triangles_of(moved), moved);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    target.positions.push_back(moved.positions[i] - mesh.positions[i]);
    target.normals.push_back(moved.normals[i] - mesh.normals[i]);
  }
  mesh.targets.push_back(target);
  const Audit by_angle = audit_of(mesh.file()), by_area = audit_of(mesh.file(), {.weighting = Weighting::kArea});
  EXPECT_LT(by_angle.subjects[0].at_keys.worst, 0.01);
  ASSERT_FALSE(by_area.findings.empty());
  EXPECT_EQ(by_area.findings[0].kind, AuditFinding::Kind::kWrongAtKeys);
  EXPECT_TRUE(by_angle.findings.empty() || by_angle.findings[0].kind == AuditFinding::Kind::kWrongBetween);
}

TEST(AuthoredWeighting, is_what_a_bake_bakes_by_unless_the_base_is_made_anew) {
  GltfBuilder builder = sheet("angle").file();
  builder.add_animation("lift");
  builder.add_track(0, 0, std::vector<float>{0, 1}, std::vector<float>{0, 1});
  const test::Baked baked = test::bake_document(builder);
  ASSERT_EQ(baked.error, "");
  EXPECT_EQ(baked.report.meshes[0].weighting, Weighting::kAngle);
  EXPECT_EQ(test::bake_document(builder, {.weighting = Weighting::kUniform}).report.meshes[0].weighting,
            Weighting::kUniform);
  EXPECT_EQ(test::bake_document(builder, {.recompute_base = true}).report.meshes[0].weighting, Weighting::kArea);
  const GltfFixture result(baked.bytes);
  ASSERT_TRUE(result.ok()) << result.error();
  const Result<Audit> after = audit(*result, {});
  ASSERT_TRUE(after.ok()) << after.error().text();
  EXPECT_EQ(after.value().weighting, Weighting::kAngle);
  const Audit before = audit_of(builder);
  EXPECT_LT(after.value().error.mean(), 0.5 * before.error.mean());
  EXPECT_GT(before.error.worst, 20);
}

}  // namespace
}  // namespace chronormal::authored_weighting_test
