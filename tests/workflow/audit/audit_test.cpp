// Checks that audits find the errors that a file was made with, and that they report what they cannot judge.
#include "chronormal/workflow/audit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "chronormal/core/parallel.h"
#include "tests/support/audit_fixture.h"
#include "tests/support/child_process.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/shaded_mesh.h"

namespace chronormal::audit_test {
namespace {

using test::audit_of;
using test::GltfBuilder;
using test::GltfFixture;
using test::hinge;
using test::random_sheet;
using test::Real;
using test::ShadedMesh;
using test::Vector;
using Json = GltfBuilder::Json;
using Kind = AuditFinding::Kind;

std::vector<Kind> kinds_of(const Audit& audit) {
  std::vector<Kind> kinds;
  for (const AuditFinding& finding : audit.findings) kinds.push_back(finding.kind);
  return kinds;
}

// Makes a target that moves every vertex by delta(position).
ShadedMesh::Target target_of(const ShadedMesh& mesh, const std::function<Vector(const Vector&)>& delta) {
  ShadedMesh::Target target;
  for (std::size_t v = 0; v < mesh.vertices(); ++v)
    for (const Real c : delta(test::vector_at(mesh.positions, v))) target.positions.push_back(static_cast<float>(c));
  return target;
}

// ---- errors that were computed by hand

TEST(Audit, hinge_without_target_normals_has_the_angles_of_a_drawing) {
  // Vertex 0 belongs only to the face at rest, and vertex 3 only to the face that folds. At vertices 1 and 2, the
  // normals of both faces are added: one points up, and the other sideways.
  const Audit result = audit_of(hinge().file(), {.samples = 2});
  ASSERT_EQ(result.subjects.size(), 1U);
  const AuditSubject& subject = result.subjects[0];
  EXPECT_EQ(subject.kind, AuditSubject::Kind::kTarget);
  EXPECT_EQ(subject.vertices, 3U);
  EXPECT_EQ(subject.error.judged, 6U);
  EXPECT_NEAR(subject.error.worst, 90, 1e-12);
  EXPECT_NEAR(subject.error.mean(), (45 + 45 + 90) / 6.0, 1e-12);
  EXPECT_NEAR(subject.error.rms(), std::sqrt((2 * 45.0 * 45.0 + 90.0 * 90.0) / 6), 1e-12);
  EXPECT_EQ(subject.error.worst_at.vertex, 3U);
  EXPECT_EQ(subject.error.worst_at.at, 1);
  EXPECT_EQ(subject.error.histogram[0], 3U);
  // An error of 45 degrees is at the boundary between two bins of the histogram, so rounding decides which bin counts
  // it.
  EXPECT_EQ(subject.error.histogram[8] + subject.error.histogram[7], 2U);
  EXPECT_EQ(subject.error.histogram[9] + subject.error.histogram[8], 3U - subject.error.histogram[7]);
  EXPECT_EQ(result.worst, 0U);
  EXPECT_EQ(kinds_of(result), (std::vector<Kind>{Kind::kMissingNormals}));
  EXPECT_EQ(result.findings[0].count, 1U);
  EXPECT_NEAR(result.findings[0].degrees, 90, 1e-12);
}

TEST(Audit, percentiles_are_known_to_a_thousandth_of_a_degree_or_a_percent) {
  MotionError error, first, second;
  EXPECT_EQ(error.percentile(0.999), 0);
  for (int i = 1; i <= 1000; ++i) (i % 3 == 0 ? first : second).add(0.18 * i, {});
  error.add(first);
  error.add(second);
  for (const int rank : {1, 10, 500, 990, 999, 1000}) {
    EXPECT_GE(error.percentile(rank / 1000.0), 0.18 * rank - 1e-9);
    EXPECT_LE(error.percentile(rank / 1000.0), 0.18 * rank * 1.008 + 0.001);
  }
  EXPECT_EQ(error.percentile(1), error.worst);
  MotionError tiny;
  for (int i = 0; i < 10; ++i) tiny.add(1e-7 * i, {});
  EXPECT_LE(tiny.percentile(0.9), 0.001);
}

TEST(Audit, halfway_is_where_the_drawing_has_it) {
  // At weight 1/2, the folding face has the corner (1, 0, 1), so its normal is parallel to (-1, 0, 1).
  const Audit result = audit_of(hinge().file(), {.samples = 3});
  EXPECT_NEAR(result.error.mean(), (45 + 45 + 90 + 45 + 2 * std::atan(1 / 3.0) * 180 / std::numbers::pi) / 9, 1e-12);
}

// Adds an expression of an avatar that sets the only target of the file to this weight.
GltfBuilder with_expression(GltfBuilder builder, double weight, bool is_first_version) {
  if (is_first_version) {
    const Json binds = {{{"mesh", 0}, {"index", 0}, {"weight", 100 * weight}}};
    builder.json["extensions"]["VRM"]["blendShapeMaster"]["blendShapeGroups"] = {{{"name", "Joy"}, {"binds", binds}}};
  } else {
    const Json binds = {{{"node", 0}, {"index", 0}, {"weight", weight}}};
    builder.json["extensions"]["VRMC_vrm"]["expressions"]["custom"]["Joy"] = {{"morphTargetBinds", binds}};
  }
  return builder;
}

TEST(Audit, an_expression_of_an_avatar_is_a_pose_that_is_judged_at_its_full_strength) {
  for (const bool is_first_version : {true, false}) {
    const Audit result = audit_of(with_expression(hinge().file(), 0.5, is_first_version), {.samples = 2});
    ASSERT_EQ(result.subjects.size(), 2U);
    const AuditSubject& subject = result.subjects[1];
    EXPECT_EQ(subject.kind, AuditSubject::Kind::kExpression);
    EXPECT_EQ(subject.name, "Joy");
    EXPECT_EQ(subject.expression, 0U);
    EXPECT_EQ(subject.mesh, 0U);
    EXPECT_EQ(subject.samples, 1U);
    EXPECT_EQ(subject.vertices, 3U);
    // At weight 1/2, the vertex that belongs only to the folding face has an error of 45 degrees. The errors at the
    // edge are smaller.
    EXPECT_EQ(subject.error.judged, 3U);
    EXPECT_NEAR(subject.error.worst, 45, 1e-12);
    EXPECT_NEAR(subject.error.sum, 45 + 2 * std::atan(1 / 3.0) * 180 / std::numbers::pi, 1e-12);
    EXPECT_EQ(subject.error.worst_at.vertex, 3U);
    EXPECT_EQ(subject.error.worst_at.at, 1) << "the strength of the expression, whatever the weights that it gives";
    EXPECT_EQ(kinds_of(result), (std::vector<Kind>{Kind::kMissingNormals})) << "the target alone is farther off";
  }
}

TEST(Audit, an_expression_is_a_fault_where_it_is_farther_off_than_its_targets_alone) {
  // The target alone is judged up to weight 1. The expression sets the weight of the target to 3.
  const Audit result = audit_of(with_expression(hinge().file(), 3, false), {.samples = 2});
  ASSERT_EQ(kinds_of(result), (std::vector<Kind>{Kind::kMissingNormals, Kind::kWrongTogether}));
  EXPECT_EQ(result.findings[1].expression, 0U);
  EXPECT_FALSE(result.findings[1].target || result.findings[1].animation);
  // At weight 3, the corner of the folding face is at (1 - 3, 0, 3), so the face has turned by pi - atan(3 / 2).
  EXPECT_NEAR(result.findings[1].degrees, 180 - std::atan(1.5) * 180 / std::numbers::pi, 1e-12);
  EXPECT_EQ(result.worst, 1U);
}

TEST(Audit, an_expression_that_moves_nothing_is_no_subject_and_one_animation_alone_has_none) {
  EXPECT_EQ(audit_of(with_expression(hinge().file(), 0, true)).subjects.size(), 1U);
  EXPECT_EQ(audit_of(with_expression(hinge().file(), 0, true)).still, 1U);
  GltfBuilder builder = with_expression(hinge().file(), 0.5, true);
  builder.add_animation("fold");
  builder.add_track(0, 0, std::vector<float>{0, 1}, std::vector<float>{0, 1});
  EXPECT_EQ(audit_of(builder).subjects.size(), 3U);
  const Audit of_one = audit_of(builder, {.animation = "fold"});
  ASSERT_EQ(of_one.subjects.size(), 1U);
  EXPECT_EQ(of_one.subjects[0].kind, AuditSubject::Kind::kTrack);
}

TEST(Audit, flat_rule_shows_faces) {
  // At weight 1, the two faces are perpendicular. The normals of vertices 1 and 2 are sums of both face normals, so
  // each face normal is at 45 degrees from them. Vertices 0 and 3 have no error.
  const Audit result = audit_of(hinge().file(), {.rule = AuditRule::kFlat, .samples = 2});
  EXPECT_EQ(result.error.judged, 10U);  // corners: vertices 1 and 2 are in both faces, vertex 3 in one
  EXPECT_NEAR(result.error.sum, 4 * 45, 1e-12);
}

// ---- errors that follow from theory

TEST(Audit, rigid_translation_has_no_error) {
  ShadedMesh mesh = random_sheet(1, 5, 0, 0.4);
  mesh.targets.push_back(target_of(mesh, [](const Vector&) { return Vector{3, -1, 2}; }));
  const Audit result = audit_of(mesh.file());
  EXPECT_EQ(result.error.judged, 25U * 21);
  EXPECT_LT(result.error.worst, 1e-4);
  EXPECT_TRUE(std::none_of(result.findings.begin(), result.findings.end(), [](auto& f) { return f.is_fault(); }));
}

TEST(Audit, uniform_scaling_has_no_error) {
  ShadedMesh mesh = random_sheet(2, 5, 0, 0.4);
  mesh.targets.push_back(target_of(mesh, [](const Vector& p) { return p; }));
  EXPECT_LT(audit_of(mesh.file()).error.worst, 1e-4);
}

TEST(Audit, error_does_not_depend_on_the_tilt_of_the_author_under_translation_but_the_offset_does) {
  ShadedMesh mesh = random_sheet(3, 5, 0, 0);
  mesh.targets.push_back(target_of(mesh, [](const Vector&) { return Vector{0, 0, 1}; }));
  const Audit straight = audit_of(mesh.file());
  EXPECT_LT(straight.offsets[0].worst, 1e-4);
  ShadedMesh tilted = random_sheet(3, 5, 0, 0.6);
  tilted.targets = mesh.targets;
  const Audit result = audit_of(tilted.file());
  EXPECT_LT(result.error.worst, 1e-4);
  EXPECT_GT(result.offsets[0].worst, 10);
  Real sum = 0;
  for (std::size_t v = 0; v < tilted.vertices(); ++v)
    sum += test::degrees_between(test::vector_at(tilted.normals, v), tilted.normal(v, {0}));
  EXPECT_NEAR(result.offsets[0].mean(), static_cast<double>(sum) / 25, 1e-9);
}

TEST(Audit, quadratic_terms_in_an_extra_target_leave_only_the_rounding_of_floats) {
  // The sum of face normals is c0 + c1 w + c2 w^2 for the weight w. The file stores the normal N = c0, the delta D = c1
  // of the target, and the delta C = c2 of a correction target, all divided by |c0| at each vertex, as a bake would.
  // The test computes c0, c1 and c2 from three normals of the oracle.
  ShadedMesh mesh = random_sheet(4, 5, 1, 0);
  ShadedMesh::Target extra;
  extra.positions.assign(mesh.positions.size(), 0);
  mesh.targets[0].normals.clear();
  for (std::size_t v = 0; v < mesh.vertices(); ++v) {
    const Vector n0 = mesh.normal(v, {0}), half = mesh.normal(v, {0.5}), n1 = mesh.normal(v, {1});
    for (std::size_t c = 0; c < 3; ++c) {
      const Real quadratic = 2 * (n0[c] - 2 * half[c] + n1[c]), linear = n1[c] - n0[c] - quadratic;
      mesh.targets[0].normals.push_back(static_cast<float>(linear / test::length_of(n0)));
      extra.normals.push_back(static_cast<float>(quadratic / test::length_of(n0)));
    }
  }
  EXPECT_GT(audit_of(mesh.file()).error.worst, 0.1);
  mesh.targets.push_back(extra);
  GltfBuilder builder = mesh.file();
  builder.json["meshes"][0]["extras"]["chronormal"] = {
      {"version", 1}, {"encode", "exact"}, {"sequence", false}, {"extras", {{{"target", 1}, {"factors", {0, 0}}}}}};
  const Audit result = audit_of(builder);
  ASSERT_EQ(result.subjects.size(), 1U);  // a correction target is not judged alone
  EXPECT_LT(result.error.worst, 1e-3);
  EXPECT_EQ(kinds_of(result), (std::vector<Kind>{Kind::kBaked}));
  EXPECT_EQ(result.findings[0].count, 1U);
}

// ---- errors that an oracle computes

void expect_same(const MotionError& error, const std::vector<Real>& expected) {
  ASSERT_EQ(error.judged, expected.size());
  Real sum = 0, squares = 0, worst = 0;
  for (const Real e : expected) {
    sum += e;
    squares += e * e;
    worst = std::max(worst, e);
  }
  const auto count = static_cast<Real>(expected.size());
  constexpr double kFloat = 2e-4;  // viewers add up normals in float32
  EXPECT_NEAR(error.mean(), static_cast<double>(sum / count), kFloat);
  EXPECT_NEAR(error.rms(), static_cast<double>(std::sqrt(squares / count)), kFloat);
  EXPECT_NEAR(error.worst, static_cast<double>(worst), kFloat);
  std::vector<Real> sorted = expected;
  std::sort(sorted.begin(), sorted.end());
  for (const double share : {0.01, 0.5, 0.9, 0.99, 0.999, 1.0}) {
    const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
    const auto exact = static_cast<double>(sorted[std::max<std::size_t>(rank, 1) - 1]);
    EXPECT_GE(error.percentile(share), exact - kFloat) << share;
    EXPECT_LE(error.percentile(share), exact * 1.008 + 0.001 + kFloat) << share;
  }
  const double edges[] = {0, 0.1, 0.5, 1, 2, 5, 10, 25, 45, 90, 181};
  for (std::size_t bin = 0; bin < 10; ++bin) {
    const auto inside = [&](Real e) { return e >= edges[bin] && e < edges[bin + 1]; };
    const auto in_bin = std::count_if(expected.begin(), expected.end(), inside);
    EXPECT_NEAR(static_cast<double>(error.histogram[bin]), static_cast<double>(in_bin), 1) << edges[bin];
  }
}

TEST(Audit, targets_alone_have_the_errors_of_an_oracle) {
  for (std::uint64_t seed = 10; seed < 14; ++seed) {
    const ShadedMesh mesh = random_sheet(seed, 5, 3, 0.3);
    const Audit result = audit_of(mesh.file(), {.samples = 6});
    ASSERT_EQ(result.subjects.size(), 3U);
    for (std::size_t k = 0; k < 3; ++k) {
      std::vector<Real> expected;
      for (std::size_t v = 0; v < mesh.vertices(); ++v) {
        for (int i = 0; i < 6; ++i) {
          std::vector<double> weights(3);
          weights[k] = i / 5.0;
          expected.push_back(mesh.error(v, weights));
        }
      }
      expect_same(result.subjects[k].error, expected);
      const AuditPlace& at = result.subjects[k].error.worst_at;
      std::vector<double> weights(3);
      weights[k] = at.at;
      EXPECT_NEAR(static_cast<double>(mesh.error(at.vertex, weights)), result.subjects[k].error.worst, 2e-4);
      EXPECT_EQ(at.mesh, 0U);
      EXPECT_EQ(at.primitive, 0U);
    }
  }
}

// Returns the value of a cubic spline between two keys, by appendix C of the glTF specification.
double hermite(double t, double v0, double out0, double in1, double v1, double td) {
  const double t2 = t * t, t3 = t2 * t;
  return (2 * t3 - 3 * t2 + 1) * v0 + td * (t3 - 2 * t2 + t) * out0 + (-2 * t3 + 3 * t2) * v1 + td * (t3 - t2) * in1;
}

TEST(Audit, animations_of_every_interpolation_have_the_errors_of_an_oracle) {
  const ShadedMesh mesh = random_sheet(20, 4, 2, 0.2);
  GltfBuilder builder = mesh.file();
  const std::vector<float> times = {0.5F, 1, 3};
  const double weights[3][2] = {{0, 0.25}, {1, 0.5}, {-0.5, 1.25}};
  builder.add_track(builder.add_animation("linear"), 0, times, std::vector<float>{0, 0.25F, 1, 0.5F, -0.5F, 1.25F});
  builder.add_track(builder.add_animation("step"), 0, times, std::vector<float>{0, 0.25F, 1, 0.5F, -0.5F, 1.25F},
                    "STEP");
  builder.add_track(builder.add_animation("cubic"), 0, times,
                    std::vector<float>{0, 0, 0, 0.25F, 1, -1, 2, 1, 1, 0.5F, -1, 0.5F, 3, 1, -0.5F, 1.25F, 0, 0},
                    "CUBICSPLINE");
  const double out[2][2] = {{1, -1}, {-1, 0.5}}, in[2][2] = {{2, 1}, {3, 1}};
  const Audit result = audit_of(builder, {.samples = 4});
  ASSERT_EQ(result.subjects.size(), 5U);
  for (std::size_t a = 0; a < 3; ++a) {
    const AuditSubject& subject = result.subjects[2 + a];
    EXPECT_EQ(subject.kind, AuditSubject::Kind::kTrack);
    EXPECT_EQ(subject.animation, a);
    EXPECT_EQ(subject.node, 0U);
    EXPECT_EQ(subject.segments, 2U);
    std::vector<Real> expected;
    for (std::size_t s = 0; s < 2; ++s) {
      for (int i = 0; i < 4; ++i) {
        const double t = i / 3.0, td = times[s + 1] - times[s];
        std::vector<double> w(2);
        for (std::size_t k = 0; k < 2; ++k) {
          if (a == 0) w[k] = (1 - t) * weights[s][k] + t * weights[s + 1][k];
          // In the STEP animation (a = 1), only the last sample of the track has the weights of the last key.
          if (a == 1) w[k] = weights[s == 1 && i == 3 ? 2 : s][k];
          if (a == 2) w[k] = hermite(t, weights[s][k], out[s][k], in[s][k], weights[s + 1][k], td);
        }
        for (std::size_t v = 0; v < mesh.vertices(); ++v) expected.push_back(mesh.error(v, w));
      }
    }
    expect_same(subject.error, expected);
    EXPECT_GE(subject.error.worst_at.at, 0.5);
    EXPECT_LE(subject.error.worst_at.at, 3);
  }
}

// If many targets are active, the audit interpolates positions between the positions at two keys of the track instead
// of adding up the targets.
TEST(Audit, animations_of_many_targets_have_the_errors_of_an_oracle) {
  constexpr std::size_t kTargets = 12;
  const ShadedMesh mesh = random_sheet(21, 4, kTargets, 0.1);
  fixtures::Random random(21);
  const std::vector<float> times = {0, 1, 1.5F, 4};
  // Each key of the track has in-tangents, weights and out-tangents. At one key, few targets are active, so the audit
  // does not interpolate there.
  std::vector<float> cubic, weights;
  for (std::size_t key = 0; key < times.size(); ++key) {
    for (std::size_t row = 0; row < 3; ++row) {
      for (std::size_t k = 0; k < kTargets; ++k) {
        const auto value = static_cast<float>(row == 1 && key == 2 && k > 3 ? 0 : random.uniform(-1, 1));
        cubic.push_back(value);
        if (row == 1) weights.push_back(value);
      }
    }
  }
  GltfBuilder builder = mesh.file();
  builder.add_track(builder.add_animation("linear"), 0, times, weights);
  builder.add_track(builder.add_animation("step"), 0, times, weights, "STEP");
  builder.add_track(builder.add_animation("cubic"), 0, times, cubic, "CUBICSPLINE");
  const Audit result = audit_of(builder, {.samples = 6});
  ASSERT_EQ(result.subjects.size(), kTargets + 3);
  const auto at_key = [&](std::size_t key, std::size_t row, std::size_t k) {
    return double{cubic[(3 * key + row) * kTargets + k]};
  };
  for (std::size_t a = 0; a < 3; ++a) {
    std::vector<Real> expected;
    for (std::size_t s = 0; s + 1 < times.size(); ++s) {
      for (int i = 0; i < 6; ++i) {
        const double t = i / 5.0, td = times[s + 1] - times[s];
        std::vector<double> w(kTargets);
        for (std::size_t k = 0; k < kTargets; ++k) {
          const double from = at_key(s, 1, k), to = at_key(s + 1, 1, k);
          if (a == 0) w[k] = (1 - t) * from + t * to;
          // In the STEP animation (a = 1), only the last sample of the track has the weights of the last key.
          if (a == 1) w[k] = s + 2 == times.size() && i == 5 ? to : from;
          if (a == 2) w[k] = hermite(t, from, at_key(s, 2, k), at_key(s + 1, 0, k), to, td);
        }
        for (std::size_t v = 0; v < mesh.vertices(); ++v) expected.push_back(mesh.error(v, w));
      }
    }
    expect_same(result.subjects[kTargets + a].error, expected);
  }
}

TEST(Audit, angle_weighting_judges_by_angles) {
  // A wide face and a narrow face meet at vertex 0. The target lifts the far corner of the narrow face.
  ShadedMesh mesh;
  mesh.corners = {0, 1, 2, 0, 2, 3};
  mesh.positions = {0, 0, 0, 1, 0, 0, 0, 1, 0, -1, 4, 0};
  for (int v = 0; v < 4; ++v) mesh.normals.insert(mesh.normals.end(), {0, 0, 1});
  mesh.targets = {{{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2}, {}, {}}};
  const Audit result = audit_of(mesh.file(), {.samples = 2, .weighting = Weighting::kAngle});
  const auto unit_normal = [](Vector a, Vector b) { return test::unit_of(test::crossed(a, b)); };
  const Vector x = {1, 0, 0}, y = {0, 1, 0}, far = {-1, 4, 2};
  const auto radians = [](const Vector& a, const Vector& b) {
    return std::atan2(test::length_of(test::crossed(a, b)), test::dotted(a, b));
  };
  Vector sum = test::plus({0, 0, 0}, unit_normal(x, y), radians(x, y));
  sum = test::plus(sum, unit_normal(y, far), radians(y, far));
  const Vector up = {0, 0, 1};
  const Real at_0 = test::degrees_between(up, sum), at_3 = test::degrees_between(up, unit_normal(y, far));
  Vector sum_2 = test::plus({0, 0, 0}, unit_normal(x, y), radians({0, -1, 0}, {1, -1, 0}));
  sum_2 = test::plus(sum_2, unit_normal(y, far), radians({0, -1, 0}, {-1, 3, 2}));
  const Real at_2 = test::degrees_between(up, sum_2);
  EXPECT_NEAR(result.error.sum, static_cast<double>(at_0 + at_2 + at_3), 1e-9);
}

TEST(Audit, authored_offset_names_the_weighting_that_comes_closest) {
  ShadedMesh mesh = random_sheet(5, 6, 1, 0);
  // Stores the normals of a weighting in which all faces around a vertex have equal weights.
  for (std::size_t v = 0; v < mesh.vertices(); ++v) {
    Vector sum = {0, 0, 0};
    for (std::size_t c = 0; c < mesh.corners.size(); ++c) {
      if (mesh.corners[c] != v) continue;
      const std::size_t f = c - c % 3;
      const Vector p = test::vector_at(mesh.positions, mesh.corners[f]);
      const Vector e = test::plus(test::vector_at(mesh.positions, mesh.corners[f + 1]), p, -1);
      const Vector g = test::plus(test::vector_at(mesh.positions, mesh.corners[f + 2]), p, -1);
      sum = test::plus(sum, test::unit_of(test::crossed(e, g)));
    }
    const Vector stored = test::unit_of(sum);
    for (std::size_t c = 0; c < 3; ++c) mesh.normals[3 * v + c] = static_cast<float>(stored[c]);
  }
  const Audit result = audit_of(mesh.file());
  ASSERT_EQ(result.offsets.size(), 1U);
  EXPECT_EQ(result.offsets[0].closest, Weighting::kUniform);
  EXPECT_LT(result.offsets[0].closest_worst, 1e-4);
  EXPECT_LT(result.offsets[0].worst, 1e-4);
  EXPECT_GT(result.offsets[0].area_mean, 0.1);
  EXPECT_GT(audit_of(mesh.file(), {.weighting = Weighting::kArea}).offsets[0].worst, 0.1);
}

TEST(Audit, authored_offset_names_area_where_all_weightings_come_equally_close) {
  // Two triangles in one plane have the same normal by every weighting. The author's normals are turned away from this
  // normal.
  ShadedMesh mesh = hinge();
  for (std::size_t v = 0; v < 4; ++v) mesh.normals[3 * v] = 0.6F, mesh.normals[3 * v + 2] = 0.8F;
  const Audit result = audit_of(mesh.file());
  ASSERT_EQ(result.offsets.size(), 1U);
  EXPECT_NEAR(result.offsets[0].worst, 36.86989764584402, 1e-5);
  EXPECT_EQ(result.offsets[0].closest_mean, result.offsets[0].mean());
  EXPECT_EQ(result.offsets[0].closest, Weighting::kArea);
}

TEST(Audit, takes_from_2_to_1000001_samples) {
  // If the number of samples is invalid, the file is not even read.
  for (const std::size_t samples : {std::size_t{0}, std::size_t{1}, std::size_t{1000002}, ~std::size_t{0}}) {
    const test::GltfFixture file(hinge().file());
    const Result<Audit> result = audit(*file, {.samples = samples});
    ASSERT_FALSE(result.ok()) << samples;
    EXPECT_EQ(result.error().code, ErrorCode::kUsage);
  }
  if (test::is_sanitized()) GTEST_SKIP() << "sanitizers make half a minute of so many samples";
  const test::GltfFixture file(hinge().file());
  const Result<Audit> most = audit(*file, {.samples = 1000001});
  ASSERT_TRUE(most.ok()) << most.error().text();
  EXPECT_EQ(most.value().error.judged, 3U * 1000001);
}

TEST(Audit, triangles_that_join_the_parts_of_a_strip_change_nothing) {
  constexpr std::uint64_t kSeed = 23;
  RecordProperty("seed", static_cast<int>(kSeed));
  fixtures::Random random(kSeed);
  for (std::uint64_t round = 0; round < 10; ++round) {
    ShadedMesh mesh = random_sheet(kSeed + round, 7, 2, 0.2);
    // The first target moves one vertex, so most faces stand still, and a stitch may reach from it to any of them.
    for (std::size_t i = 3; i < mesh.targets[0].positions.size(); ++i) mesh.targets[0].positions[i] = 0;
    for (float& delta : mesh.targets[0].normals) delta = 0;
    mesh.targets[0].positions[2] = 0.5F;
    ShadedMesh strip = mesh;
    strip.corners.clear();
    for (std::size_t c = 0; c < mesh.corners.size(); c += 3) {
      const auto triangle = mesh.corners.begin() + static_cast<std::ptrdiff_t>(c);
      strip.corners.insert(strip.corners.end(), triangle, triangle + 3);
      const auto from = static_cast<std::uint32_t>(random.below(2) == 0 ? 0 : random.below(mesh.vertices()));
      const auto to = static_cast<std::uint32_t>(random.below(mesh.vertices()));
      strip.corners.insert(strip.corners.end(), {from, from, to, from, to, to});
    }
    const Audit list = audit_of(mesh.file(), {.samples = 5}), result = audit_of(strip.file(), {.samples = 5});
    ASSERT_EQ(result.subjects.size(), list.subjects.size());
    for (std::size_t s = 0; s < list.subjects.size(); ++s)
      EXPECT_EQ(result.subjects[s].vertices, list.subjects[s].vertices) << "round " << round;
    EXPECT_EQ(result.error.judged, list.error.judged);
    EXPECT_EQ(result.error.no_normal, list.error.no_normal);
    EXPECT_EQ(result.error.sum, list.error.sum);
    EXPECT_EQ(result.error.worst, list.error.worst);
    EXPECT_EQ(result.error.most_torn, list.error.most_torn);
  }
}

TEST(Audit, vertices_that_only_faces_with_two_corners_at_one_place_have_are_not_judged) {
  ShadedMesh mesh = hinge();
  const Audit without = audit_of(mesh.file(), {.samples = 5});
  // Vertices 4 and 5 are at the place of vertex 3 in every pose, and belong only to a face without area.
  for (std::size_t copy = 0; copy < 2; ++copy) {
    for (std::vector<float>* const values : {&mesh.positions, &mesh.normals, &mesh.targets[0].positions})
      for (std::size_t i = 9; i < 12; ++i) values->push_back(float{(*values)[i]});
  }
  mesh.corners.insert(mesh.corners.end(), {4, 5, 0});
  const Audit result = audit_of(mesh.file(), {.samples = 5});
  EXPECT_EQ(result.subjects.at(0).vertices, without.subjects.at(0).vertices);
  EXPECT_EQ(result.error.judged, without.error.judged);
  EXPECT_EQ(result.error.sum, without.error.sum);
}

// ---- samples that are not judged

TEST(Audit, vanishing_normals_are_counted_and_not_judged) {
  // Vertex 3 crosses the edge at weight 1/2. At that weight its face has no area, and at larger weights the face points
  // down.
  ShadedMesh mesh = hinge();
  mesh.targets[0].positions = {0, 0, 0, 0, 0, 0, 0, 0, 0, -4, 0, 0};
  const Audit result = audit_of(mesh.file(), {.samples = 3});
  // At weight 1, the normals of the two faces cancel at the edge, so vertices 1 and 2 have no normal.
  EXPECT_EQ(result.error.no_normal, 3U);
  EXPECT_EQ(result.error.judged, 6U);
  EXPECT_NEAR(result.error.sum, 180, 1e-9);
  // At vertices 1 and 2, the faces have an area although their normals add up to zero. Such a sample exceeds every
  // tolerance. The only face of vertex 3 has no area at weight 1/2, so this face is not drawn there.
  EXPECT_EQ(result.error.cancelled, 2U);
  EXPECT_EQ(result.error.cancelled_at.vertex, 1U);
  EXPECT_EQ(result.error.cancelled_at.at, 1);
  EXPECT_TRUE(result.error.is_within(180));
  EXPECT_FALSE(result.error.passes(180));
  EXPECT_FALSE(result.is_within(180));
}

// Two strips of triangles with a hinge between them. At t = 1/2, the strips lie on each other where they are equally
// wide.
struct Hinges {
  std::vector<std::array<int, 3>> from, to;
  std::vector<std::uint32_t> corners;

