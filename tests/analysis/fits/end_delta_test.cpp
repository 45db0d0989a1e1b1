// best_end_delta() chooses the scale of one end normal. Compares this scale with the best scale that a search in long
// double finds on a fine grid of scales and times.

#include "analysis/fits/end_delta.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "chronormal/io/input.h"
#include "chronormal/normals/normal_groups.h"
#include "tests/support/fixtures.h"
#include "tests/support/reference.h"

namespace chronormal::end_delta_test {
namespace {

using fixtures::Random;
using Real = long double;
using Vector = reference::Vector;

constexpr double kDegree = std::numbers::pi / 180;

Vector real(const Vec3d& v) { return {Real(v.x), Real(v.y), Real(v.z)}; }

Vec3d vector(Random& random, double size = 1) {
  const auto p = random.in_cube(size);
  return {p[0], p[1], p[2]};
}

// Makes a triangle whose edges change by about `motion`, and returns its control normals.
ControlNormals triangle(Random& random, double motion) {
  const Vec3d e0 = vector(random), f0 = vector(random);
  const Vec3d e1 = e0 + vector(random, motion), f1 = f0 + vector(random, motion);
  return {cross(e0, f0), 0.5 * (cross(e0, f1) + cross(e1, f0)), cross(e1, f1)};
}

Vector exact(const ControlNormals& n, Real w) {
  using reference::add, reference::scaled;
  const Real v = 1 - w;
  return add(add(scaled(v * v, real(n.n0)), scaled(2 * v * w, real(n.m))), scaled(w * w, real(n.n1)));
}

// Returns the largest angle, in radians, between the exact normals n(w) and the straight line `from` to `to`. The times
// w are a grid that is also dense near both ends. The result may be smaller than the true largest angle by about a
// thousandth of this angle.
Real brute_error(const ControlNormals& normals, const Vector& from, const Vector& to, int steps) {
  using reference::add, reference::scaled;
  Real worst = 0;
  for (int i = 1; i < steps; ++i) {
    const Real x = Real(i) / steps, y = 1 - x;
    for (const Real w : {x, x * x * x, 1 - y * y * y}) {
      const Vector line = add(scaled(1 - w, from), scaled(w, to)), n = exact(normals, w);
      if (reference::length(n) > 0 && reference::length(line) > 0) worst = std::max(worst, reference::angle(line, n));
    }
  }
  return worst;
}

struct Brute {
  Real best = 10, scale = 1;
};

Brute brute_best(const ControlNormals& normals, const Vector& u0, const Vector& u1, Real range, int scales, int steps) {
  Brute brute;
  for (int i = 0; i <= scales; ++i) {
    const Real s = std::exp(range * (2 * Real(i) / scales - 1));
    const Real error = brute_error(normals, u0, reference::scaled(s, u1), steps);
    if (error < brute.best) brute = {error, s};
  }
  return brute;
}

TEST(EndDelta, no_scale_of_a_fine_grid_is_better) {
  Random random(1);
  int right_angles = 0;
  for (int round = 0; round < 200; ++round) {
    const ControlNormals normals =
        triangle(random, std::array{0.05, 0.3, 1.0, 3.0}[static_cast<std::size_t>(round % 4)]);
    const Vector u0 = reference::normalised(real(normals.n0)), u1 = reference::normalised(real(normals.n1));
    const EndDelta found = best_end_delta(normals);
    Brute brute = brute_best(normals, u0, u1, 6, 60, 100);
    for (int i = -20; i <= 20; ++i) {
      const Real s = brute.scale * std::exp(Real(i) / 100);
      brute.best = std::min(brute.best, brute_error(normals, u0, reference::scaled(s, u1), 100));
    }
    const bool collapses = found.error > 90 * kDegree;  // near a collapse, the largest angle depends on the grid
    EXPECT_LE(found.error, (collapses ? 1.02L : 1.002L) * brute.best + 1e-12L) << round;
    // best_end_delta() also states the largest error of its straight line. This stated error must be the true error.
    const Vector to = reference::add(u0, real(found.delta));
    EXPECT_NEAR(static_cast<double>(reference::angle(to, u1)), 0, 1e-11) << round;
    EXPECT_NEAR(static_cast<double>(reference::length(to)), found.scale, 1e-10 * found.scale) << round;
    const auto claimed = static_cast<double>(brute_error(normals, u0, to, 3000));
    EXPECT_NEAR(found.error, claimed, 2e-3 * claimed) << round;
    right_angles += collapses ? 1 : 0;
  }
  EXPECT_GE(right_angles, 3);  // makes sure that errors near 90 degrees occur, where there may be several minima
  EXPECT_LT(right_angles, 100);
}

TEST(EndDelta, is_never_worse_than_unit_ends) {
  Random random(2);
  for (int round = 0; round < 5000; ++round) {
    const ControlNormals normals = triangle(random, random.uniform(0, 3));
    const EndDelta found = best_end_delta(normals);
    const double plain = largest_line_error(normals, unit(normals.n0), unit(normals.n1));
    EXPECT_LE(found.error, plain);
    EXPECT_GE(found.scale, 0x1p-16);
    EXPECT_LE(found.scale, 0x1p16);
    EXPECT_LE(found.error, std::numbers::pi);
  }
}

TEST(EndDelta, is_exact_where_the_normal_runs_on_a_line) {
  Random random(3);
  for (int round = 0; round < 2000; ++round) {
    const Vec3d n0 = std::exp(random.uniform(-4, 4)) * vector(random),
                n1 = std::exp(random.uniform(-4, 4)) * vector(random);
    const EndDelta found = best_end_delta({n0, 0.5 * (n0 + n1), n1});
    EXPECT_LT(found.error, 1e-7) << round;
    EXPECT_NEAR(found.scale, length(n1) / length(n0), 1e-6 * length(n1) / length(n0)) << round;
  }
}

TEST(EndDelta, does_not_depend_on_rotation_or_size) {
  Random random(4);
  for (int round = 0; round < 500; ++round) {
    const ControlNormals n = triangle(random, 1);
    const EndDelta found = best_end_delta(n);
    // A permutation of the axes is a rotation without rounding, and a power of two is a scale without rounding. But
    // sums are added in another order, so the search may end at a slightly different scale.
    const auto turned = [](const Vec3d& v) { return Vec3d{0x1p-40 * v.y, 0x1p-40 * v.z, 0x1p-40 * v.x}; };
    const EndDelta other = best_end_delta({turned(n.n0), turned(n.m), turned(n.n1)});
    EXPECT_NEAR(other.error, found.error, 2e-3 * found.error + 1e-12) << round;
    if (found.error < 90 * kDegree) {
      EXPECT_NEAR(std::log(other.scale / found.scale), 0, 0.05) << round;
    }
  }
}

TEST(EndDelta, time_reversal_inverts_the_scale) {
  Random random(5);
  for (int round = 0; round < 500; ++round) {
    const ControlNormals n = triangle(random, 1);
    const EndDelta found = best_end_delta(n), back = best_end_delta({n.n1, n.m, n.n0});
    EXPECT_NEAR(back.error, found.error, 3e-3 * found.error + 1e-12) << round;
  }
}

TEST(EndDelta, zero_ends_stand_for_their_limits) {
  const Vec3d x{1, 0, 0}, y{0, 1, 0};
  // n(w) = 2 w (1-w) x + w^2 y has the same directions as the straight line from x to y / 2, so best_end_delta() finds
  // a scale without error.
  const EndDelta from_zero = best_end_delta({{}, x, y});
  EXPECT_NEAR(from_zero.scale, 0.5, 1e-9);
  EXPECT_LT(from_zero.error, 1e-9);
  EXPECT_NEAR(from_zero.delta.x, -1, 1e-12);
  EXPECT_NEAR(from_zero.delta.y, 0.5, 1e-9);
  const EndDelta to_zero = best_end_delta({x, y, {}});
  EXPECT_NEAR(to_zero.scale, 2, 1e-9);
  EXPECT_LT(to_zero.error, 1e-9);
  // If only the middle control normal is not zero, n(w) has a single direction.
  const EndDelta middle = best_end_delta({{}, y, {}});
  EXPECT_EQ(middle.delta, Vec3d{});
  EXPECT_EQ(middle.error, 0);
  // best_end_delta() also accepts control normals that are all zero.
  const EndDelta nothing = best_end_delta({});
  EXPECT_EQ(nothing.delta, Vec3d{});
  EXPECT_EQ(nothing.scale, 1);
  EXPECT_EQ(nothing.error, 0);
  EXPECT_EQ(largest_line_error({}, x, y), 0);
}

TEST(EndDelta, equal_and_antipodal_ends_keep_their_size) {
  const Vec3d x{1, 0, 0}, y{0, 1, 0};
  const EndDelta equal = best_end_delta({x, y, 3.0 * x});
  EXPECT_EQ(equal.scale, 1);
  EXPECT_EQ(equal.delta, Vec3d{});
  // n(w) = ((1-w)^2 + 3 w^2, 2 w (1-w), 0). With v = 1 - w, the error is the atan of 2 w v / (v^2 + 3 w^2), which is at
  // most atan(1 / sqrt(3)).
  EXPECT_NEAR(equal.error, 30 * kDegree, 0.03 * kDegree);

  const EndDelta antipodal = best_end_delta({x, y, -x});
  EXPECT_EQ(antipodal.scale, 1);
  EXPECT_EQ(antipodal.delta, -2.0 * x);
  EXPECT_NEAR(antipodal.error, 90 * kDegree, 0.1 * kDegree);
}

TEST(EndDelta, a_normal_that_turns_to_its_antipode_is_off_by_90_degrees_or_more) {
  // n(w) = (1 - 2 w) (1, w, 0) is zero at w = 1/2. Just before w = 1/2 and just after it, n(w) has opposite directions.
  const EndDelta found = best_end_delta({{1, 0, 0}, {0, 0.5, 0}, {-1, -1, 0}});
  EXPECT_GE(found.error, 89 * kDegree);
  EXPECT_TRUE(std::isfinite(found.scale));
}

TEST(EndDelta, errors_of_lines_are_found_wherever_they_are) {
  Random random(6);
  for (int round = 0; round < 2000; ++round) {
    // If the motion is strong, some normals turn fast. If the lengths of the two end normals differ much, the straight
    // line between them turns fast near an end.
    const ControlNormals normals = triangle(random, random.uniform(0, 30));
    const Vec3d from = unit(normals.n0), to = std::exp(random.uniform(-9, 9)) * unit(normals.n1);
    const auto expected = static_cast<double>(brute_error(normals, real(from), real(to), 1000));
    const double found = largest_line_error(normals, from, to);
    EXPECT_GE(found, 0.998 * expected) << round;
    EXPECT_LE(found, 1.02 * expected) << round;  // the grid may miss the exact maximum
  }
}

TEST(EndDelta, a_line_that_turns_fast_near_an_end_is_seen_there) {
  const ControlNormals normals{{8, 9, -9}, {7, 2, -6}, {1, 2, -1}};
  const Vec3d to = 0x1p-8 * normals.n1;
  const auto expected = static_cast<double>(brute_error(normals, real(normals.n0), real(to), 3000));
  EXPECT_NEAR(largest_line_error(normals, normals.n0, to), expected, 2e-3 * expected);
}

// Checks the average errors in the table of docs/theory.md, section 4.8.
TEST(EndDelta, it_helps_where_areas_change) {
  struct Row {
    const char* morph;
    double unit_ends, best;  // mean errors in degrees: with unit normals at both ends, and with the best scale of one
  };
  for (const Row& row :
       {Row{"cloth", 2.34, 0.36}, {"bend", 4.41, 4.01}, {"twist", 9.58, 8.76}, {"eversion", 69.1, 68.3}}) {
    const Result<Motion> motion = make_builtin_morph(row.morph);
    ASSERT_TRUE(motion.ok());
    double unit_ends = 0, best = 0, count = 0;
    for (std::size_t s = 0; s < motion.value().segments.size(); ++s) {
      const std::vector<ControlNormals> faces = all_face_control_normals(motion.value().segment(s));
      for (std::size_t f = 0; f < faces.size(); f += 7, ++count) {
        unit_ends +=
            largest_line_error(faces[f], unit_normal_at(faces[f], 0).vector, unit_normal_at(faces[f], 1).vector);
        best += best_end_delta(faces[f]).error;
      }
    }
    EXPECT_NEAR(unit_ends / count / kDegree, row.unit_ends, 0.03 * row.unit_ends) << row.morph;
    EXPECT_NEAR(best / count / kDegree, row.best, 0.03 * row.best) << row.morph;
  }
}

}  // namespace
}  // namespace chronormal::end_delta_test
