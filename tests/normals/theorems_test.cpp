// Tests theorems about control normals. Each theorem is tested on random meshes.
//
// Most coordinates are multiples of 2^-8 between -128 and 128. Edges, their products, and sums of a few products are
// then exact in double, so theorems hold to the last bit. Tests with other coordinates state a tolerance.

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "chronormal/motion/motion.h"
#include "chronormal/normals/control_normals.h"
#include "chronormal/normals/normal_curves.h"
#include "tests/support/fixtures.h"

namespace chronormal::theorems_test {
namespace {

using fixtures::Point;

// ---- generators of random motions -----------------------------------------------------------------------------------

// Draws an integer in [-bound, bound]. In its first cases, rapidcheck draws from the low end of a range, and in later
// cases from more of the range. Here the low end stands for 0, so the first cases are degenerate and later cases are
// general.
rc::Gen<int> around_zero(int bound) {
  return rc::gen::map(rc::gen::inRange(0, 2 * bound + 1), [](int k) { return k % 2 == 0 ? k / 2 : -(k / 2) - 1; });
}

// Draws a coordinate that is a multiple of 2^-8 between -bound and bound.
rc::Gen<double> on_grid(int bound = 128) {
  return rc::gen::map(around_zero(256 * bound - 1), [](int k) { return k * 0x1p-8; });
}

rc::Gen<Point> grid_point(int bound = 128) { return rc::gen::container<Point>(on_grid(bound)); }

std::vector<Point> points(std::size_t count, int bound = 128) {
  return *rc::gen::container<std::vector<Point>>(count, grid_point(bound));
}

// Makes a motion of `face_count` triangles that share no vertices. Coordinates are multiples of 2^-8.
Motion grid_soup(std::size_t face_count = 3, int bound = 128) {
  return fixtures::make_motion(fixtures::make_soup(face_count), points(3 * face_count, bound),
                               points(3 * face_count, bound));
}

// Makes a motion of triangles at any place and of any size from 1e-6 to 1e6. Computations with their coordinates are
// not exact.
Motion any_soup(std::size_t face_count = 3) {
  const auto seed = *rc::gen::arbitrary<std::uint64_t>();
  const double size = std::pow(10, *around_zero(6));
  const double offset = size * *rc::gen::inRange(0, 100);
  return fixtures::soup({.face_count = face_count, .seed = seed, .size = size, .offset = offset});
}

// ---- measures of control normals and motions ------------------------------------------------------------------------

std::vector<ControlNormals> control_normals(const Motion& motion) {
  std::vector<ControlNormals> normals(motion.topology.face_count());
  face_control_normals(motion.segment(0), {0, normals.size()}, normals);
  return normals;
}

std::vector<Vec3f> unit_normals(const std::vector<ControlNormals>& normals, double t) {
  std::vector<float> packed(3 * normals.size());
  const auto view = VectorView<float>::packed(packed.data(), normals.size());
  (void)NormalCurves(normals).unit_normals(t, view);
  std::vector<Vec3f> result;
  for (std::size_t i = 0; i < normals.size(); ++i) result.push_back(view[i]);
  return result;
}

std::array<Vec3d, 3> coefficients(const ControlNormals& normals) { return {normals.n0, normals.m, normals.n1}; }

ControlNormals negated(const ControlNormals& normals) { return {-normals.n0, -normals.m, -normals.n1}; }

ControlNormals times_factor(double factor, const ControlNormals& normals) {
  return {factor * normals.n0, factor * normals.m, factor * normals.n1};
}

double largest(const ControlNormals& normals) {
  return std::max({max_abs(normals.n0), max_abs(normals.m), max_abs(normals.n1)});
}

// Returns the largest component of any edge of face f at t = 0 or t = 1.
double largest_edge(const Motion& motion, std::size_t f) {
  const Segment segment = motion.segment(0);
  const auto corners = motion.topology.face(f);
  double edge = 0;
  for (const auto& positions : {segment.from, segment.to}) {
    for (std::size_t i = 1; i < corners.size(); ++i) {
      edge = std::max(edge, max_abs(to_double(positions[corners[i]]) - to_double(positions[corners[0]])));
    }
  }
  return edge;
}

template <class Change>
Motion changed(Motion motion, Change&& change) {
  for (Motion::Keyframe& keyframe : motion.keyframes) {
    for (std::size_t i = 0; i < keyframe.positions.size(); i += 3) {
      float* const p = keyframe.positions.data() + i;
      const Point moved = change(Point{p[0], p[1], p[2]});
      for (std::size_t k = 0; k < 3; ++k) p[k] = static_cast<float>(moved[k]);
    }
  }
  return motion;
}

// Returns a copy of a motion in which the corners of every triangle are in the given order.
Motion reordered(const Motion& motion, const std::array<std::size_t, 3>& order) {
  std::vector<std::uint32_t> corners;
  for (std::size_t f = 0; f < motion.topology.face_count(); ++f) {
    for (const std::size_t i : order) corners.push_back(motion.topology.face(f)[i]);
  }
  Motion result = motion;
  result.topology = fixtures::make_triangles(motion.topology.vertex_count(), std::move(corners));
  return result;
}

// ---- the normal is perpendicular to the face ------------------------------------------------------------------------

RC_GTEST_PROP(Theorems, normals_are_perpendicular_to_both_edges_at_every_time, ()) {
  const Motion motion = any_soup(1);
  const ControlNormals normals = control_normals(motion)[0];
  const double t = *rc::gen::inRange(0, 1025) / 1024.0;
  const Segment segment = motion.segment(0);
  const Vec3d n = normal_at(normals, t);
  const auto at = [&](std::size_t i) { return lerp(to_double(segment.from[i]), to_double(segment.to[i]), t); };
  const double edge = largest_edge(motion, 0);
  const double position = std::max({max_abs(at(0)), max_abs(at(1)), max_abs(at(2))});
  // The test computes the positions of the vertices at t in double, with a relative rounding error of 2^-53.
  const double tolerance = 64 * 0x1p-53 * edge * edge * (edge + position);
  RC_ASSERT(std::fabs(dot(n, at(1) - at(0))) <= tolerance);
  RC_ASSERT(std::fabs(dot(n, at(2) - at(0))) <= tolerance);
}

// ---- the normals of closed meshes add up to zero --------------------------------------------------------------------

Motion snapped_to_grid(const Motion& motion) {
  return changed(motion, [](Point p) {
    for (double& c : p) c = std::nearbyint(c * 256) / 256;
    return p;
  });
}

RC_GTEST_PROP(Theorems, closed_mesh_normals_sum_to_zero_in_every_coefficient, ()) {
  const auto seed = *rc::gen::arbitrary<std::uint64_t>();
  const bool of_polygons = *rc::gen::arbitrary<bool>();
  const fixtures::ClosedMesh mesh = of_polygons ? fixtures::box_grid(3) : fixtures::icosphere(1);
  const Motion motion = fixtures::shaken(mesh, 1, seed);
  ControlNormals sum, exact_sum;
  double size = 0;
  for (const ControlNormals& normals : control_normals(motion)) {
    sum = sum + normals;
    size += largest(normals);
  }
  RC_ASSERT(largest(sum) <= 16 * 0x1p-53 * size);
  for (const ControlNormals& normals : control_normals(snapped_to_grid(motion))) exact_sum = exact_sum + normals;
  RC_ASSERT(exact_sum == ControlNormals{});
}

// ---- scaled, translated and rotated meshes --------------------------------------------------------------------------

RC_GTEST_PROP(Theorems, scaled_mesh_has_normals_times_the_square, ()) {
  const Motion motion = any_soup();
  const double scale = *rc::gen::inRange(1, 1000) / 37.0;
  const auto before = control_normals(motion);
  const Motion larger = changed(motion, [scale](Point p) {
    for (double& c : p) c *= scale;
    return p;
  });
  const auto after = control_normals(larger);
  const Segment segment = larger.segment(0);
  for (std::size_t f = 0; f < before.size(); ++f) {
    // Scaling the positions rounds them to float32 again, by a relative error of 2^-24.
    double position = 0;
    for (const auto& positions : {segment.from, segment.to}) {
      for (const auto vertex : larger.topology.face(f)) {
        position = std::max(position, max_abs(to_double(positions[vertex])));
      }
    }
    const double tolerance = 16 * 0x1p-24 * position * largest_edge(larger, f);
    const ControlNormals difference = after[f] + negated(times_factor(scale * scale, before[f]));
    RC_ASSERT(largest(difference) <= tolerance);
  }
}

RC_GTEST_PROP(Theorems, mesh_scaled_by_a_power_of_two_has_the_same_bits_but_for_the_exponent, ()) {
  const Motion motion = any_soup(12);
  const int exponent = *around_zero(30);
  const double scale = std::ldexp(1.0, exponent);
  const auto before = control_normals(motion);
  const auto after = control_normals(changed(motion, [scale](Point p) {
    for (double& c : p) c *= scale;
    return p;
  }));
  for (std::size_t f = 0; f < before.size(); ++f) {
    RC_ASSERT(after[f] == times_factor(scale * scale, before[f]));
    RC_ASSERT(degree(after[f]) == degree(before[f]));
  }
  for (const double t : {0.0, 0.3, 0.5, 1.0}) {
    RC_ASSERT(unit_normals(after, t) == unit_normals(before, t));
    for (std::size_t f = 0; f < before.size(); ++f) {
      RC_ASSERT(unit_normal_at(after[f], t).vector == unit_normal_at(before[f], t).vector);
    }
  }
}

RC_GTEST_PROP(Theorems, translated_mesh_has_the_same_normals_bit_for_bit, ()) {
  const Motion motion = grid_soup();
  // Translates the mesh by one vector at t = 0 and by another at t = 1. The coordinates remain multiples of 2^-8.
  const auto step0 = *grid_point(1000), step1 = *grid_point(1000);
  Motion moved = motion;
  for (std::size_t i = 0; i < moved.keyframes[0].positions.size(); ++i) {
    moved.keyframes[0].positions[i] += static_cast<float>(step0[i % 3]);
    moved.keyframes[1].positions[i] += static_cast<float>(step1[i % 3]);
  }
  RC_ASSERT(control_normals(moved) == control_normals(motion));
}

// The rotation by a quaternion of small integers, multiplied by the squared length of the quaternion, so that the
// matrix maps integers to integers.
using IntegerMatrix = std::array<std::array<int, 3>, 3>;

IntegerMatrix integer_rotation(int w, int x, int y, int z) {
  return {{{w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)},
           {2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)},
           {2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z}}};
}