  explicit Hinges(std::mt19937& random) {
    constexpr std::uint32_t kRows = 6;
    const auto any = [&random](int least, int most) {
      return least + static_cast<int>(random() % static_cast<unsigned>(most - least + 1));
    };
    for (int row = 0; row < static_cast<int>(kRows); ++row) {
      const int width = any(1, 2), other = any(0, 1) == 0 ? 3 - width : width, height = any(1, 4);
      from.insert(from.end(), {{0, 2 * row, 0}, {-2 * width, 2 * row, height}, {2 * other, 2 * row, height + 1}});
      to.insert(to.end(), {{0, 2 * row, 2 * any(-2, 2)}, from[from.size() - 2], {-6 * other, 2 * row, height - 1}});
    }
    for (std::uint32_t p = 0; p + 3 < 3 * kRows; p += 3) {
      corners.insert(corners.end(), {p, p + 3, p + 4, p, p + 4, p + 1});
      corners.insert(corners.end(), {p, p + 5, p + 3, p, p + 2, p + 5});
    }
  }

  // Returns the positions at t = half / 2 as integers.
  [[nodiscard]] std::vector<std::array<int, 3>> at(int half) const {
    std::vector<std::array<int, 3>> result = from;
    for (std::size_t v = 0; v < result.size(); ++v)
      for (std::size_t c = 0; c < 3; ++c) result[v][c] += half * (to[v][c] - from[v][c]) / 2;
    return result;
  }
  // Returns the number of vertices whose normal is zero at t = half / 2 although a face at the vertex has an area.
  [[nodiscard]] std::size_t count_cancelled(int half) const {
    const std::vector<std::array<int, 3>> places = at(half);
    std::vector<std::array<int, 3>> sums(places.size());
    for (std::size_t c = 0; c < corners.size(); c += 3) {
      std::array<int, 3> e{}, f{};
      for (std::size_t i = 0; i < 3; ++i) {
        e[i] = places[corners[c + 1]][i] - places[corners[c]][i];
        f[i] = places[corners[c + 2]][i] - places[corners[c]][i];
      }
      for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t i = 0; i < 3; ++i)
          sums[corners[c + k]][i] += e[(i + 1) % 3] * f[(i + 2) % 3] - e[(i + 2) % 3] * f[(i + 1) % 3];
    }
    return static_cast<std::size_t>(std::count(sums.begin(), sums.end(), std::array<int, 3>{}));
  }
  [[nodiscard]] std::vector<float> floats(bool are_deltas) const {
    std::vector<float> result;
    for (std::size_t v = 0; v < from.size(); ++v)
      for (std::size_t c = 0; c < 3; ++c)
        result.push_back(static_cast<float>(are_deltas ? to[v][c] - from[v][c] : from[v][c]));
    return result;
  }
};

TEST(Audit, normals_of_drawn_faces_that_cancel_are_counted_apart_and_shut_every_gate) {
  constexpr unsigned kSeed = 51;
  RecordProperty("seed", static_cast<int>(kSeed));
  std::mt19937 random(kSeed);
  std::size_t with = 0, of_sequences = 0;
  for (int draw = 0; draw < 40; ++draw) {
    const Hinges hinges(random);
    const std::size_t right = hinges.count_cancelled(0) + hinges.count_cancelled(1) + hinges.count_cancelled(2);
    with += right > 0 ? 1U : 0U;
    ShadedMesh mesh;
    mesh.corners = hinges.corners;
    mesh.positions = hinges.floats(false);
    for (std::size_t v = 0; v < mesh.vertices(); ++v) mesh.normals.insert(mesh.normals.end(), {0.6F, 0, 0.8F});
    mesh.targets.push_back({hinges.floats(true), {}, {}});
    const Audit of_file = audit_of(mesh.file(), {.samples = 3, .viewers = {kViewers[0]}});
    // An audit of a sequence without stored normals measures faces in blocks, except by slerp, for which it measures
    // one vertex after the other.
    std::vector<float> moved = mesh.positions;
    for (std::size_t i = 0; i < moved.size(); ++i) moved[i] += mesh.targets[0].positions[i];
    Motion motion;
    motion.topology = Topology::triangles(mesh.vertices(), mesh.corners).value();
    motion.keyframes = {{mesh.positions, 0, ""}, {moved, 1, ""}};
    motion.connect_as_sequence();
    // If the normals at both ends are opposite, their average is zero and a viewer renders black.
    for (const Audit& found : {of_file, audit(motion, {}, {.samples = 3}).value(),
                               audit(motion, {}, {.rule = AuditRule::kSlerp, .samples = 3}).value()}) {
      EXPECT_EQ(found.error.cancelled + found.error.unlit, right) << draw;
      EXPECT_EQ(found.error.no_normal, found.error.cancelled) << draw;
      EXPECT_EQ(found.is_within(180), right == 0) << draw;
      of_sequences += found.error.cancelled;
    }
    EXPECT_EQ(of_file.error.unlit, 0U) << draw;
    EXPECT_EQ(of_file.viewers[0].error.cancelled, right) << draw;
  }
  EXPECT_GT(of_sequences, 20U);
  EXPECT_GT(with, 10U);
  EXPECT_LT(with, 40U);
}

// ---- samples that cannot be lit

TEST(Audit, stored_normals_that_add_up_to_zero_cannot_be_lit_and_are_off_by_180_degrees) {
  ShadedMesh mesh = hinge();
  mesh.targets[0].normals = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, -1};
  const Audit result = audit_of(mesh.file(), {.samples = 2});
  EXPECT_EQ(result.error.judged, 6U);
  EXPECT_EQ(result.error.unlit, 1U);
  EXPECT_EQ(result.error.unlit_at.vertex, 3U);
  EXPECT_EQ(result.error.unlit_at.at, 1);
  EXPECT_EQ(result.error.worst, 180);
  EXPECT_EQ(result.error.worst_at.vertex, 3U);
  EXPECT_NEAR(result.error.sum, 45 + 45 + 180, 1e-9);
  ASSERT_EQ(kinds_of(result), (std::vector<Kind>{Kind::kUnlit, Kind::kStaleKeys}));
  EXPECT_TRUE(result.findings[0].is_fault());
  EXPECT_EQ(result.findings[0].count, 1U);
  EXPECT_EQ(result.findings[0].worst_at->vertex, 3U);
  EXPECT_FALSE(result.error.is_within(180)) << "no tolerance allows what cannot be lit";
  EXPECT_TRUE(audit_of(hinge().file()).error.is_within(90.001));
  EXPECT_FALSE(audit_of(hinge().file()).error.is_within(89.999));
}

