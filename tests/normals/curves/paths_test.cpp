// Motions of degree 2 and 3: their normals against the cross product of the curves, and cut into straight pieces.

#include "chronormal/normals/paths.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <vector>

#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"
#include "tests/support/curved_motion.h"
#include "tests/support/elements.h"
#include "tests/support/fixtures.h"
#include "tests/support/reference_elements.h"

namespace chronormal::paths_test {
namespace {

using reference::Real;
using reference::Vector;

// Random vectors, one for each vertex.
std::vector<float> vectors(std::size_t count, double size, fixtures::Random& random) {
  std::vector<float> result;
  for (std::size_t i = 0; i < 3 * count; ++i) result.push_back(static_cast<float>(random.uniform(-size, size)));
  return result;
}

VectorView<const float> view(const std::vector<float>& packed) {
  return VectorView<const float>::packed(packed.data(), packed.size() / 3);
}

Vector at(const std::vector<float>& packed, std::size_t v) {
  return {packed[3 * v], packed[3 * v + 1], packed[3 * v + 2]};
}

// A mesh of quads that accelerates for 2 seconds, and one that moves as cubics for 1.5.
struct Moving {
  Topology topology = fixtures::box_grid(2).topology;
  std::vector<float> positions, velocities, other, other_velocities;

  explicit Moving(std::uint64_t seed) {
    fixtures::Random random(seed);
    for (const auto& p : fixtures::box_grid(2).points) {
      for (const double c : p) positions.push_back(static_cast<float>(c));
    }
    const std::size_t count = topology.vertex_count();
    velocities = vectors(count, 0.4, random);
    other = vectors(count, 0.5, random);
    other_velocities = vectors(count, 0.6, random);
  }

  [[nodiscard]] PolynomialSegment<2> accelerated() const {
    return accelerated_segment(topology, view(positions), view(velocities), view(other), 1, 3);
  }
  [[nodiscard]] PolynomialSegment<3> hermite() const {
    return hermite_segment(topology, view(positions), view(velocities), view(other), view(other_velocities), 0, 1.5);
  }

  // The mesh at t, by the formulas of the textbook, as one that stands still.
  [[nodiscard]] reference::Mesh accelerated_at(Real t) const {
    return mesh_of([&](std::size_t v) {
      const Real s = 2 * t;
      return reference::add(at(positions, v), reference::add(reference::scaled(s, at(velocities, v)),
                                                             reference::scaled(s * s / 2, at(other, v))));
    });
  }
  [[nodiscard]] reference::Mesh hermite_at(Real t) const {
    return mesh_of([&](std::size_t v) {
      const Real t2 = t * t, t3 = t2 * t, d = 1.5L;
      const Vector ends = reference::add(reference::scaled(2 * t3 - 3 * t2 + 1, at(positions, v)),
                                         reference::scaled(-2 * t3 + 3 * t2, at(other, v)));
      const Vector tangents = reference::add(reference::scaled(d * (t3 - 2 * t2 + t), at(velocities, v)),
                                             reference::scaled(d * (t3 - t2), at(other_velocities, v)));
      return reference::add(ends, tangents);
    });
  }