template <class V>
Vec3d rotated(const IntegerMatrix& r, double divisor, const V& v) {
  const auto row = [&](std::size_t i) { return (r[i][0] * v[0] + r[i][1] * v[1] + r[i][2] * v[2]) / divisor; };
  return {row(0), row(1), row(2)};
}

RC_GTEST_PROP(Theorems, rigidly_moved_mesh_has_rotated_normals, ()) {
  const auto q = *rc::gen::suchThat(rc::gen::container<std::array<int, 4>>(around_zero(3)),
                                    [](const auto& c) { return c != std::array<int, 4>{}; });
  const int divisor = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  const IntegerMatrix r = integer_rotation(q[0], q[1], q[2], q[3]);
  // The coordinates are multiples of the divisor, so the coordinates after the rotation are integers, which float32
  // represents exactly.
  const Motion motion = changed(grid_soup(3, 4), [divisor](Point p) {
    for (double& c : p) c *= 256 * divisor;
    return p;
  });
  const auto step = *grid_point(16);
  const Motion moved = changed(motion, [&](const Point& p) {
    const Vec3d image = rotated(r, divisor, p);
    return Point{image.x + step[0], image.y + step[1], image.z + step[2]};
  });
  const auto before = control_normals(motion), after = control_normals(moved);
  for (std::size_t f = 0; f < before.size(); ++f) {
    const auto left = coefficients(after[f]), right = coefficients(before[f]);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d expected = rotated(r, divisor, Point{right[k].x, right[k].y, right[k].z});
      RC_ASSERT(max_abs(left[k] - expected) <= 16 * 0x1p-53 * max_abs(right[k]));
    }
  }
}