TEST(Audit, infinite_normals_and_those_that_are_no_number_cannot_be_lit) {
  // Weights of 3e38 make deltas of 2 infinite, and infinities of opposite signs add up to NaN.
  for (const bool has_opposite : {false, true}) {
    ShadedMesh mesh = hinge();
    mesh.targets[0].normals.assign(12, 2);
    mesh.targets.push_back({std::vector<float>(12, 0), std::vector<float>(12, has_opposite ? -2.0F : 0.0F), {}});
    GltfBuilder builder = mesh.file();
    builder.add_track(builder.add_animation(""), 0, std::vector<float>{0, 1}, std::vector<float>{0, 0, 3e38F, 3e38F});
    const Audit result = audit_of(builder, {.samples = 2, .animation = "0"});
    const MotionError& error = result.error;
    EXPECT_EQ(error.judged, 5U);
    EXPECT_EQ(error.no_normal, 3U) << "beside those of such weights the normals of the base are nothing";
    EXPECT_EQ(error.unlit, 4U);
    EXPECT_EQ(error.unlit_at.vertex, 0U);
    EXPECT_EQ(error.unlit_at.at, 1) << "in seconds";
    EXPECT_EQ(error.worst, 180);
    EXPECT_NEAR(error.mean(), 4 * 180 / 5.0, 1e-9);
    EXPECT_TRUE(std::isfinite(error.rms()));
    EXPECT_EQ(error.histogram.back(), 4U);
    EXPECT_EQ(kinds_of(result), (std::vector<Kind>{Kind::kUnlit, Kind::kStaleKeys}));
  }
}