  template <class Position>
  [[nodiscard]] reference::Mesh mesh_of(Position position) const {
    reference::Mesh mesh;
    for (std::size_t f = 0; f < topology.face_count(); ++f)
      mesh.faces.emplace_back(topology.face(f).begin(), topology.face(f).end());
    for (std::size_t v = 0; v < topology.vertex_count(); ++v) mesh.from.push_back(position(v));
    mesh.to = mesh.from;
    return mesh;
  }
};

template <std::size_t K>
std::vector<PolynomialNormals<K>> face_normals(const PolynomialSegment<K>& segment) {
  std::vector<PolynomialNormals<K>> normals(segment.topology->face_count());
  polynomial_face_normals<K>(segment, {0, normals.size()}, normals);
  return normals;
}

// Faces and vertices at t against the mesh at t; returns the largest angle, radians.
template <std::size_t K>
double largest_error(const PolynomialSegment<K>& segment, const reference::Mesh& mesh, double t) {
  const auto of_faces = face_normals(segment);
  const NormalGroups groups =
      NormalGroups::of_vertices(*segment.topology, separate_points(segment.topology->vertex_count()));
  std::vector<PolynomialNormals<K>> of_groups(groups.size());
  polynomial_group_normals<K>(groups, of_faces, {0, groups.size()}, of_groups);
  const auto corners = test::reference_corners(mesh, groups);
  double worst = 0;
  for (std::size_t f = 0; f < of_faces.size(); ++f) {
    const auto angle =
        reference::angle(test::to_real(unit_normal_at(of_faces[f], t).vector), reference::vector_area(mesh, f, 0));
    worst = std::max(worst, static_cast<double>(angle));
  }
  for (std::size_t e = 0; e < groups.size(); ++e) {
    const auto angle = reference::angle(test::to_real(unit_normal_at(of_groups[e], t).vector),
                                        reference::element_normal(mesh, corners[e], "area", 0));
    worst = std::max(worst, static_cast<double>(angle));
  }
  return worst;
}

RC_GTEST_PROP(PolynomialMotion, faces_and_vertices_equal_recomputing_at_every_t, ()) {
  const Moving moving(*rc::gen::arbitrary<std::uint64_t>());
  const double t = *rc::gen::inRange(0, 129) / 128.0;
  RC_ASSERT(largest_error(moving.accelerated(), moving.accelerated_at(t), t) < 1e-9);
  RC_ASSERT(largest_error(moving.hermite(), moving.hermite_at(t), t) < 1e-9);
}

TEST(PolynomialMotion, degree_1_is_the_motion_on_straight_lines) {
  const Motion motion = fixtures::shaken(fixtures::box_grid(2), 0.5, 3);
  const Segment straight = motion.segment(0);
  PolynomialSegment<1> segment;
  segment.topology = &motion.topology;
  for (std::size_t v = 0; v < motion.topology.vertex_count(); ++v) {
    segment.control[0].push_back(to_double(straight.from[v]));
    segment.control[1].push_back(to_double(straight.to[v]));
  }
  const auto found = face_normals(segment);
  const auto expected = all_face_control_normals(straight);
  for (std::size_t f = 0; f < found.size(); ++f) {
    EXPECT_LT(max_abs(found[f][0] - expected[f].n0), 1e-14);
    EXPECT_LT(max_abs(found[f][1] - expected[f].m), 1e-14);
    EXPECT_LT(max_abs(found[f][2] - expected[f].n1), 1e-14);
  }
}

TEST(PolynomialMotion, without_curvature_higher_degrees_are_straight) {
  // Constant velocity: the middle control normals lie where raising the degree of a quadratic puts them.
  Moving moving(9);
  std::fill(moving.other.begin(), moving.other.end(), 0.0F);
  const auto found = face_normals(moving.accelerated());
  for (const auto& n : found) {
    const auto power = to_power(n);
    EXPECT_LT(max_abs(power.a[3]), 1e-12);
    EXPECT_LT(max_abs(power.a[4]), 1e-12);
  }
}

// ---- where the normal vanishes -------------------------------------------------------------------------------------

TEST(PolynomialMotion, zeros_have_the_limits_that_their_multiplicity_gives) {
  const Vec3d z{0, 0, 1};
  // (t - 1/2)^k z in degree 4, k = 1 ... 4.
  const auto zero_of = [&](std::size_t multiplicity) {
    Bernstein<double, 1> factor = {-0.5, 0.5};
    Power<double, 4> power{};
    power.a[0] = 1;
    for (std::size_t i = 0; i < multiplicity; ++i) {
      for (std::size_t k = 4; k > 0; --k) power.a[k] = power.a[k - 1] + factor[0] * power.a[k];
      power.a[0] *= factor[0];
    }
    const auto b = to_bernstein(power);
    std::array<Vec3d, 5> normals;
    for (std::size_t k = 0; k < 5; ++k) normals[k] = b[k] * z;
    return normals;
  };
  for (const std::size_t odd : {1U, 3U}) {
    const UnitNormal u = unit_normal_at(zero_of(odd), 0.5);
    EXPECT_EQ(u.direction, Direction::kDiscontinuous) << odd;
    EXPECT_EQ(u.vector, -z) << "from before";
  }
  for (const std::size_t even : {2U, 4U}) {
    const UnitNormal u = unit_normal_at(zero_of(even), 0.5);
    EXPECT_EQ(u.direction, Direction::kLimit) << even;
    EXPECT_EQ(u.vector, z);
  }
  const std::array<Vec3d, 5> ends = {Vec3d{}, Vec3d{}, z, z, Vec3d{}};
  EXPECT_EQ(unit_normal_at(ends, 0).direction, Direction::kLimit);
  EXPECT_EQ(unit_normal_at(ends, 0).vector, z);
  EXPECT_EQ(unit_normal_at(ends, 1).direction, Direction::kLimit);
  EXPECT_EQ(unit_normal_at(ends, 1).vector, z);
  EXPECT_EQ(unit_normal_at(std::array<Vec3d, 5>{}, 0.3).direction, Direction::kNone);
  EXPECT_EQ(unit_normal_at(std::array<Vec3d, 5>{}, 0.3).vector, Vec3d{});
}

TEST(PolynomialMotion, faces_without_area_have_zero_control_normals) {
  // Three vertices on the line along (3, 5, 7), which move along it; a third of a second rounds their positions.
  const Topology line = fixtures::make_triangles(3, {0, 1, 2});
  const auto along = [](std::initializer_list<float> places) {
    std::vector<float> points;
    for (const float place : places) points.insert(points.end(), {3 * place, 5 * place, 7 * place});
    return points;
  };
  const auto positions = along({11, 101, -37}), velocities = along({1, -13, 29}), accelerations = along({-5, 17, 3});
  const auto n =
      face_normals(accelerated_segment(line, view(positions), view(velocities), view(accelerations), 0, 1 / 3.0))[0];
  for (const Vec3d& control : n) EXPECT_EQ(control, Vec3d{});
  EXPECT_EQ(unit_normal_at(n, 0.4).direction, Direction::kNone);
}

// ---- cut -----------------------------------------------------------------------------------------------------------

template <std::size_t K, class At>
void expect_cut_within(const PolynomialSegment<K>& segment, double distance, At&& mesh_at) {
  const Motion motion = cut_into_segments(segment, distance).value();
  EXPECT_TRUE(validate(motion).ok());
  EXPECT_EQ(motion.keyframes.front().time, segment.start_time);
  EXPECT_EQ(motion.keyframes.back().time, segment.end_time);
  const std::size_t pieces = motion.segments.size();
  Real worst = 0;
  for (std::size_t s = 0; s < pieces; ++s) {
    const reference::Mesh piece = test::reference_mesh(motion.segment(s));
    for (const Real local : {0.1L, 0.5L, 0.9L}) {
      const reference::Mesh truth = mesh_at((static_cast<Real>(s) + local) / static_cast<Real>(pieces));
      for (std::size_t v = 0; v < truth.from.size(); ++v) {
        const Vector apart = reference::subtract(reference::position(piece, v, local), truth.from[v]);
        worst = std::max(worst, reference::length(apart));
      }
    }
  }
  EXPECT_LE(worst, distance + 1e-6);
  EXPECT_GT(worst, distance / 8) << "not many more pieces than it takes";
}

TEST(PolynomialMotion, a_cut_motion_stays_within_the_distance) {
  const Moving moving(12);
  for (const double distance : {0.1, 1e-2, 1e-3}) {
    expect_cut_within(moving.accelerated(), distance, [&](Real t) { return moving.accelerated_at(t); });
    expect_cut_within(moving.hermite(), distance, [&](Real t) { return moving.hermite_at(t); });
  }
}

TEST(PolynomialMotion, a_straight_motion_is_one_piece_and_one_too_curved_is_an_error) {
  Moving moving(1);
  EXPECT_EQ(cut_into_segments(moving.hermite(), 1e-12).error().code, ErrorCode::kUsage);
  EXPECT_EQ(cut_into_segments(moving.hermite(), 0).error().code, ErrorCode::kUsage);
  EXPECT_EQ(cut_into_segments(moving.hermite(), std::nan("")).error().code, ErrorCode::kUsage);
  std::fill(moving.other.begin(), moving.other.end(), 0.0F);
  EXPECT_EQ(cut_into_segments(moving.accelerated(), 1e-6).value().segments.size(), 1u);
}

// Keyframes of a motion that is a polynomial of some degree in time, at uneven times.
struct Sampled {
  static constexpr std::array<double, 6> kTimes = {0, 0.25, 1, 1.5, 1.75, 3};
  Topology topology = fixtures::box_grid(2).topology;
  std::vector<std::vector<Vec3d>> powers;
  std::vector<Motion::Keyframe> keyframes;

