// Compares the mean normals over the time for which a shutter is open with oracles that share no code with the library.
// If n(t) moves along a straight line, the oracle is a formula, also for lines that pass close to zero. Otherwise the
// oracle computes normals from positions and integrates them by dense Gaussian quadrature in long double.

#include "chronormal/analysis/cones.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iostream>
#include <limits>
#include <vector>

#include "chronormal/normals/normal_groups.h"
#include "tests/support/cone_oracle.h"
#include "tests/support/exact_cases.h"
#include "tests/support/fixtures.h"
#include "tests/support/hard_motions.h"

namespace chronormal::shutter_test {
namespace {

using Real = long double;
using Vector = std::array<Real, 3>;

Real length_of(const Vector& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }
Real distance(const Vec3d& a, const Vector& b) { return length_of({a.x - b[0], a.y - b[1], a.z - b[2]}); }

// Returns n(t) as the cross product of two edges at t.
Vector normal_of(const Segment& segment, std::size_t f, Real t) {
  const auto face = segment.topology->face(f);
  const auto at = [&](std::size_t c) {
    const Vec3f a = segment.from[face[c]], b = segment.to[face[c]];
    return Vector{(1 - t) * a.x + t * b.x, (1 - t) * a.y + t * b.y, (1 - t) * a.z + t * b.z};
  };
  const Vector o = at(0), b = at(1), c = at(2);
  const Vector e{b[0] - o[0], b[1] - o[1], b[2] - o[2]}, g{c[0] - o[0], c[1] - o[1], c[2] - o[2]};
  return {e[1] * g[2] - e[2] * g[1], e[2] * g[0] - e[0] * g[2], e[0] * g[1] - e[1] * g[0]};
}

struct Means {
  Vector mean{}, unit{};
};

// Integrates the normal and the unit normal of a face from t0 to t1 by Gauss's rule with three nodes in each of
// `pieces` equal parts.
Means dense_means(const Segment& segment, std::size_t f, double t0, double t1, int pieces) {
  const Real node = std::sqrt(Real{0.6});
  Means means;
  for (int i = 0; i < pieces; ++i) {
    for (const auto& [x, w] : {std::array<Real, 2>{-node, Real{5} / 18}, {0, Real{8} / 18}, {node, Real{5} / 18}}) {
      const Real t = t0 + (Real{t1} - t0) * (Real(i) + (1 + x) / 2) / pieces;
      const Vector n = normal_of(segment, f, t);
      const Real size = length_of(n);
      for (std::size_t k = 0; k < 3; ++k) {
        means.mean[k] += w * n[k] / pieces;
        if (size > 0) means.unit[k] += w * n[k] / size / pieces;
      }
    }
  }
  return means;
}

// Returns the mean of (a + t b) / |a + t b| over [0, 1], where a is `from` and b is `to` - `from`. Writes a + t b as h
// + (s0 + t |b|) b / |b|, where h is perpendicular to b.
Vector mean_of_line(const Vec3d& from, const Vec3d& to) {
  const Vector a{from.x, from.y, from.z}, b{Real{to.x} - from.x, Real{to.y} - from.y, Real{to.z} - from.z};
  const Real size = length_of(b);
  const Vector along{b[0] / size, b[1] / size, b[2] / size};
  const Real s0 = a[0] * along[0] + a[1] * along[1] + a[2] * along[2], s1 = s0 + size;
  const Vector h{a[0] - s0 * along[0], a[1] - s0 * along[1], a[2] - s0 * along[2]};
  const Real height = length_of(h);
  const Real across = height == 0 ? 0 : (std::asinh(s1 / height) - std::asinh(s0 / height)) / size;
  const Real forward = (std::hypot(s1, height) - std::hypot(s0, height)) / size;
  Vector mean{};
  for (std::size_t k = 0; k < 3; ++k) mean[k] = h[k] * across + along[k] * forward;
  return mean;
}

TEST(ExactShutter, of_lines_that_pass_near_zero_is_within_its_bound_of_the_closed_form) {
  fixtures::Random random(501);
  double largest_error = 0, largest_bound = 0;
  const std::size_t wanted = test::wanted_cases() / 50;
  for (std::size_t i = 0; i < wanted; ++i) {
    const fixtures::Point d = random.in_cube(1), g = random.in_cube(1);
    const double when = random.uniform(-0.2, 1.2), gap = std::ldexp(1, -static_cast<int>(random.below(40)));
    // Rounds the control normals to floats, so that their exact values are known.
    const auto end = [&](double t) {
      return to_double(
          to_float({(t - when) * d[0] + gap * g[0], (t - when) * d[1] + gap * g[1], (t - when) * d[2] + gap * g[2]}));
    };
    const Vec3d from = end(0), to = end(1);
    const ShutterNormal s = shutter_normal({from, 0.5 * (from + to), to}, 0, 1);
    const auto error = static_cast<double>(distance(s.mean_unit, mean_of_line(from, to)));
    ASSERT_LE(error, s.error) << "case " << i << ", gap " << gap;
    largest_error = std::max(largest_error, error);
    largest_bound = std::max(largest_bound, s.error);
  }
  std::cout << "  " << wanted << " lines: off by up to " << largest_error << ", bounds up to " << largest_bound << '\n';
  EXPECT_LT(largest_bound, 2e-6);
}

// Gives every control normal an error of almost 2^-26 of its length, in the same direction for all. The bound of the
// shutter normal must cover these errors.
TEST(Shutter, has_a_bound_that_covers_the_rounding_of_control_normals) {
  fixtures::Random random(503);
  double smallest_bound = 1;
  for (int i = 0; i < 200; ++i) {
    const fixtures::Point p = random.in_cube(1), q = random.in_cube(1);
    const Vec3d from = unit({p[0], p[1], p[2]}), to = unit(from + Vec3d{q[0] / 4, q[1] / 4, q[2] / 4});
    const Vec3d off = 0.99 * 0x1p-26 * any_perpendicular(unit(from + to));
    const ShutterNormal s = shutter_normal({from + off, 0.5 * (from + to) + off, to + off}, 0, 1);
    EXPECT_LE(distance(s.mean_unit, mean_of_line(from, to)), s.error);
    smallest_bound = std::min(smallest_bound, s.error);
  }
  EXPECT_LT(smallest_bound, 1e-7);
}

TEST(Shutter, of_faces_is_within_its_bound_of_dense_quadrature) {
  fixtures::Random random(502);
  double largest_error = 0, largest_bound = 0;
  std::size_t judged = 0, left_out = 0;
  for (const double motion_size : {0.02, 0.3, -1.0}) {
    const Motion motion = fixtures::soup({.face_count = 120, .seed = 9, .motion = motion_size});
    const Segment segment = motion.segment(0);
    const double t0 = motion_size > 0.1 ? 0.2 : 0, t1 = motion_size > 0.1 ? 0.7 : 1;
    std::vector<ShutterNormal> found(120);
    face_shutter_normals(segment, {0, 120}, t0, t1, found);
    for (std::size_t f = 0; f < found.size(); ++f) {
      const Means fine = dense_means(segment, f, t0, t1, 256), rough = dense_means(segment, f, t0, t1, 128);
      const double own_error = static_cast<double>(
          length_of({fine.unit[0] - rough.unit[0], fine.unit[1] - rough.unit[1], fine.unit[2] - rough.unit[2]}));
      EXPECT_LE(distance(found[f].mean, fine.mean), 1e-12 * length_of(fine.mean) + 1e-15);
      if (own_error > 1e-9) {
        ++left_out;
        continue;
      }
      ++judged;
      const auto error = static_cast<double>(distance(found[f].mean_unit, fine.unit));
      EXPECT_LE(error, found[f].error + own_error) << f;
      EXPECT_LE(length(found[f].mean_unit), 1 + 1e-12);
      largest_error = std::max(largest_error, error);
      largest_bound = std::max(largest_bound, found[f].error);
    }
  }
  std::cout << "  " << judged << " faces: off by up to " << largest_error << ", bounds up to " << largest_bound << ", "
            << left_out << " left out\n";
  EXPECT_GT(judged, 300u);
  EXPECT_LT(largest_error, 1e-8);
}

TEST(Shutter, of_a_face_that_turns_over_is_what_is_left_of_both_sides) {
  // The normal is exactly z before the collapse at t = 1/4 and -z after the collapse, so the mean is z/4 - 3 z/4.
  const fixtures::Point o{0, 0, 0}, x{1, 0, 0};
  const Motion motion = test::soup_of({{{o, x, {0, 1, 0}}, {o, x, {0, -3, 0}}}});
  ShutterNormal s;
  face_shutter_normals(motion.segment(0), {0, 1}, 0, 1, {&s, 1});
  EXPECT_NEAR(s.mean_unit.z, -0.5, s.error);
  EXPECT_LT(s.error, 2e-6);
  EXPECT_NEAR(s.mean.z, -1, 1e-15);
  face_shutter_normals(motion.segment(0), {0, 1}, 0.125, 0.375, {&s, 1});
  EXPECT_NEAR(s.mean_unit.z, 0, s.error);
  face_shutter_normals(motion.segment(0), {0, 1}, 0.25, 1, {&s, 1});
  EXPECT_NEAR(s.mean_unit.z, -1, s.error);
  EXPECT_EQ(s.mean_unit.x, 0);
}

TEST(Shutter, of_nothing_and_of_an_instant_and_at_any_scale) {
  const Vec3d x{1, 0, 0}, y{0, 1, 0}, zero{};
  EXPECT_EQ(shutter_normal({zero, zero, zero}, 0, 1).mean_unit, zero);
  EXPECT_EQ(shutter_normal({zero, zero, zero}, 0, 1).error, 0);
  const ShutterNormal still = shutter_normal({x, x, x}, 0.2, 0.9);
  EXPECT_NEAR(still.mean_unit.x, 1, still.error);
  EXPECT_LT(still.error, 1e-7);
  const ShutterNormal instant = shutter_normal({x, y, y}, 0.5, 0.5);
  EXPECT_NEAR(instant.mean_unit.x, 1 / std::sqrt(10.0), 1e-9);
  EXPECT_NEAR(instant.mean_unit.y, 3 / std::sqrt(10.0), 1e-9);
  const ShutterNormal one = shutter_normal({x, x + y, y}, 0, 1);
  for (const double scale : {0x1p-1000, 0x1p-300, 0x1p300, 0x1p1000})
    EXPECT_EQ(shutter_normal({scale * x, scale * (x + y), scale * y}, 0, 1).mean_unit, one.mean_unit);
  EXPECT_EQ(shutter_normal({x, {std::numeric_limits<double>::infinity(), 0, 0}, x}, 0, 1).error, 1);
}

}  // namespace
}  // namespace chronormal::shutter_test
