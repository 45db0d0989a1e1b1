// Checks angles and reference normals that the kernel computes in SIMD lanes. On every instruction set, the results of
// the kernel must have the same bits as the scalar functions. Also compares angles with long double.
#include "analysis/quality/kernels/reference_angles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "chronormal/analysis/quality.h"
#include "core/portable_math.h"
#include "simd/targets.h"
#include "tests/support/hard_motions.h"

namespace chronormal::reference_angles_test {
namespace {

struct Pairs {
  std::vector<Vec3d> exact;
  std::vector<float> shown;  // three floats per normal

  void add(const Vec3d& n, const Vec3f& u) {
    exact.push_back(n);
    shown.insert(shown.end(), {u.x, u.y, u.z});
  }
  [[nodiscard]] VectorView<const float> view() const {
    return VectorView<const float>::packed(shown.data(), exact.size());
  }
};

Vec3d to_vector(const fixtures::Point& p) { return {p[0], p[1], p[2]}; }

// Makes pairs of vectors with angles from 0 to 180 degrees and lengths from 1e-60 to 1e60, and pairs with vectors that
// are zero, infinite or NaN.
Pairs hard_pairs() {
  fixtures::Random random(24);
  Pairs pairs;
  for (int i = 0; i < 3000; ++i) {
    const Vec3d u = unit(to_vector(random.in_cube(1)));
    const double turn = std::pow(10.0, random.uniform(-9, 0.5));
    const Vec3d n = std::pow(10.0, random.uniform(-60, 60)) * (u + turn * to_vector(random.in_cube(1)));
    pairs.add(i % 7 == 0 ? -n : n, to_float(u));
  }
  const float infinity = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  for (const Vec3d& n : {Vec3d{}, Vec3d{0, 0, 1}, Vec3d{0, 0, -2}, Vec3d{1, 0, 0}}) {
    for (const Vec3f& u : {Vec3f{}, Vec3f{0, 0, 1}, Vec3f{0, -1, 0}, Vec3f{-0.0F, -1, 0}, Vec3f{infinity, 0, 0},
                           Vec3f{0, nan, 0}, Vec3f{1e-20F, 0, 0}})
      pairs.add(n, u);
  }
  return pairs;
}

double scalar_angle(const Vec3d& exact, const Vec3d& u) {
  const double scale = max_abs(exact);
  if (scale == 0) return kNoExactNormal;
  if (!(dot(u, u) > 0 && std::isfinite(dot(u, u)))) return kNoNormal;
  const Vec3d n{exact.x / scale, exact.y / scale, exact.z / scale};
  const Vec3d x = cross(n, u);
  return portable::atan2(std::sqrt(dot(x, x)), dot(n, u));
}

TEST(AnglesToExact, have_the_bits_of_one_angle_after_the_other_on_every_instruction_set) {
  const Pairs pairs = hard_pairs();
  std::vector<double> expected, angles(pairs.exact.size());
  for (std::size_t i = 0; i < pairs.exact.size(); ++i)
    expected.push_back(scalar_angle(pairs.exact[i], to_double(pairs.view()[i])));
  std::vector<float> planes[3];
  for (std::size_t i = 0; i < pairs.shown.size(); ++i) planes[i % 3].push_back(pairs.shown[i]);
  const auto of_planes =
      VectorView<const float>::planes(planes[0].data(), planes[1].data(), planes[2].data(), pairs.exact.size());
  for (const std::int64_t target : supported_targets()) {
    SCOPED_TRACE(target_name(target));
    const ScopedTarget scoped(target);
    for (const VectorView<const float>& shown : {pairs.view(), of_planes}) {
      angles_to_exact(pairs.exact, shown, angles);
      EXPECT_EQ(angles, expected);
    }
    angles_to_exact(std::span(pairs.exact).first(13), pairs.view().part({0, 13}), std::span(angles).first(13));
    EXPECT_EQ(std::vector<double>(angles.begin(), angles.begin() + 13),
              std::vector<double>(expected.begin(), expected.begin() + 13));
  }
}

TEST(AnglesToExact, are_within_a_few_roundings_of_those_of_long_double) {
  const Pairs pairs = hard_pairs();
  std::vector<double> angles(pairs.exact.size());
  angles_to_exact(pairs.exact, pairs.view(), angles);
  std::size_t judged = 0;
  for (std::size_t i = 0; i < angles.size(); ++i) {
    if (angles[i] < 0) continue;
    const Vec3d n = unit(pairs.exact[i]), u = to_double(pairs.view()[i]);
    const long double x = static_cast<long double>(n.y) * u.z - static_cast<long double>(n.z) * u.y,
                      y = static_cast<long double>(n.z) * u.x - static_cast<long double>(n.x) * u.z,
                      z = static_cast<long double>(n.x) * u.y - static_cast<long double>(n.y) * u.x,
                      along = static_cast<long double>(n.x) * u.x + static_cast<long double>(n.y) * u.y +
                              static_cast<long double>(n.z) * u.z;
    EXPECT_NEAR(angles[i], static_cast<double>(std::atan2(std::sqrt(x * x + y * y + z * z), along)), 2e-15) << i;
    ++judged;
  }
  EXPECT_GT(judged, 3000U);
}

TEST(ReferenceTriangles, have_the_directions_of_reference_normals_bit_for_bit_on_every_instruction_set) {
  fixtures::Random random(5);
  std::size_t judged = 0, zero = 0;
  for (const test::HardMotions& hard : test::hard_motions()) {
    const Motion motion = hard.make(random);
    if (!motion.topology.all_triangles()) continue;
    const Segment segment = motion.segment(0);
    const IndexRange faces{0, motion.topology.face_count()};
    std::vector<Vec3d> expected(faces.count), normals(faces.count);
    for (const double t : {0.0, 0.05, 0.5, 0.83, 1.0}) {
      reference_normals(segment, faces, t, expected);
      for (Vec3d& n : expected) {
        const double scale = max_abs(n);
        if (scale > 0) n = {n.x / scale, n.y / scale, n.z / scale};
        ++(scale > 0 ? judged : zero);
      }
      for (const std::int64_t target : supported_targets()) {
        const ScopedTarget scoped(target);
        ReferenceTriangles(segment, faces).normals(t, normals);
        EXPECT_EQ(normals, expected) << hard.name << " at " << t << " on " << target_name(target);
      }
    }
  }
  EXPECT_GT(judged, 1000U);
  EXPECT_GT(zero, 10U);
}

}  // namespace
}  // namespace chronormal::reference_angles_test
