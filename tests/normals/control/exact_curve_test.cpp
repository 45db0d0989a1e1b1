// Compares exact curves with rational numbers, and tests motions in which n(t) = 0 at some time.

#include "normals/control/exact_curve.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "tests/support/exact_normal.h"
#include "tests/support/fixtures.h"
#include "tests/support/hard_motions.h"

namespace chronormal::exact_curve_test {
namespace {

exact::Triangle exact_triangle(const Segment& segment, std::size_t f) {
  exact::Triangle result;
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const Vec3f a = segment.from[segment.topology->face(f)[corner]], b = segment.to[segment.topology->face(f)[corner]];
    result.from[corner] = exact::vector(a.x, a.y, a.z);
    result.to[corner] = exact::vector(b.x, b.y, b.z);
  }
  return result;
}

void expect_rounded(const Vec3d& rounded, const exact::Vector& exact, const char* what) {
  const exact::Vector given = exact::vector(rounded.x, rounded.y, rounded.z);
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_LE(abs(given[k] - exact[k]), abs(exact[k]) * exact::Rational(0x1p-50)) << what;
}

TEST(ExactCurve, has_every_component_to_the_last_place) {
  fixtures::Random random(41);
  for (int i = 0; i < 400; ++i) {
    const Motion motion = test::soup_of({i % 2 == 0 ? test::mixed_scales(random) : test::collapsed_at_ends(random)});
    const Segment segment = motion.segment(0);
    const ExactCurve curve = ExactCurve::of_polygon(segment, segment.topology->face(0));
    const exact::Triangle triangle = exact_triangle(segment, 0);
    const exact::ControlNormals expected = exact::control_normals(triangle);
    const ControlNormals rounded = curve.rounded();
    expect_rounded(rounded.n0, expected.n0, "n0");
    expect_rounded(rounded.m, expected.m, "m");
    expect_rounded(rounded.n1, expected.n1, "n1");
    std::vector<std::int32_t> kept{7};
    curve.append_to(kept);
    for (const double t : {0.0, 1.0, 0.5, 1.0 / 3, 0x1p-200, 1 - 0x1p-53, random.uniform(0, 1)}) {
      const Vec3d n = curve.normal_at(t);
      expect_rounded(n, exact::normal_at(triangle, t), "n(t)");
      EXPECT_EQ(ExactCurve::of_kept(kept.data() + 1).normal_at(t), n);
    }
  }
}

// Compares control normals with exact control normals. The error of each control normal must be small relative to its
// own length, so that rounding errors never decide its direction. Tests the kernel for many faces, and the function for
// a single face.
TEST(FaceControlNormals, are_never_made_of_rounding) {
  fixtures::Random random(42);
  for (int i = 0; i < 40; ++i) {
    std::vector<test::MovingTriangle> triangles;
    for (int k = 0; k < 10; ++k) {
      triangles.push_back(test::mixed_scales(random));
      triangles.push_back(test::sliver_at_origin(random));
      triangles.push_back(test::collapsed_at_ends(random));
    }
    const Motion motion = test::soup_of(triangles);
    const Segment segment = motion.segment(0);
    std::vector<ControlNormals> together(triangles.size());
    face_control_normals(segment, {0, together.size()}, together);
    for (std::size_t f = 0; f < together.size(); ++f) {
      ControlNormals alone;
      face_control_normals(segment, {f, 1}, {&alone, 1});
      EXPECT_EQ(together[f], alone);
      const exact::ControlNormals expected = exact::control_normals(exact_triangle(segment, f));
      for (const auto& [given, right] :
           {std::pair{&alone.n0, &expected.n0}, std::pair{&alone.m, &expected.m}, std::pair{&alone.n1, &expected.n1}}) {
        const exact::Vector off = exact::subtract(exact::vector(given->x, given->y, given->z), *right);
        EXPECT_LE(exact::max_abs(off), exact::max_abs(*right) * exact::Rational(0x1p-26)) << "face " << f;
      }
    }
  }
}

TEST(ExactCurve, tells_a_moment_from_the_one_before) {
  // n(t) = (3 t - 1) z. Since 1/3 is not a double, the sign changes between two neighbouring doubles.
  const fixtures::Point o{0, 0, 0};
  const Motion motion = test::soup_of({{{o, {1, 0, 0}, {0, -1, 0}}, {o, {1, 0, 0}, {0, 2, 0}}}});
  const ExactCurve curve = ExactCurve::of_polygon(motion.segment(0), motion.topology.face(0));
  const double below = 1.0 / 3, above = std::nextafter(below, 1.0);
  EXPECT_EQ(curve.unit_normal_at(below).vector, (Vec3d{0, 0, -1}));
  EXPECT_EQ(curve.unit_normal_at(above).vector, (Vec3d{0, 0, 1}));
  EXPECT_EQ(curve.unit_normal_at(below).direction, Direction::kRegular);
}

TEST(ExactCurve, has_the_limit_where_n_is_zero) {
  const fixtures::Point o{0, 0, 0}, x{1, 0, 0}, y{0, 1, 0}, minus_y{0, -1, 0}, minus_x{-1, 0, 0};
  struct Case {
    test::MovingTriangle triangle;
    double t;
    Vec3d vector;
    Direction direction;
  };
  const std::vector<Case> cases{
      {{{o, x, minus_y}, {o, x, y}}, 0.5, {0, 0, -1}, Direction::kDiscontinuous},  // the face turns over
      {{{o, x, o}, {o, x, y}}, 0, {0, 0, 1}, Direction::kLimit},                   // the face opens
      {{{o, x, y}, {o, x, o}}, 1, {0, 0, 1}, Direction::kLimit},                   // the face closes
      {{{o, x, y}, {o, minus_x, minus_y}}, 0.5, {0, 0, 1}, Direction::kLimit},     // the face passes through a point
      {{{o, o, o}, {o, x, y}}, 0, {0, 0, 1}, Direction::kLimit},                   // the face grows out of a point
      {{{o, x, x}, {o, y, y}}, 0.25, {0, 0, 0}, Direction::kNone},                 // the face remains a line
  };
  for (const auto& [triangle, t, vector, direction] : cases) {
    const Motion motion = test::soup_of({triangle});
    const UnitNormal u = ExactCurve::of_polygon(motion.segment(0), motion.topology.face(0)).unit_normal_at(t);
    EXPECT_EQ(u.vector, vector) << t;
    EXPECT_EQ(u.direction, direction) << t;
  }
}

TEST(ExactCurve, adds_up_faces) {
  const Motion motion = fixtures::shaken(fixtures::icosphere(1), 0.3, 5);
  const Segment segment = motion.segment(0);
  std::vector<std::uint32_t> all;
  Vec3d sum;
  for (std::uint32_t f = 0; f < motion.topology.face_count(); ++f) {
    all.push_back(f);
    if (f % 3 == 0) sum = sum + ExactCurve::of_polygon(segment, motion.topology.face(f)).normal_at(0.25);
  }
  // The mesh is a closed surface, so the normals of all its faces add up to exactly zero.
  EXPECT_EQ(ExactCurve::of_faces(segment, all).unit_normal_at(0.3).direction, Direction::kNone);
  std::vector<std::uint32_t> some;
  for (std::uint32_t f = 0; f < all.size(); f += 3) some.push_back(f);
  EXPECT_LE(max_abs(ExactCurve::of_faces(segment, some).normal_at(0.25) - sum), 1e-14);
}

}  // namespace
}  // namespace chronormal::exact_curve_test