TEST(Audit, where_the_geometry_has_no_normal_any_finite_one_will_do_but_none_only_where_nothing_is_drawn) {
  // The face of vertex 3 has no area at weight 1/2. At weight 1, this face coincides with the other face. The normals
  // of the two faces then cancel at vertices 1 and 2, but both faces are drawn.
  ShadedMesh mesh = hinge();
  mesh.targets[0].positions = {0, 0, 0, 0, 0, 0, 0, 0, 0, -4, 0, 0};
  mesh.targets[0].normals = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, -2};  // vertex 3: zero at 1/2, downwards at 1
  MotionError error = audit_of(mesh.file(), {.samples = 3}).error;
  EXPECT_EQ(error.no_normal, 3U);
  EXPECT_EQ(error.unlit, 0U);
  EXPECT_NEAR(error.worst, 0, 1e-9);
  mesh.targets[0].normals = {0, 0, 0, 0, 0, -1, 0, 0, 0, 0, 0, -2};  // vertex 1: zero at weight 1
  error = audit_of(mesh.file(), {.samples = 3}).error;
  EXPECT_EQ(error.no_normal, 2U);
  EXPECT_EQ(error.unlit, 1U);
  EXPECT_EQ(error.unlit_at.vertex, 1U);
  // A viewer cannot light an infinite normal, not even where the surface has no normal.
  mesh.normals[11] = 3e38F;
  mesh.targets[0].normals = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 3e38F};
  error = audit_of(mesh.file(), {.samples = 3}).error;
  EXPECT_EQ(error.unlit, 2U);
  EXPECT_EQ(error.unlit_at.at, 0.5);
}