// ---- reversed and divided segments of time --------------------------------------------------------------------------

RC_GTEST_PROP(Theorems, reversed_motion_swaps_the_end_normals_and_keeps_the_middle, ()) {
  const Motion motion = any_soup();
  Motion reversed = motion;
  std::swap(reversed.keyframes[0].positions, reversed.keyframes[1].positions);
  const auto forwards = control_normals(motion), backwards = control_normals(reversed);
  for (std::size_t f = 0; f < forwards.size(); ++f) {
    RC_ASSERT(backwards[f] == (ControlNormals{forwards[f].n1, forwards[f].m, forwards[f].n0}));
  }
}

RC_GTEST_PROP(Theorems, split_segment_gives_the_same_curve, ()) {
  const Motion motion = grid_soup();
  Motion split = motion;  // two segments: from 0 to 1/2, and from 1/2 to 1
  Motion::Keyframe half = motion.keyframes[0];
  half.time = 0.5;
  for (std::size_t i = 0; i < half.positions.size(); ++i) {
    half.positions[i] = (half.positions[i] + motion.keyframes[1].positions[i]) / 2;  // exact: a multiple of 2^-9
  }
  split.keyframes.insert(split.keyframes.begin() + 1, half);
  split.segments.clear();
  split.connect_as_sequence();
  RC_ASSERT(split.segments.size() == 2U);
  const auto whole = control_normals(motion);
  std::vector<ControlNormals> first(whole.size()), second(whole.size());
  face_control_normals(split.segment(0), {0, first.size()}, first);
  face_control_normals(split.segment(1), {0, second.size()}, second);
  for (std::size_t f = 0; f < whole.size(); ++f) {
    // De Casteljau's algorithm at t = 1/2 gives the control normals of both halves.
    const Vec3d left = 0.5 * (whole[f].n0 + whole[f].m), right = 0.5 * (whole[f].m + whole[f].n1);
    const Vec3d middle = 0.5 * (left + right);
    RC_ASSERT(first[f] == (ControlNormals{whole[f].n0, left, middle}));
    RC_ASSERT(second[f] == (ControlNormals{middle, right, whole[f].n1}));
    for (const double s : {0.0, 0.2, 0.5, 0.9, 1.0}) {
      const double tolerance = 8 * 0x1p-53 * largest(whole[f]);
      RC_ASSERT(max_abs(normal_at(first[f], s) - normal_at(whole[f], s / 2)) <= tolerance);
      RC_ASSERT(max_abs(normal_at(second[f], s) - normal_at(whole[f], 0.5 + s / 2)) <= tolerance);
    }
  }
}

