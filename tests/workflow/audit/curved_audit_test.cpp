// Audits of sequences whose vertices move on curves have the figures that are computed here from positions.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "chronormal/io/gltf_document.h"
#include "chronormal/workflow/audit.h"
#include "tests/support/curved_motion.h"

namespace chronormal::curved_audit_test {
namespace {

TEST(CurvedAudit, judges_what_is_shown_against_the_normals_of_the_curve) {
  const Motion motion = test::curved_motion({0, 0.3, 0.5, 1}, 1.2, 16, 8);
  AuditOptions options;
  options.samples = 3;
  options.path = PathKind::kCatmullRom;
  const Result<Audit> audited = audit(motion, {}, options);
  ASSERT_TRUE(audited.ok()) << audited.error().text();
  EXPECT_EQ(audited.value().path, PathKind::kCatmullRom);
  EXPECT_NEAR(audited.value().bend, bend_of(motion), 1e-12);
  double sum = 0, worst = 0;
  std::size_t count = 0;
  for (std::size_t s = 0; s < 3; ++s) {
    const auto start = test::normals_of(motion, test::on_curve(motion, s, 0), true),
               end = test::normals_of(motion, test::on_curve(motion, s, 1), true),
               right = test::normals_of(motion, test::on_curve(motion, s, 0.5L), true);
    for (std::size_t v = 0; v < right.size(); ++v) {
      std::array<long double, 3> nlerp;
      const auto length = [](const auto& n) { return std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]); };
      for (std::size_t c = 0; c < 3; ++c) nlerp[c] = start[v][c] / length(start[v]) + end[v][c] / length(end[v]);
      const double angle = test::angle_of(nlerp, right[v]) * kDegreesPerRadian;
      sum += angle;
      worst = std::max(worst, angle);
      ++count;
    }
  }
  EXPECT_EQ(audited.value().error.judged, 3 * count) << "the ends are judged as well, and right";
  EXPECT_NEAR(audited.value().error.sum, sum, 1e-4 * sum);
  EXPECT_NEAR(audited.value().error.worst, worst, 1e-4);
  EXPECT_GT(worst, 1);
  options.path = PathKind::kLinear;
  EXPECT_NE(audit(motion, {}, options).value().error.worst, audited.value().error.worst);
}

TEST(CurvedAudit, refuses_paths_that_a_motion_does_not_have) {
  const Motion motion = test::curved_motion({0, 0.5, 1}, 1.2, 6, 4);
  AuditOptions options;
  options.path = PathKind::kHermite;
  EXPECT_EQ(audit(motion, {}, options).error().code, ErrorCode::kUsage);
}

}  // namespace
}  // namespace chronormal::curved_audit_test