TEST(Audit, a_track_that_cannot_be_lit_is_told_of_where_its_targets_are_wrong_too) {
  ShadedMesh mesh = hinge();
  mesh.targets[0].normals.assign(12, 2);
  GltfBuilder builder = mesh.file();
  builder.add_track(builder.add_animation(""), 0, std::vector<float>{0, 1}, std::vector<float>{0, 3e38F});
  const Audit result = audit_of(builder);
  EXPECT_EQ(kinds_of(result), (std::vector<Kind>{Kind::kWrongAtKeys, Kind::kUnlit, Kind::kStaleKeys}));
  EXPECT_EQ(result.worst, std::size_t{1});
}

TEST(Audit, deltas_of_normals_alone_are_motion_of_what_is_shown) {
  ShadedMesh mesh = hinge();
  mesh.targets[0] = {std::vector<float>(12, 0), {1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, {}};
  const Audit result = audit_of(mesh.file(), {.samples = 2});
  EXPECT_EQ(result.error.judged, 2U);
  EXPECT_NEAR(result.error.worst, 45, 1e-5);
  EXPECT_EQ(kinds_of(result), (std::vector<Kind>{Kind::kWrongAtKeys}));
}

TEST(Audit, nothing_that_moves_is_nothing_to_judge) {
  ShadedMesh mesh = hinge();
  mesh.targets[0].positions.assign(12, 0);
  Audit result = audit_of(mesh.file());
  EXPECT_TRUE(result.subjects.empty());
  EXPECT_EQ(result.still, 1U);
  EXPECT_FALSE(result.worst.has_value());
  mesh = hinge();
  mesh.normals.clear();  // without normals, viewers shade the mesh flat
  result = audit_of(mesh.file());
  EXPECT_TRUE(result.subjects.empty());
  EXPECT_EQ(kinds_of(result), (std::vector<Kind>{Kind::kFlat}));
  mesh = hinge();
  mesh.targets.clear();
  EXPECT_TRUE(audit_of(mesh.file()).subjects.empty());
}

// ---- the faults that an audit names

TEST(Audit, ends_that_are_right_with_a_chord_between_are_told_from_wrong_ends) {
  // At weight 1, the sum of both face normals is (-4, 0, 4), and N + D is its unit vector. The normal of vertex 3 goes
  // from z to -x.
  ShadedMesh mesh = hinge();
  const float h = std::sqrt(0.5F);
  mesh.targets[0].normals = {0, 0, 0, -h, 0, h - 1, -h, 0, h - 1, -1, 0, -1};
  const Audit result = audit_of(mesh.file());
  ASSERT_EQ(kinds_of(result), (std::vector<Kind>{Kind::kWrongBetween}));
  EXPECT_LT(result.subjects[0].at_keys.worst, 1e-4);
  EXPECT_GT(result.error.worst, 1);
  // If the normal delta of vertex 3 has z = 0, the rendered normal of vertex 3 at weight 1 is parallel to (-1, 0, 1),
  // which is wrong.
  mesh.targets[0].normals[11] = 0;
  // Requests a weighting, so that the audit need not find the weighting from the stored normals.
  const Audit wrong = audit_of(mesh.file(), {.weighting = Weighting::kArea});
  ASSERT_EQ(kinds_of(wrong), (std::vector<Kind>{Kind::kWrongAtKeys}));
  EXPECT_NEAR(wrong.findings[0].degrees, 45, 1e-4);
  EXPECT_EQ(wrong.findings[0].worst_at->vertex, 3U);
}

TEST(Audit, targets_that_are_right_alone_can_be_wrong_together) {
  // Target 0 tilts the face, and target 1 shears it within its plane. The normals of each target alone are right, but
  // both targets together turn the normal further.
  ShadedMesh mesh;
  mesh.corners = {0, 1, 2};
  mesh.positions = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  mesh.normals = {0, 0, 1, 0, 0, 1, 0, 0, 1};
  // If both targets moved vertices along z, n(w) = (1, 0, w0) x (0, 1, w1) = (-w0, -w1, 1) would be linear. Here,
  // target 1 moves a vertex along x, so n(w) has a term with w0 w1.
  mesh.targets = {{{0, 0, 0, 0, 0, 1, 0, 0, 0}, {-1, 0, 0, -1, 0, 0, -1, 0, 0}, {}},
                  {{0, 0, 0, 0, 0, 0, 1, 0, 0}, {}, {}}};
  // Both targets together give n(w) = (1, 0, w0) x (w1, 1, 0) = (-w0, w0 w1, 1).
  GltfBuilder builder = mesh.file();
  builder.add_track(builder.add_animation(""), 0, std::vector<float>{0, 1}, std::vector<float>{0, 0, 1, 1});
  const Audit result = audit_of(builder);
  ASSERT_EQ(result.subjects.size(), 3U);
  EXPECT_LT(result.subjects[0].error.worst, 1e-4);
  EXPECT_LT(result.subjects[1].error.worst, 1e-4);
  EXPECT_NEAR(result.error.worst, std::atan(1 / std::sqrt(2)) * 180 / std::numbers::pi, 1e-4);
  EXPECT_EQ(kinds_of(result), (std::vector<Kind>{Kind::kWrongTogether, Kind::kMissingNormals}));
  EXPECT_FALSE(result.findings[1].is_fault());  // target 1 alone turns no normal
}

TEST(Audit, stale_tangents_are_those_that_lean_on_the_right_normal) {
  ShadedMesh mesh = hinge();
  for (int v = 0; v < 4; ++v) mesh.tangents.insert(mesh.tangents.end(), {1, 0, 0, 1});
  const Audit result = audit_of(mesh.file());
  ASSERT_EQ(kinds_of(result), (std::vector<Kind>{Kind::kMissingNormals, Kind::kStaleTangents}));
  EXPECT_EQ(result.findings[1].count, 3U);
  EXPECT_NEAR(result.findings[1].degrees, 90, 1e-9);
  EXPECT_EQ(result.findings[1].worst_at->vertex, 3U);
  // True tangents lie in the folded face. At the edge, true tangents point up by 45 degrees, half of the angle between
  // both faces.
  mesh.targets[0].tangents = {0, 0, 0, 0, 0, 1, 0, 0, 1, -1, 0, 1};
  EXPECT_EQ(kinds_of(audit_of(mesh.file())), (std::vector<Kind>{Kind::kMissingNormals}));
  // Tangents along the hinge do not change when the hinge folds.
  mesh.targets[0].tangents.clear();
  mesh.tangents.clear();
  for (int v = 0; v < 4; ++v) mesh.tangents.insert(mesh.tangents.end(), {0, 1, 0, 1});
  EXPECT_EQ(kinds_of(audit_of(mesh.file())), (std::vector<Kind>{Kind::kMissingNormals}));
}

TEST(Audit, skins_and_baked_sequences_are_notes) {
  GltfBuilder builder = hinge().file();
  builder.json["nodes"][0]["skin"] = 0;
  EXPECT_EQ(kinds_of(audit_of(builder)), (std::vector<Kind>{Kind::kMissingNormals, Kind::kUnreadSkin}));
  builder = hinge().file();
  builder.json["meshes"][0]["extras"]["chronormal"] = {{"version", 1}, {"encode", "exact"}, {"sequence", true}};
  Audit result = audit_of(builder);
  EXPECT_TRUE(result.subjects.empty());  // the targets of a sequence have no meaning alone
  EXPECT_EQ(kinds_of(result), (std::vector<Kind>{Kind::kBaked, Kind::kSequenceTargets}));
  builder.add_track(builder.add_animation(""), 0, std::vector<float>{0, 1}, std::vector<float>{0, 1});
  result = audit_of(builder);
  ASSERT_EQ(result.subjects.size(), 1U);
  EXPECT_EQ(kinds_of(result), (std::vector<Kind>{Kind::kWrongAtKeys, Kind::kBaked, Kind::kSequenceTargets}));
}

TEST(Audit, extra_targets_that_lost_their_normals_are_a_note) {
  ShadedMesh mesh = hinge();
  mesh.targets.push_back({std::vector<float>(12, 0), std::vector<float>(12, 0), {}});
  GltfBuilder builder = mesh.file();
  builder.json["meshes"][0]["extras"]["chronormal"] = {
      {"version", 1}, {"encode", "exact"}, {"extras", {{{"target", 1}, {"factors", {0, 0}}}}}};
  const Audit result = audit_of(builder);
  EXPECT_EQ(kinds_of(result), (std::vector<Kind>{Kind::kMissingNormals, Kind::kEmptied}));
  EXPECT_EQ(result.findings[1].count, 1U);
}

// ---- tracks of weights

TEST(Audit, tracks_with_the_same_keys_are_subjects_of_their_own_nodes) {
  GltfBuilder builder = hinge().file();
  builder.add_node(0);
  const std::size_t animation = builder.add_animation("both");
  builder.add_track(animation, 0, std::vector<float>{0, 1}, std::vector<float>{0, 1});
  Json channel = builder.json["animations"][0]["channels"][0];
  channel["target"]["node"] = 1;
  builder.json["animations"][0]["channels"].push_back(channel);
  const Audit result = audit_of(builder);
  ASSERT_EQ(result.subjects.size(), 3U);
  EXPECT_EQ(result.subjects[1].node, 0U);
  EXPECT_EQ(result.subjects[2].node, 1U);
  EXPECT_EQ(result.subjects[1].error.sum, result.subjects[2].error.sum);
  EXPECT_EQ(result.error.judged, 3U * 3 * 21);
}

TEST(Audit, long_tracks_get_fewer_samples_and_single_keys_one) {
  GltfBuilder builder = hinge().file();
  std::vector<float> times, weights;
  for (int k = 0; k < 34; ++k) {
    times.push_back(static_cast<float>(k));
    weights.push_back(static_cast<float>(k % 2));
  }
  builder.add_track(builder.add_animation("long"), 0, times, weights);
  builder.add_track(builder.add_animation("pose"), 0, std::vector<float>{2}, std::vector<float>{1});
  builder.add_track(builder.add_animation("still"), 0, std::vector<float>{0, 1}, std::vector<float>{0, 0});
  const Audit result = audit_of(builder);
  ASSERT_EQ(result.subjects.size(), 3U);
  EXPECT_EQ(result.subjects[1].segments, 33U);
  EXPECT_EQ(result.subjects[1].samples, 7U);
  EXPECT_EQ(result.subjects[2].segments, 1U);
  EXPECT_EQ(result.subjects[2].samples, 1U);
  EXPECT_NEAR(result.subjects[2].error.mean(), 60, 1e-12);
  EXPECT_EQ(result.subjects[2].error.worst_at.at, 2);
  EXPECT_EQ(result.still, 1U);
}

TEST(Audit, one_animation_can_be_asked_for) {
  GltfBuilder builder = hinge().file();
  builder.add_track(builder.add_animation("a"), 0, std::vector<float>{0, 1}, std::vector<float>{0, 1});
  builder.add_track(builder.add_animation("b"), 0, std::vector<float>{0, 1}, std::vector<float>{0, 0.5F});
  const Audit result = audit_of(builder, {.animation = "b"});
  ASSERT_EQ(result.subjects.size(), 1U);
  EXPECT_EQ(result.subjects[0].animation, 1U);
  const GltfFixture fixture(builder);
  const Result<Audit> missing = audit(*fixture, {.animation = "c"});
  ASSERT_FALSE(missing.ok());
  EXPECT_EQ(missing.error().code, ErrorCode::kUsage);
}

TEST(Audit, other_rules_join_the_normals_of_the_keys) {
  // The mesh is a single triangle, in which vertex 2 moves from y to z, so n(t) = (0, -t, 1 - t). The stored normals at
  // the weights 0 and 1 are (0, 0, 1) and (0, -3, 0).
  ShadedMesh mesh;
  mesh.corners = {0, 1, 2};
  mesh.positions = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  mesh.normals = {0, 0, 1, 0, 0, 1, 0, 0, 1};
  mesh.targets = {{{0, 0, 0, 0, 0, 0, 0, -1, 1}, {0, -3, -1, 0, -3, -1, 0, -3, -1}, {}}};
  const auto sum = [&](AuditRule rule) { return audit_of(mesh.file(), {.rule = rule, .samples = 5}).error.sum / 3; };
  const auto angle = [](double y, double z) { return std::atan2(y, z) * 180 / std::numbers::pi; };
  double lerp_sum = 0, slerp_sum = 0, step_sum = 0;
  for (int i = 0; i < 5; ++i) {
    const double t = i / 4.0, right = angle(t, 1 - t);
    lerp_sum += std::fabs(angle(3 * t, 1 - t) - right);
    slerp_sum += std::fabs(90 * t - right);
    step_sum += i < 4 ? right : 0;  // by the rule step, only the last sample shows the second key
  }
  EXPECT_NEAR(sum(AuditRule::kGltf), lerp_sum, 1e-4);
  EXPECT_NEAR(sum(AuditRule::kLerp), lerp_sum, 1e-4);
  EXPECT_NEAR(sum(AuditRule::kNlerp), 0, 1e-4);
  EXPECT_NEAR(sum(AuditRule::kSlerp), slerp_sum, 1e-4);
  EXPECT_NEAR(sum(AuditRule::kStep), step_sum, 1e-4);
  EXPECT_NEAR(sum(AuditRule::kFlat), 0, 1e-4);
}

TEST(Audit, any_number_of_threads_gives_the_same_bits) {
  const ShadedMesh mesh = random_sheet(30, 70, 1, 0.2);
  const auto run = [&](std::size_t threads) {
    const ThreadLimit limit(threads);
    return audit_of(mesh.file());
  };
  const Audit one = run(1), many = run(7);
  EXPECT_EQ(one.error.sum, many.error.sum);
  EXPECT_EQ(one.error.sum_of_squares, many.error.sum_of_squares);
  EXPECT_EQ(one.error.worst, many.error.worst);
  EXPECT_EQ(one.error.worst_at.vertex, many.error.worst_at.vertex);
  EXPECT_EQ(one.error.histogram, many.error.histogram);
}

TEST(Audit, bad_options_are_refused) {
  const GltfFixture fixture(hinge().file());
  for (const std::size_t samples : {0U, 1U}) {
    const Result<Audit> result = audit(*fixture, {.samples = samples});
    ASSERT_FALSE(result.ok());
    EXPECT_EQ(result.error().code, ErrorCode::kUsage);
  }
  EXPECT_FALSE(make_audit_rule("cubic").ok());
  for (const AuditRule rule :
       {AuditRule::kGltf, AuditRule::kLerp, AuditRule::kNlerp, AuditRule::kSlerp, AuditRule::kStep, AuditRule::kFlat})
    EXPECT_EQ(make_audit_rule(audit_rule_name(rule)).value(), rule);
}

// ---- sequences of meshes

// Makes a triangle whose vertex 2 moves from y through z to -y. At the three keyframes, n is (0, 0, 1), (0, -1, 0) and
// (0, 0, -1).
Motion turning() {
  Motion motion;
  motion.topology = Topology::triangles(3, {0, 1, 2}).value();
  motion.keyframes = {{{0, 0, 0, 1, 0, 0, 0, 1, 0}, 0, ""},
                      {{0, 0, 0, 1, 0, 0, 0, 0, 1}, 2, ""},
                      {{0, 0, 0, 1, 0, 0, 0, -1, 0}, 4, ""}};
  motion.connect_as_sequence();
  return motion;
}

std::vector<float> thrice(float x, float y, float z) { return {x, y, z, x, y, z, x, y, z}; }

Audit audit_of(const Motion& motion, const StoredNormals& normals, const AuditOptions& options = {}) {
  Result<Audit> result = audit(motion, normals, options);
  EXPECT_TRUE(result.ok()) << result.error().text();
  return std::move(result).value();
}

TEST(Audit, player_that_computes_normals_at_keyframes_errs_between_them) {
  const Audit result = audit_of(turning(), {}, {.rule = AuditRule::kSlerp, .samples = 5});
  EXPECT_FALSE(result.stored);
  ASSERT_EQ(result.subjects.size(), 1U);
  EXPECT_EQ(result.subjects[0].segments, 2U);
  EXPECT_EQ(result.error.judged, 3U * 2 * 5);
  const double quarter = std::atan2(1.0, 3.0) * 180 / std::numbers::pi;  // degrees from n(0) to n(1/4) of a segment
  EXPECT_NEAR(result.error.worst, 22.5 - quarter, 1e-5);
  EXPECT_EQ(result.error.worst_at.at, 0.5);
  EXPECT_LT(result.subjects[0].at_keys.worst, 1e-5);
  EXPECT_EQ(kinds_of(result), (std::vector<Kind>{Kind::kWrongBetween}));
  EXPECT_TRUE(result.offsets.empty());
  // In each segment of this motion, n(t) moves straight from one unit normal to the next, so linear interpolation of
  // unit normals is exact.
  EXPECT_LT(audit_of(turning(), {}).error.worst, 1e-4);
}

TEST(Audit, stored_normals_of_a_sequence_that_stay_behind_are_errors) {
  const StoredNormals stale{{thrice(0, 0, 1), thrice(0, 0, 1), thrice(0, 0, 1)}};
  const Audit result = audit_of(turning(), stale, {.samples = 2});
  EXPECT_TRUE(result.stored);
  EXPECT_NEAR(result.error.worst, 180, 1e-9);
  EXPECT_NEAR(result.error.mean(), (0 + 90 + 90 + 180) / 4.0, 1e-9);
  EXPECT_EQ(kinds_of(result), (std::vector<Kind>{Kind::kWrongAtKeys}));
  EXPECT_LT(result.offsets[0].worst, 1e-9);
}

TEST(Audit, offset_that_an_author_carries_along_is_none) {
  // At every keyframe, the stored normals are tilted by 45 degrees towards x.
  const StoredNormals tilted{{thrice(1, 0, 1), thrice(2, -2, 0), thrice(3, 0, -3)}};
  const Audit result = audit_of(turning(), tilted, {.samples = 2});
  EXPECT_LT(result.error.worst, 1e-4);
  ASSERT_EQ(result.offsets.size(), 1U);
  EXPECT_NEAR(result.offsets[0].worst, 45, 1e-9);
  EXPECT_EQ(result.offsets[0].vertices, 3U);
  // If the author's offset grows over time, the growth counts as an error. Here the offset grows from 45 to 60 degrees.
  StoredNormals growing = tilted;
  const float t = std::tan(60 * std::numbers::pi_v<float> / 180);
  growing.of_keyframes[1] = thrice(t, -1, 0);
  EXPECT_NEAR(audit_of(turning(), growing, {.samples = 2}).error.worst, 15, 1e-4);
}

TEST(Audit, normals_of_keyframe_0_alone_say_which_edges_are_hard) {
  // Makes a sequence of the keyframes of the hinge. If the edge is hard, each face has its own normal, and linear
  // interpolation is exact.
  const ShadedMesh mesh = hinge();
  Motion motion;
  motion.topology = Topology::triangles(4, mesh.corners).value();
  std::vector<float> folded = mesh.positions;
  for (std::size_t i = 0; i < folded.size(); ++i) folded[i] += mesh.targets[0].positions[i];
  motion.keyframes = {{mesh.positions, 0, ""}, {folded, 1, ""}};
  motion.connect_as_sequence();
  const Audit soft = audit_of(motion, {});
  EXPECT_EQ(soft.subjects[0].vertices, 3U);
  const StoredNormals hard{{{0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 1, 0, 0, 1, 0}}};
  const Audit result = audit_of(motion, hard);
  EXPECT_FALSE(result.stored);
  EXPECT_EQ(result.subjects[0].vertices, 3U);  // only the vertices of the folding face
  const Audit flat = audit_of(motion, hard, {.rule = AuditRule::kFlat});
  EXPECT_LT(flat.error.worst, 1e-9);
}

TEST(Audit, targets_of_a_base_are_subjects_of_their_own) {
  Motion motion = turning();
  motion.connect_as_targets();
  motion.keyframes[1].name = "up";
  const Result<Audit> result = audit(motion, {}, {});
  ASSERT_TRUE(result.ok());
  ASSERT_EQ(result.value().subjects.size(), 2U);
  EXPECT_EQ(result.value().subjects[0].name, "up");
  EXPECT_EQ(result.value().subjects[1].target, 1U);
  EXPECT_EQ(result.value().subjects[1].error.no_normal, 3U);  // the face has no area at t = 1/2
}

TEST(Audit, sequences_refuse_what_does_not_fit) {
  const auto code = [](const StoredNormals& normals, const AuditOptions& options) {
    const Result<Audit> result = audit(turning(), normals, options);
    return result.ok() ? std::string() : result.error().text();
  };
  EXPECT_NE(code({}, {.rule = AuditRule::kGltf}), "");
  EXPECT_NE(code({{thrice(0, 0, 1), thrice(0, 0, 1)}}, {}), "");
  EXPECT_NE(code({{{0, 0, 1}}}, {}), "");
  EXPECT_NE(code({{thrice(0, 0, std::nanf(""))}}, {}), "");
  EXPECT_EQ(code({{thrice(0, 0, 1)}}, {}), "");
}

// ---- files by other people

class AuditOfRealFiles : public testing::Test {
 protected:
  void SetUp() override {
    const char* const folder = std::getenv("CHRONORMAL_DATA");
    if (folder == nullptr) GTEST_SKIP() << "set CHRONORMAL_DATA to the folder of the real data to run this test";
    data_ = folder;
  }
  [[nodiscard]] Audit of(const std::string& path, const AuditOptions& options = {}) const {
    const Result<GltfDocument> document = GltfDocument::open(data_ + "/gltf/" + path);
    EXPECT_TRUE(document.ok());
    Result<Audit> result = audit(document.value(), options);
    EXPECT_TRUE(result.ok()) << result.error().text();
    return std::move(result).value();
  }

  std::string data_;
};

TEST_F(AuditOfRealFiles, stored_target_normals_of_the_sphere_are_wrong) {
  const Audit result = of("AnimatedMorphSphere/glTF/AnimatedMorphSphere.gltf");
  ASSERT_EQ(result.subjects.size(), 3U);
  EXPECT_NEAR(result.subjects[0].at_keys.worst, 179.5, 0.6);
  EXPECT_NEAR(result.subjects[1].at_keys.worst, 55.69, 0.01);
  EXPECT_EQ(result.findings[0].kind, Kind::kWrongAtKeys);
}

TEST_F(AuditOfRealFiles, cube_is_right_at_its_targets_and_off_half_way) {
  const Audit result = of("AnimatedMorphCube/glTF/AnimatedMorphCube.gltf", {.samples = 3});
  EXPECT_LT(result.subjects[1].at_keys.worst, 0.01);
  EXPECT_NEAR(result.subjects[1].error.worst, 4.018, 0.001);
  EXPECT_EQ(result.subjects[1].error.worst_at.at, 0.5);
  EXPECT_EQ(kinds_of(result), (std::vector<Kind>{Kind::kWrongBetween}));
}

TEST_F(AuditOfRealFiles, files_without_target_normals_are_found) {
  const Audit result = of("MorphPrimitivesTest/glTF/MorphPrimitivesTest.gltf");
  ASSERT_FALSE(result.findings.empty());
  EXPECT_EQ(result.findings[0].kind, Kind::kMissingNormals);
  EXPECT_EQ(result.findings[0].count, 2U);
  EXPECT_NEAR(result.error.worst, 38.66, 0.01);
}

TEST_F(AuditOfRealFiles, angle_weighted_normals_are_no_fault) {
  const Audit area = of("MorphStressTest/glTF/MorphStressTest.gltf", {.weighting = Weighting::kArea});
  ASSERT_FALSE(area.offsets.empty());
  EXPECT_EQ(area.offsets[0].closest, Weighting::kAngle);
  EXPECT_LT(area.offsets[0].closest_worst, 0.7);
  EXPECT_GT(area.error.worst, 2.6);
  const Audit angle = of("MorphStressTest/glTF/MorphStressTest.gltf");
  EXPECT_EQ(angle.weighting, Weighting::kAngle);
  EXPECT_LT(angle.subjects[0].at_keys.worst, 0.01);
  EXPECT_LT(angle.error.worst, 0.35);
}

}  // namespace
}  // namespace chronormal::audit_test