// ---- other orders of corners ----------------------------------------------------------------------------------------

RC_GTEST_PROP(Theorems, swapped_corners_negate_bit_for_bit, ()) {
  const Motion on_grid_motion = grid_soup(), motion = any_soup();
  const auto expect_negated = [](const Motion& one, const Motion& other) {
    const auto left = control_normals(one), right = control_normals(other);
    for (std::size_t f = 0; f < left.size(); ++f) RC_ASSERT(right[f] == negated(left[f]));
  };
  expect_negated(motion, reordered(motion, {0, 2, 1}));
  // If the order begins with another corner than corner 0, the library multiplies other edges. The bits are then the
  // same only if nothing is rounded.
  expect_negated(on_grid_motion, reordered(on_grid_motion, {1, 0, 2}));
  expect_negated(on_grid_motion, reordered(on_grid_motion, {2, 1, 0}));
}

RC_GTEST_PROP(Theorems, negated_normals_have_negated_directions_bit_for_bit, ()) {
  const Motion motion = any_soup(10);
  const auto normals = control_normals(motion);
  const auto turned = control_normals(reordered(motion, {0, 2, 1}));
  for (const double t : {0.0, 0.4, 1.0}) {
    const auto left = unit_normals(normals, t), right = unit_normals(turned, t);
    for (std::size_t f = 0; f < left.size(); ++f) RC_ASSERT(right[f] == -left[f]);
  }
}

RC_GTEST_PROP(Theorems, polygon_normals_are_the_sum_of_any_fan_of_their_triangles, ()) {
  const auto corner_count = *rc::gen::inRange<std::size_t>(3, 9);
  const auto from = points(corner_count), to = points(corner_count);
  const auto start = *rc::gen::inRange<std::size_t>(0, corner_count);
  std::vector<std::uint32_t> ring, fan;
  for (std::size_t i = 0; i < corner_count; ++i) {
    ring.push_back(static_cast<std::uint32_t>((start + i) % corner_count));
  }
  for (std::size_t i = 1; i + 1 < corner_count; ++i) fan.insert(fan.end(), {ring[0], ring[i], ring[i + 1]});
  const auto count = static_cast<std::uint32_t>(corner_count);
  std::vector<std::uint32_t> in_order(corner_count);
  for (std::uint32_t i = 0; i < count; ++i) in_order[i] = i;

  const auto polygon =
      control_normals(fixtures::make_motion(fixtures::make_polygons(corner_count, {0, count}, in_order), from, to));
  const auto turned =
      control_normals(fixtures::make_motion(fixtures::make_polygons(corner_count, {0, count}, ring), from, to));
  ControlNormals sum;
  for (const ControlNormals& normals :
       control_normals(fixtures::make_motion(fixtures::make_triangles(corner_count, fan), from, to))) {
    sum = sum + normals;
  }
  RC_ASSERT(polygon.size() == 1U);
  RC_ASSERT(polygon[0] == sum);
  RC_ASSERT(polygon == turned);
}