  Sampled(std::size_t degree, std::size_t count) {
    fixtures::Random random(degree);
    powers.resize(degree + 1);
    for (std::vector<Vec3d>& power : powers)
      for (std::size_t v = 0; v < topology.vertex_count(); ++v)
        power.push_back({random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
    for (std::size_t k = 0; k < count; ++k) {
      Motion::Keyframe& keyframe = keyframes.emplace_back();
      keyframe.time = kTimes[k];
      for (std::size_t v = 0; v < topology.vertex_count(); ++v) {
        const Vec3d p = at(v, kTimes[k]);
        for (const double c : {p.x, p.y, p.z}) keyframe.positions.push_back(static_cast<float>(c));
      }
    }
  }
  [[nodiscard]] Vec3d at(std::size_t v, double time) const {
    Vec3d sum;
    for (std::size_t k = powers.size(); k-- > 0;) sum = time * sum + powers[k][v];
    return sum;
  }
  // The largest distance from a curve through the keyframes, over all times.
  [[nodiscard]] double distance(bool at_keys = false) const {
    std::vector<const Motion::Keyframe*> keys;
    for (const Motion::Keyframe& keyframe : keyframes) keys.push_back(&keyframe);
    double most = 0;
    for (std::size_t i = 0; i + 1 < keys.size(); ++i) {
      const PolynomialSegment<3> curve = catmull_rom_segment(topology, keys, i);
      EXPECT_EQ(curve.start_time, keys[i]->time);
      EXPECT_EQ(curve.end_time, keys[i + 1]->time);
      for (const double t : at_keys ? std::vector<double>{0, 1} : std::vector<double>{0.2, 0.5, 0.9}) {
        const std::vector<Vec3d> positions = positions_at(curve, t);
        const double time = (1 - t) * keys[i]->time + t * keys[i + 1]->time;
        for (std::size_t v = 0; v < positions.size(); ++v) most = std::max(most, length(positions[v] - at(v, time)));
      }
    }
    return most;
  }
};

TEST(CatmullRom, goes_through_its_keys_and_follows_what_as_many_keys_can_tell) {
  EXPECT_LT(Sampled(1, 2).distance(), 1e-6) << "two keys: straight";
  EXPECT_LT(Sampled(2, 3).distance(), 3e-6);
  EXPECT_LT(Sampled(2, 6).distance(), 3e-6);
  EXPECT_LT(Sampled(5, 6).distance(true), 1e-4) << "at keys, whatever the motion";
  EXPECT_GT(Sampled(3, 6).distance(), 1e-3) << "a cubic is more than three keys say";
}

TEST(CatmullRom, leaves_an_end_as_the_cubic_through_four_keys) {
  const Sampled cubic(3, 4);
  std::vector<const Motion::Keyframe*> keys;
  for (const Motion::Keyframe& keyframe : cubic.keyframes) keys.push_back(&keyframe);
  const PolynomialSegment<3> first = catmull_rom_segment(cubic.topology, keys, 0);
  const double third = (first.end_time - first.start_time) / 3;
  for (std::size_t v = 0; v < cubic.topology.vertex_count(); ++v)
    EXPECT_LT(length((1 / third) * (first.control[1][v] - first.control[0][v]) - cubic.powers[1][v]), 1e-5);
}

TEST(PathKind, is_found_by_its_name) {
  for (const PathKind kind : {PathKind::kLinear, PathKind::kCatmullRom, PathKind::kHermite})
    EXPECT_EQ(make_path(path_name(kind)).value(), kind);
  EXPECT_EQ(make_path("hermit").error().code, ErrorCode::kUsage);
}

// The positions of all vertices at local t of a segment, in the order of Keyframe::positions.
std::vector<double> places(const Motion& motion, std::size_t s, PathKind kind, double t) {
  std::vector<double> result;
  for (const Vec3d& p : positions_at(path_segment(motion, s, kind), t))
    for (const double c : {p.x, p.y, p.z}) result.push_back(c);
  return result;
}

TEST(PathSegment, is_the_curve_of_the_textbook_with_or_without_velocities) {
  Motion motion = test::curved_motion({0, 0.2, 0.5, 0.6, 1}, 2, 6, 4);
  for (Motion::Keyframe& key : motion.keyframes)
    for (const float p : key.positions) key.velocities.push_back(3 * p - 0.5F);
  motion.keyframes[2].velocities.clear();
  for (std::size_t s = 0; s < 4; ++s) {
    for (const double t : {0.0, 0.3, 0.75, 1.0}) {
      for (const PathKind kind : {PathKind::kCatmullRom, PathKind::kHermite}) {
        const auto right = test::on_curve(motion, s, t, kind == PathKind::kHermite);
        const std::vector<double> found = places(motion, s, kind, t);
        for (std::size_t c = 0; c < found.size(); ++c)
          EXPECT_NEAR(found[c], static_cast<double>(right[c]), 1e-6) << s << ' ' << t << ' ' << path_name(kind);
      }
      const std::vector<double> straight = places(motion, s, PathKind::kLinear, t);
      for (std::size_t c = 0; c < straight.size(); ++c)
        EXPECT_NEAR(
            straight[c],
            (1 - t) * double{motion.keyframes[s].positions[c]} + t * double{motion.keyframes[s + 1].positions[c]},
            1e-12);
    }
  }
}

TEST(PathSegment, hermite_needs_a_velocity_and_curves_a_sequence) {
  Motion motion = test::curved_motion({0, 0.5, 1}, 1, 5, 3);
  EXPECT_TRUE(check_path(motion, PathKind::kLinear).ok());
  EXPECT_TRUE(check_path(motion, PathKind::kCatmullRom).ok());
  EXPECT_EQ(check_path(motion, PathKind::kHermite).error().code, ErrorCode::kUsage);
  motion.keyframes[1].velocities = motion.keyframes[1].positions;
  EXPECT_TRUE(check_path(motion, PathKind::kHermite).ok());
  motion.keyframes[1].velocities.pop_back();
  EXPECT_EQ(validate(motion).error().code, ErrorCode::kInvalidInput);
  motion.keyframes[1].velocities.push_back(std::nanf(""));
  EXPECT_EQ(validate(motion).error().code, ErrorCode::kInvalidInput);
  motion.keyframes[1].velocities.clear();
  for (Motion::Keyframe& key : motion.keyframes) key.time = key.time > 0 ? 1 : 0;
  motion.connect_as_targets();
  EXPECT_EQ(check_path(motion, PathKind::kCatmullRom).error().code, ErrorCode::kUsage);
}

TEST(PolynomialMotion, normals_at_a_time_are_those_of_the_control_normals) {
  const Moving moving(5);
  const PolynomialSegment<3> segment = moving.hermite();
  const auto controls = face_normals(segment);
  std::vector<Vec3d> found(controls.size());
  for (const double t : {0.0, 0.2, 0.9, 1.0}) {
    polynomial_face_normals_at(segment, t, {0, found.size()}, std::span(found));
    for (std::size_t f = 0; f < found.size(); ++f)
      EXPECT_LT(length(found[f] - evaluate(controls[f], t)), 1e-12 * (1 + length(found[f])));
  }
}

}  // namespace
}  // namespace chronormal::paths_test
