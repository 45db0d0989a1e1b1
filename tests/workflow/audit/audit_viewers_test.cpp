// Compares the errors that an audit finds in each viewer with plain loops. The loops compute the weights that the
// viewer plays, the positions and true normals at the specified weights, and the normals that the viewer renders.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "chronormal/workflow/audit.h"
#include "chronormal/workflow/viewers.h"
#include "tests/support/audit_fixture.h"
#include "tests/support/elements.h"
#include "tests/support/fixtures.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/shaded_mesh.h"
#include "tests/support/viewer_oracle.h"

namespace chronormal::audit_viewers_test {
namespace {

using test::audit_of;
using test::GltfBuilder;
using test::Real;
using test::ShadedMesh;
using test::Triple;
using test::Vector;

std::vector<Viewer> all_viewers() { return {kViewers.begin(), kViewers.end()}; }

Triple triple(const Vector& v) {
  return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

// The errors that an oracle finds, in degrees.
struct Expected {
  std::vector<Real> errors;
  Real displaced = 0;

  // Adds the errors of all vertices in one pose. The rendered normals have the weights that the viewer plays, and the
  // true normals have the weights of the specification.
  void add(const ShadedMesh& mesh, std::string_view viewer, const std::vector<double>& played,
           const std::vector<double>& specified) {
    const std::vector<double> none(played.size());
    for (std::size_t v = 0; v < mesh.vertices(); ++v) {
      std::vector<Triple> deltas;
      for (const ShadedMesh::Target& target : mesh.targets)
        deltas.push_back(triple(test::vector_at(target.normals, v)));
      const Vector stored = test::vector_at(mesh.normals, v);
      const Triple shown = test::shown_by(viewer, triple(stored), deltas, played);
      const Vector right = test::rotated(test::unit_of(mesh.normal(v, none)), test::unit_of(stored),
                                         test::unit_of(mesh.normal(v, played)));
      errors.push_back(test::degrees_between({shown[0], shown[1], shown[2]}, right));
      const Vector away = test::plus(mesh.position(v, played), mesh.position(v, specified), -1);
      displaced = std::max(displaced, test::length_of(away));
    }
  }
};

void expect_same(const ViewerAudit& viewer, Expected expected, const std::string& what) {
  SCOPED_TRACE(std::string(viewer.viewer.title) + ", " + what);
  ASSERT_EQ(viewer.error.judged, expected.errors.size());
  EXPECT_EQ(viewer.error.unlit, 0U);
  Real sum = 0;
  for (const Real e : expected.errors) sum += e;
  std::sort(expected.errors.begin(), expected.errors.end());
  // Numbers that are halfway between two representable numbers may be rounded up or down. Small differences, in
  // degrees, are therefore permitted.
  constexpr double kMean = 0.002, kWorst = 0.1;
  EXPECT_NEAR(viewer.error.mean(), static_cast<double>(sum) / static_cast<double>(expected.errors.size()), kMean);
  EXPECT_NEAR(viewer.error.worst, static_cast<double>(expected.errors.back()), kWorst);
}

Real diagonal(const ShadedMesh& mesh) {
  Vector low = test::vector_at(mesh.positions, 0), high = low;
  for (std::size_t v = 0; v < mesh.vertices(); ++v) {
    for (std::size_t c = 0; c < 3; ++c) {
      low[c] = std::min(low[c], test::vector_at(mesh.positions, v)[c]);
      high[c] = std::max(high[c], test::vector_at(mesh.positions, v)[c]);
    }
  }
  return test::length_of(test::plus(high, low, -1));
}

TEST(AuditViewers, targets_alone_have_the_errors_of_an_oracle) {
  const ShadedMesh mesh = test::random_sheet(31, 5, 3, 0.3);
  const Audit result = audit_of(mesh.file(), {.samples = 6, .viewers = all_viewers()});
  ASSERT_EQ(result.viewers.size(), kViewers.size());
  for (const ViewerAudit& viewer : result.viewers) {
    Expected expected;
    for (std::size_t k = 0; k < 3; ++k) {
      for (int i = 0; i < 6; ++i) {
        std::vector<double> weights(3);
        weights[k] = i / 5.0;
        expected.add(mesh, viewer.viewer.name, weights, weights);
      }
    }
    expect_same(viewer, expected, "targets");
    EXPECT_EQ(viewer.displaced, 0);
    ASSERT_TRUE(viewer.worst);
    EXPECT_LT(*viewer.worst, 3U);
  }
}

TEST(AuditViewers, animations_of_every_interpolation_have_the_errors_of_an_oracle) {
  const ShadedMesh mesh = test::random_sheet(32, 4, 2, 0.2);
  const std::vector<float> times = {0.5F, 1, 1.25F, 3};
  struct Case {
    const char* name;
    GltfInterpolation interpolation;
    std::vector<float> values;
  };
  const Case cases[] = {
      {"LINEAR", GltfInterpolation::kLinear, {0, 0.25F, 1, 0.5F, -0.5F, 1.25F, 0.3F, 1e-6F}},
      {"STEP", GltfInterpolation::kStep, {0, 0.25F, 1, 0.5F, -0.5F, 1.25F, 0.3F, 5e-5F}},
      {"CUBICSPLINE", GltfInterpolation::kCubicSpline, {0, 0, 0,     0.25F, 1, -1, 2,  1,    1,    0.5F, -1, 0.5F,
                                                        3, 1, -0.5F, 1.25F, 0, 2,  -2, 0.5F, 0.3F, 0.1F, 0,  0}}};
  for (const Case& c : cases) {
    GltfBuilder builder = mesh.file();
    builder.add_track(builder.add_animation("moves"), 0, times, c.values, c.name);
    const Audit result = audit_of(builder, {.samples = 4, .animation = "moves", .viewers = all_viewers()});
    ASSERT_EQ(result.subjects.size(), 1U);
    for (const ViewerAudit& viewer : result.viewers) {
      Expected expected;
      for (std::size_t s = 0; s + 1 < times.size(); ++s) {
        for (int i = 0; i < 4; ++i) {
          double time = (1 - i / 3.0) * static_cast<double>(times[s]) + i / 3.0 * static_cast<double>(times[s + 1]);
          // Weights may jump at keys. The last sample of a segment has the weights just before the jump, except at the
          // last key.
          if (i == 3 && s + 2 < times.size()) time = std::nextafter(static_cast<double>(times[s + 1]), 0);
          std::vector<double> played =
              test::played_by(viewer.viewer.name, c.interpolation, times, c.values, 2, 0.5, 3, time);
          for (double& w : played)
            if (std::fabs(w) <= viewer.viewer.least_weight) w = 0;
          expected.add(mesh, viewer.viewer.name, played, test::weights_at(c.interpolation, times, c.values, 2, time));
        }
      }
      expect_same(viewer, expected, c.name);
      EXPECT_NEAR(viewer.displaced, static_cast<double>(expected.displaced / diagonal(mesh)), 1e-6)
          << viewer.viewer.title << ", " << c.name;
    }
  }
}

TEST(AuditViewers, a_viewer_that_does_as_specified_has_the_very_errors_of_the_rule) {
  const ShadedMesh mesh = test::random_sheet(33, 6, 3, 0.2);
  GltfBuilder builder = mesh.file();
  builder.add_track(builder.add_animation("moves"), 0, std::vector<float>{0, 1},
                    std::vector<float>{0, 0, 0, 1, 0.5F, 1});
  const Audit result = audit_of(builder, {.viewers = find_viewers("three,babylon,bevy").value()});
  const Audit without = audit_of(builder, {});
  EXPECT_EQ(result.error.sum, without.error.sum);
  for (const ViewerAudit& viewer : result.viewers) {
    EXPECT_EQ(viewer.error.sum, result.error.sum) << viewer.viewer.title;
    EXPECT_EQ(viewer.error.worst, result.error.worst) << viewer.viewer.title;
    EXPECT_EQ(viewer.error.counts, result.error.counts) << viewer.viewer.title;
    EXPECT_EQ(viewer.worst, result.worst) << viewer.viewer.title;
    EXPECT_EQ(viewer.displaced, 0) << viewer.viewer.title;
  }
}

TEST(AuditViewers, targets_beyond_the_limit_are_ignored_and_noted) {
  ShadedMesh mesh = test::random_sheet(34, 3, 1, 0);
  const ShadedMesh::Target moved = mesh.targets[0];
  mesh.targets.assign(257, {std::vector<float>(27), std::vector<float>(27), {}});
  mesh.targets.push_back(moved);
  GltfBuilder builder = mesh.file();
  std::vector<float> values(2 * 258);
  values.back() = 1;
  builder.add_track(builder.add_animation("moves"), 0, std::vector<float>{0, 1}, values);
  const Audit result = audit_of(builder, {.viewers = find_viewers("three,filament").value()});
  EXPECT_GT(result.viewers[0].error.worst, 1);
  EXPECT_LT(result.viewers[1].error.worst, 0.01);  // this viewer ignores the target that moves vertices
  EXPECT_GT(result.viewers[1].displaced, 0.05);
  EXPECT_EQ(result.viewers[0].displaced, 0);
  EXPECT_TRUE(result.viewers[0].is_within(180));
  EXPECT_EQ(result.viewers[1].beyond, 2U);
  EXPECT_FALSE(result.viewers[1].is_within(180));  // the mesh has more targets than this viewer supports
  const auto note = std::find_if(result.findings.begin(), result.findings.end(),
                                 [](const AuditFinding& f) { return f.kind == AuditFinding::Kind::kBeyondViewer; });
  ASSERT_NE(note, result.findings.end());
  EXPECT_EQ(note->count, 2U);
  EXPECT_EQ(note->viewer->name, "filament");
  EXPECT_FALSE(note->is_fault());
  EXPECT_EQ(
      std::count_if(result.findings.begin(), result.findings.end(), [](const AuditFinding& f) { return f.viewer; }), 1);
}

TEST(AuditViewers, a_normal_that_a_viewer_cannot_light_is_counted_for_that_viewer) {
  // By the specification, N + D is (0, 0, 0.003). Viewers that store eight bits per component round this normal to
  // zero. Viewers that store directions keep the direction exactly.
  ShadedMesh mesh = test::hinge();
  mesh.targets[0].normals.assign(12, 0);
  mesh.targets[0].normals[11] = -1 + 0.003F;
  const Audit result = audit_of(mesh.file(), {.samples = 2, .viewers = find_viewers("three,godot,gltfpack").value()});
  EXPECT_EQ(result.viewers[0].error.unlit, 0U);
  EXPECT_EQ(result.viewers[1].error.unlit, 0U);
  EXPECT_EQ(result.viewers[2].error.unlit, 1U);
  EXPECT_EQ(result.viewers[2].error.worst, 180);
}

TEST(AuditViewers, go_with_the_rule_gltf_and_with_gltf_files) {
  const test::GltfFixture file(test::hinge().file());
  const Result<Audit> other = audit(*file, {.rule = AuditRule::kSlerp, .viewers = all_viewers()});
  ASSERT_FALSE(other.ok());
  EXPECT_EQ(other.error().code, ErrorCode::kUsage);
  EXPECT_TRUE(audit(*file, {.rule = AuditRule::kGltf, .viewers = all_viewers()}).ok());
  const Motion motion = fixtures::smooth_morph(4);
  const Result<Audit> sequence = audit(motion, {}, {.viewers = all_viewers()});
  ASSERT_FALSE(sequence.ok());
  EXPECT_EQ(sequence.error().code, ErrorCode::kUsage);
}

}  // namespace
}  // namespace chronormal::audit_viewers_test