RC_GTEST_PROP(Theorems, polygon_of_three_corners_is_a_triangle_bit_for_bit, ()) {
  const Motion motion = any_soup(1);
  Motion mixed = motion;  // a quad in the mesh keeps the library from using its fast path for triangles
  mixed.topology = fixtures::make_polygons(3, {0, 3, 7}, {0, 1, 2, 0, 1, 2, 1});
  RC_ASSERT(control_normals(mixed)[0] == control_normals(motion)[0]);
}

// ---- the degree of n(t) ---------------------------------------------------------------------------------------------

// Returns the control normals of a triangle whose corners begin at `start` and move by `steps`.
ControlNormals moved_triangle(const std::array<Point, 3>& start, const std::array<Point, 3>& steps) {
  std::vector<Point> from(start.begin(), start.end()), to = from;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) to[i][k] += steps[i][k];
  }
  return control_normals(fixtures::make_motion(fixtures::make_soup(1), from, to))[0];
}

std::array<Point, 3> some_triangle() { return *rc::gen::container<std::array<Point, 3>>(grid_point()); }

RC_GTEST_PROP(Theorems, translated_face_has_degree_0, ()) {
  const auto step = *grid_point();
  RC_ASSERT(degree(moved_triangle(some_triangle(), {step, step, step})) == 0);
}

RC_GTEST_PROP(Theorems, face_of_which_two_vertices_move_alike_has_degree_1_at_most, ()) {
  const auto step = *grid_point(), other = *grid_point();
  const auto which = *rc::gen::inRange<std::size_t>(0, 3);
  std::array<Point, 3> steps{step, step, step};
  steps[which] = other;
  const ControlNormals normals = moved_triangle(some_triangle(), steps);
  RC_ASSERT(degree(normals) <= 1);
  RC_ASSERT(normals.m == 0.5 * (normals.n0 + normals.n1));
}

RC_GTEST_PROP(Theorems, face_whose_edges_change_in_parallel_has_degree_1_at_most, ()) {
  const auto step = *grid_point(), change = *grid_point(16);
  const int p = *around_zero(3), q = *around_zero(3);
  std::array<Point, 3> steps{step, step, step};
  for (std::size_t k = 0; k < 3; ++k) {
    steps[1][k] += p * change[k];
    steps[2][k] += q * change[k];
  }
  RC_ASSERT(degree(moved_triangle(some_triangle(), steps)) <= 1);
}

TEST(Theorems, degree_of_faces_made_for_it) {
  const std::array<Point, 3> face{Point{0, 0, 0}, Point{1, 0, 0}, Point{0, 1, 0}};
  const Point none{0, 0, 0};
  EXPECT_EQ(degree(moved_triangle(face, {none, none, none})), 0) << "stands still";
  EXPECT_EQ(degree(moved_triangle(face, {none, none, Point{0.5, 0, 0}})), 0) << "shear within the plane";
  EXPECT_EQ(degree(moved_triangle(face, {none, Point{0.5, 0, 0}, Point{1, 0, 0}})), 1) << "parallel, growing";
  EXPECT_EQ(degree(moved_triangle(face, {none, none, Point{0, 0, 1}})), 1) << "one vertex lifts";
  EXPECT_EQ(degree(moved_triangle(face, {none, Point{1, 0, 0}, Point{0, 1, 0}})), 2) << "grows in place";
  EXPECT_EQ(degree(moved_triangle(face, {none, Point{0, 0, 1}, Point{1, 0, 0}})), 2) << "general";
  EXPECT_EQ(degree(ControlNormals{}), 0) << "no normal at all";
}

RC_GTEST_PROP(Theorems, general_face_has_degree_2_where_its_edges_do_not_change_in_parallel, ()) {
  const auto start = some_triangle();
  const auto steps = *rc::gen::container<std::array<Point, 3>>(grid_point());
  const auto edge_change = [&](std::size_t i) {
    return Vec3d{steps[i][0] - steps[0][0], steps[i][1] - steps[0][1], steps[i][2] - steps[0][2]};
  };
  const Vec3d d = cross(edge_change(1), edge_change(2));  // exact, since coordinates are multiples of 2^-8
  const ControlNormals normals = moved_triangle(start, steps);
  // degree() treats a coefficient below 2^-28 of the largest control normal as zero, so such cases are skipped.
  RC_PRE(max_abs(d) > 0x1p-27 * largest(normals));
  RC_ASSERT(degree(normals) == 2);
  RC_ASSERT(normals.n0 + normals.n1 - 2 * normals.m == d);
}

}  // namespace
}  // namespace chronormal::theorems_test
