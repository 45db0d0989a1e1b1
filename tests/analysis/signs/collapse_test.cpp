// Compares the times at which faces collapse (have no area) with the exact roots of polynomials whose coefficients are
// integers of any size.

#include "chronormal/analysis/signs.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "tests/support/exact_cases.h"
#include "tests/support/fixtures.h"
#include "tests/support/whole_polynomial.h"

namespace chronormal::collapse_test {
namespace {

using test::WholePolynomial;

// Returns the components of n(t) as polynomials, computed from positions alone.
std::array<WholePolynomial, 3> normal_polynomials(const Segment& segment, std::size_t face) {
  const auto vertices = segment.topology->face(face);
  std::array<test::WholeVector, 4> values;
  for (const long t : {-1L, 0L, 1L, 2L}) {
    values[static_cast<std::size_t>(t + 1)] = test::whole_normal(segment, vertices, t);
  }
  const auto component = [&](std::size_t k) {
    return WholePolynomial::through(values[0][k], values[1][k], values[2][k], values[3][k]);
  };
  return {component(0), component(1), component(2)};
}

bool is_unit(const Vec3d& v) { return std::fabs(length(v) - 1) < 1e-14; }

// Tells whether the components of a direction have the signs of the components of n(t). Components of the direction
// that are almost zero do not count.
bool points_along(const Vec3d& direction, const std::array<WholePolynomial, 3>& n, double t) {
  const std::array<double, 3> components{direction.x, direction.y, direction.z};
  for (std::size_t k = 0; k < 3; ++k) {
    if (std::fabs(components[k]) > 1e-6 && components[k] * n[k].sign_at(t) < 0) return false;
  }
  return true;
}

bool has_signs(const Vec3d& v, const std::array<int, 3>& signs) {
  const auto sign = [](double x) { return static_cast<int>(x > 0) - static_cast<int>(x < 0); };
  return sign(v.x) == signs[0] && sign(v.y) == signs[1] && sign(v.z) == signs[2];
}

std::string fault_of(const Collapses& found, const std::array<WholePolynomial, 3>& n) {
  const WholePolynomial common =
      WholePolynomial::greatest_common_divisor(n[0], WholePolynomial::greatest_common_divisor(n[1], n[2]));
  if (common.is_zero()) return found.always && found.count == 0 ? "" : "zero throughout";
  if (found.always) return "not zero throughout";
  const std::size_t roots = common.count_roots();
  std::size_t inside = 0;
  for (const Collapse& one : found.instants()) {
    const bool is_double = one.lower == one.upper;
    if (is_double && common.sign_at(one.lower) != 0) return "no zero at a double";
    if (!is_double && std::nextafter(one.lower, 2.0) != one.upper && one.lower != 0) return "no neighbours";
    inside += is_double ? 1 : common.count_roots(one.lower, one.upper);
    const bool starts = is_double && one.lower == 0, ends = is_double && one.upper == 1;
    const double low = starts      ? 0
                       : is_double ? std::nextafter(one.lower, 0.0)
                                   : one.lower,
                 high = ends        ? 1
                        : is_double ? std::nextafter(one.upper, 1.0)
                                    : one.upper;
    if (starts != (one.before == Vec3d{}) || ends != (one.after == Vec3d{})) return "a side that is not there";
    if ((!starts && !is_unit(one.before)) || (!ends && !is_unit(one.after))) return "length of a direction";
    const int before = common.sign_at(low), after = common.sign_at(high);
    if (!starts && !ends && before != 0 && after != 0) {
      if (one.turns_over != (before * after < 0)) return "turns over";
      if (length(one.turns_over ? one.before + one.after : one.before - one.after) > 1e-13) return "no opposites";
    }
    if ((starts || ends) && one.turns_over) return "turns over at an end";
    // If all components are multiples of one linear polynomial, n(t) has opposite directions on both sides of the root.
    // The direction of the derivative at the root is then the direction after it.
    const std::array<int, 3> slopes =
        common.is_linear()
            ? std::array<int, 3>{common.slope_at_root(n[0]), common.slope_at_root(n[1]), common.slope_at_root(n[2])}
            : std::array<int, 3>{};
    if (slopes != std::array<int, 3>{}) {
      if (!starts && !has_signs(one.before, {-slopes[0], -slopes[1], -slopes[2]})) return "direction before";
      if (!ends && !has_signs(one.after, slopes)) return "direction after";
      continue;
    }
    if (!starts && before != 0 && !points_along(one.before, n, low)) return "direction before";
    if (!ends && after != 0 && !points_along(one.after, n, high)) return "direction after";
  }
  // Two roots count as one root if no double is between them.
  return inside == roots ? "" : std::to_string(roots) + " zeros, found " + std::to_string(inside);
}

TEST(ExactCollapse, no_answer_is_wrong_in_any_family) {
  std::size_t collapsing = 0, turning = 0;
  const std::size_t wrong = test::judge_cases(815, [&](const Segment& segment, std::size_t face, test::Random&) {
    const Collapses found = find_collapses(segment, face);
    collapsing += found.count;
    for (const Collapse& one : found.instants()) turning += one.turns_over ? 1U : 0U;
    return fault_of(found, normal_polynomials(segment, face));
  });
  EXPECT_EQ(wrong, 0U);
  EXPECT_GT(collapsing, test::wanted_cases() / 10);
  EXPECT_GT(turning, test::wanted_cases() / 20);
}

TEST(Collapse, a_range_of_faces_has_those_that_collapse) {
  test::Random random(4);
  std::vector<test::MovingTriangle> triangles(500);
  for (auto& triangle : triangles)
    triangle = random.below(2) == 0 ? test::on_a_lattice(random) : test::ordinary(random);
  const Motion motion = test::soup_of(triangles);
  std::vector<ControlNormals> normals(400);
  face_control_normals(motion.segment(0), {50, 400}, normals);
  const std::vector<FaceCollapses> found = find_collapses(motion.segment(0), {50, 400}, normals);
  std::size_t next = 0;
  for (std::size_t f = 50; f < 450; ++f) {
    const Collapses alone = find_collapses(motion.segment(0), f);
    if (!alone.always && alone.count == 0) continue;
    ASSERT_LT(next, found.size());
    EXPECT_EQ(found[next].face, f);
    EXPECT_EQ(found[next].collapses.count, alone.count);
    EXPECT_EQ(found[next++].collapses.always, alone.always);
  }
  EXPECT_EQ(next, found.size());
  EXPECT_GT(next, 50U);
}

Collapses collapses_of(const std::vector<fixtures::Point>& from, const std::vector<fixtures::Point>& to) {
  const Motion motion = fixtures::make_motion(fixtures::make_soup(1), from, to);
  return find_collapses(motion.segment(0), 0);
}

TEST(Collapse, a_vertex_that_crosses_the_opposite_edge_turns_the_face_over_at_a_rational_instant) {
  // The z component of n(t) is 1 - 3 t, and the other components are zero.
  const Collapses found = collapses_of({{0, 0, 2}, {1, 0, 2}, {0, 1, 2}}, {{0, 0, 2}, {1, 0, 2}, {0, -2, 2}});
  ASSERT_EQ(found.count, 1U);
  const Collapse& one = found.at[0];
  EXPECT_LT(3 * static_cast<long double>(one.lower), 1);
  EXPECT_GT(3 * static_cast<long double>(one.upper), 1);
  EXPECT_EQ(std::nextafter(one.lower, 1.0), one.upper);
  EXPECT_TRUE(one.turns_over);
  EXPECT_EQ(one.before, (Vec3d{0, 0, 1}));
  EXPECT_EQ(one.after, (Vec3d{0, 0, -1}));
}

TEST(Collapse, a_face_that_shrinks_to_a_point_and_comes_back_does_not_turn_over) {
  const Collapses found = collapses_of({{1, 1, 0}, {-1, 2, 0}, {3, -1, 1}}, {{-1, -1, 0}, {1, -2, 0}, {-3, 1, -1}});
  ASSERT_EQ(found.count, 1U);
  EXPECT_EQ(found.at[0].lower, 0.5);
  EXPECT_EQ(found.at[0].upper, 0.5);
  EXPECT_FALSE(found.at[0].turns_over);
  EXPECT_EQ(found.at[0].before, found.at[0].after);
}

TEST(Collapse, one_unit_in_the_last_place_beside_the_line_is_no_collapse) {
  const std::vector<fixtures::Point> from{{0, 0, 0}, {1, 0, 0}, {0.5, 1, 0}};
  EXPECT_EQ(collapses_of(from, {{0, 0, 0}, {1, 0, 0}, {0.5, -1, 0}}).count, 1U);
  // At both ends, corner c is 2^-149 (the smallest float) above the plane z = 0, so the face never collapses.
  const std::vector<fixtures::Point> beside{{0, 0, 0}, {1, 0, 0}, {0.5, 1, 0x1p-149}};
  EXPECT_EQ(collapses_of(beside, {{0, 0, 0}, {1, 0, 0}, {0.5, -1, 0x1p-149}}).count, 0U);
}

TEST(Collapse, a_face_that_begins_or_ends_without_area_collapses_there) {
  const Collapses first = collapses_of({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  ASSERT_EQ(first.count, 1U);
  EXPECT_EQ(first.at[0].upper, 0);
  EXPECT_EQ(first.at[0].before, Vec3d{});
  EXPECT_EQ(first.at[0].after, (Vec3d{0, 0, 1}));
  EXPECT_FALSE(first.at[0].turns_over);
  const Collapses last = collapses_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}});
  ASSERT_EQ(last.count, 1U);
  EXPECT_EQ(last.at[0].lower, 1);
  EXPECT_EQ(last.at[0].after, Vec3d{});
}

TEST(Collapse, a_line_that_stays_a_line_has_no_area_always) {
  const Collapses found = collapses_of({{0, 0, 0}, {1, 2, 3}, {2, 4, 6}}, {{1, 1, 1}, {2, 1, 1}, {5, 1, 1}});
  EXPECT_EQ(found.count, 2U) << "the edges are parallel at both ends, and not between";
  const Collapses always = collapses_of({{0, 0, 0}, {1, 2, 3}, {2, 4, 6}}, {{0, 0, 0}, {2, 4, 6}, {1, 2, 3}});
  EXPECT_TRUE(always.always);
  EXPECT_EQ(always.count, 0U);
}

}  // namespace
}  // namespace chronormal::collapse_test
