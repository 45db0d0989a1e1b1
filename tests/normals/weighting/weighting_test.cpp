// Tests weighted normals at one time: compares each weighting with its definition, and tests the contributions of
// degenerate faces.

#include "chronormal/normals/weighting.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "chronormal/normals/normal_groups.h"
#include "tests/support/cpu_time.h"
#include "tests/support/elements.h"
#include "tests/support/fixtures.h"
#include "tests/support/hard_motions.h"
#include "tests/support/integer_normal.h"
#include "tests/support/reference_elements.h"

namespace chronormal::weighting_test {
namespace {

using fixtures::Point;

constexpr double kQuarter = 1.5707963267948966;

NormalGroups vertices_of(const Motion& motion) {
  return NormalGroups::of_vertices(motion.topology, separate_points(motion.topology.vertex_count()));
}

std::vector<Vec3d> weighted(const Motion& motion, Weighting weighting, double t = 0) {
  return all_weighted_normals_at(motion.segment(0), vertices_of(motion), weighting, t);
}

void expect_near(const Vec3d& found, const Vec3d& expected, double tolerance = 1e-12) {
  EXPECT_NEAR(found.x, expected.x, tolerance);
  EXPECT_NEAR(found.y, expected.y, tolerance);
  EXPECT_NEAR(found.z, expected.z, tolerance);
}

// ---- names of weightings --------------------------------------------------------------------------------------------

TEST(Weighting, names_lead_there_and_back) {
  for (const WeightingInfo& info : kAllWeightings) {
    EXPECT_EQ(make_weighting(info.name).value(), info.weighting);
    EXPECT_EQ(weighting_name(info.weighting), info.name);
  }
  const auto unknown = make_weighting("areal");
  ASSERT_FALSE(unknown.ok());
  EXPECT_EQ(unknown.error().code, ErrorCode::kUsage);
  EXPECT_EQ(unknown.error().text(),
            "there is no weighting 'areal'; choose one of area, angle, uniform, area-angle, max, "
            "inverse-edges, inverse-roots");
}

// ---- the definitions of weightings ----------------------------------------------------------------------------------

TEST(Weighting, at_the_corner_of_a_box_of_unequal_sides) {
  // Quads of 2 x 1, 1 x 3 and 3 x 2 meet at the origin. Their edges along x, y and z have the lengths 2, 1 and 3, and
  // their normals point outwards.
  const Motion corner = test::still(fixtures::make_polygons(7, {0, 4, 8, 12}, {0, 2, 4, 1, 0, 3, 5, 2, 0, 1, 6, 3}),
                                    {{0, 0, 0}, {2, 0, 0}, {0, 1, 0}, {0, 0, 3}, {2, 1, 0}, {0, 1, 3}, {2, 0, 3}});
  const double xy = 2, yz = 3, zx = 6;  // areas of the quads; xy is the area of the quad perpendicular to z
  expect_near(weighted(corner, Weighting::kArea)[0], {-2 * yz, -2 * zx, -2 * xy});
  expect_near(weighted(corner, Weighting::kUniform)[0], {-1, -1, -1});
  expect_near(weighted(corner, Weighting::kAngle)[0], {-kQuarter, -kQuarter, -kQuarter});
  expect_near(weighted(corner, Weighting::kAreaAngle)[0], {-2 * yz * kQuarter, -2 * zx * kQuarter, -2 * xy * kQuarter});
  expect_near(weighted(corner, Weighting::kMax)[0], {-1 / 3.0, -1 / 6.0, -1 / 2.0});
  expect_near(weighted(corner, Weighting::kInverseEdges)[0], {-1 / 3.0, -1 / 6.0, -1 / 2.0});
  expect_near(weighted(corner, Weighting::kInverseRoots)[0], {-1 / std::sqrt(3), -1 / std::sqrt(6), -1 / std::sqrt(2)});
}

TEST(Weighting, max_is_exact_on_a_sphere) {
  // By Nelson Max's theorem, his weighting gives the exact normal of a sphere for every fan of triangles around a point
  // on the sphere, even for an irregular fan.
  fixtures::Random random(5);
  for (int round = 0; round < 100; ++round) {
    std::vector<Point> points = {{0, 0, 1}};
    std::vector<std::uint32_t> corners;
    for (std::uint32_t i = 0; i < 6; ++i) {
      const double around = (i + random.uniform(0, 0.9)) * 1.0471975511965976, down = random.uniform(0.2, 1.4);
      points.push_back({std::sin(down) * std::cos(around), std::sin(down) * std::sin(around), std::cos(down)});
      corners.insert(corners.end(), {0, 1 + i, 1 + (i + 1) % 6});
    }
    const Motion fan = test::still(fixtures::make_triangles(7, corners), points);
    EXPECT_LT(angle_between(weighted(fan, Weighting::kMax)[0], {0, 0, 1}), 1e-5);
  }
}

RC_GTEST_PROP(Weighting, equals_the_definition_at_every_t, ()) {
  const auto seed = *rc::gen::arbitrary<std::uint64_t>();
  const bool of_polygons = *rc::gen::arbitrary<bool>();
  const Motion motion = fixtures::shaken(of_polygons ? fixtures::box_grid(2) : fixtures::icosphere(1),
                                         *rc::gen::element(0.02, 0.5, 2.0), seed);
  const reference::Mesh mesh = test::reference_mesh(motion.segment(0));
  const NormalGroups groups = vertices_of(motion);
  const auto corners = test::reference_corners(mesh, groups);
  const double t = *rc::gen::inRange(0, 65) / 64.0;
  for (const WeightingInfo& info : kAllWeightings) {
    const auto found = weighted(motion, info.weighting, t);
    for (std::size_t e = 0; e < groups.size(); ++e) {
      reference::Real size = 0;
      for (const auto& corner : corners[e])
        size += reference::length(reference::contribution(mesh, corner, std::string(info.name), t));
      const auto expected = reference::element_normal(mesh, corners[e], std::string(info.name), t);
      RC_ASSERT(reference::length(reference::subtract(test::to_real(found[e]), expected)) <= 1e-9L * size);
    }
  }
}

RC_GTEST_PROP(Weighting, area_is_the_sum_of_quadratics, ()) {
  const Motion motion = fixtures::shaken(fixtures::box_grid(3), 0.5, *rc::gen::arbitrary<std::uint64_t>());
  const double t = *rc::gen::inRange(0, 65) / 64.0;
  const auto found = weighted(motion, Weighting::kArea, t);
  const auto controls = all_group_control_normals(motion.segment(0), vertices_of(motion));
  for (std::size_t e = 0; e < found.size(); ++e)
    RC_ASSERT(max_abs(found[e] - normal_at(controls[e], t)) <= 1e-13 * (1 + max_abs(found[e])));
}

RC_GTEST_PROP(Weighting, shuffled_faces_give_the_same_bits, ()) {
  const auto seed = *rc::gen::arbitrary<std::uint64_t>();
  const Motion motion = fixtures::shaken(fixtures::box_grid(3), 0.5, seed);
  const Motion shuffled = test::with_faces_in_order(motion, test::shuffled_order(motion.topology.face_count(), seed));
  for (const WeightingInfo& info : kAllWeightings)
    RC_ASSERT(weighted(shuffled, info.weighting, 0.3) == weighted(motion, info.weighting, 0.3));
}

// The library decides by a criterion without units whether double is accurate enough, so it treats a face of any size
// in the same way.
TEST(Weighting, slivers_of_any_size_have_the_same_normal) {
  constexpr std::uint64_t kSeed = 20261126;
  fixtures::Random random(kSeed);
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  for (int i = 0; i < 1000; ++i) {
    Motion motion{Topology::triangles(3, {0, 1, 2}).value(), std::vector<Motion::Keyframe>(2), {}};
    for (std::size_t k = 0; k < 2; ++k) {
      // The three corners are on a line, except for the last digits of the third corner.
      std::array<float, 3> a{}, b{};
      for (auto* const point : {&a, &b})
        for (float& x : *point) x = static_cast<float>(random.uniform(-1, 1));
      Motion::Keyframe& keyframe = motion.keyframes[k];
      keyframe.time = static_cast<double>(k);
      for (const float share : {0.0F, 1.0F, 0.3F})
        for (std::size_t axis = 0; axis < 3; ++axis)
          keyframe.positions.push_back(a[axis] + share * (b[axis] - a[axis]));
    }
    motion.connect_as_sequence();
    const double t = random.below(2) == 0 ? 0 : 1;
    Vec3d n, scaled;
    face_normals_at(motion.segment(0), t, {0, 1}, std::span(&n, 1));
    for (const int power : {-30, 30}) {
      Motion other = motion;
      for (Motion::Keyframe& keyframe : other.keyframes)
        for (float& x : keyframe.positions) x = std::ldexp(x, power);
      face_normals_at(other.segment(0), t, {0, 1}, std::span(&scaled, 1));
      EXPECT_EQ(scaled, std::ldexp(1.0, 2 * power) * n) << "case " << i << ", 2^" << power;
    }
  }
}

// Returns the angle, in radians, between two vectors of any length.
double angle_to(const Vec3d& u, const std::array<double, 3>& n) {
  const Vec3d v{n[0], n[1], n[2]};
  const Vec3d a = (1 / max_abs(u)) * u, b = (1 / max_abs(v)) * v;
  return std::atan2(length(cross(a, b)), dot(a, b));
}

// In double, the normals of the faces in this test are only rounding error, so the library computes their directions in
// integers.
TEST(Weighting, normals_of_hard_faces_are_those_of_whole_numbers) {
  constexpr std::uint64_t kSeed = 49100;
  constexpr double kMost = 0x1p-29;
  const auto& families = test::hard_motions();
  for (std::size_t k = 0; k < families.size(); ++k) {
    fixtures::Random random(kSeed + k);
    std::size_t wrong = 0, faces = 0;
    double worst = 0;
    for (int round = 0; round < 40; ++round) {
      const Motion motion = families[k].make(random);
      const Segment segment = motion.segment(0);
      for (const double t : {0.0, 1.0, 0.5, random.uniform(0, 1)}) {
        std::vector<Vec3d> found(motion.topology.face_count());
        face_normals_at(segment, t, {0, found.size()}, found);
        const auto expected = test::IntegerNormals(segment).at(test::IntegerTime::of(t));
        for (std::size_t f = 0; f < found.size(); ++f, ++faces) {
          const bool has_normal = !test::is_zero(expected[f]), is_found = found[f] != Vec3d{};
          const double angle = has_normal && is_found ? angle_to(found[f], test::direction_of(expected[f])) : 0;
          wrong += has_normal == is_found && angle <= kMost ? 0U : 1U;
          worst = std::fmax(worst, angle);
        }
      }
    }
    EXPECT_EQ(wrong, 0u) << families[k].name << ": of " << faces << " faces from seed " << kSeed + k << ", worst "
                         << worst << " rad";
  }
}

// In integers, the computation takes twenty times as long as in double, so the library must use integers only for faces
// that need them.
TEST(Weighting, ordinary_faces_cost_a_fifth_of_what_faces_on_lines_cost) {
  constexpr std::size_t kFaces = 20000;
  const Motion ordinary = fixtures::moderate_soup(kFaces),
               hard = fixtures::degenerate_soup(fixtures::Shape::kLine, fixtures::Shape::kLine, kFaces);
  std::vector<Vec3d> normals(kFaces);
  const auto compute = [&](const Motion& motion) {
    ASSERT_EQ(motion.topology.face_count(), kFaces);
    face_normals_at(motion.segment(0), 0, {0, kFaces}, normals);
  };
  test::expect_growth(
      0.2, 0, [&] { compute(hard); }, [&] { compute(ordinary); });
}

TEST(Weighting, polygons_count_as_polygons_and_not_as_their_triangles) {
  // At a corner of a cube made of quads, every weighting gives a symmetric normal. If the quads were cut into
  // triangles, the normal would not be symmetric.
  const fixtures::ClosedMesh cube = fixtures::box_grid(1);
  const Motion motion = test::still(cube.topology, cube.points);
  for (const WeightingInfo& info : kAllWeightings) {
    const auto normals = weighted(motion, info.weighting);
    for (std::size_t v = 0; v < normals.size(); ++v) {
      const Vec3d outwards{cube.points[v][0], cube.points[v][1], cube.points[v][2]};
      EXPECT_LT(angle_between(normals[v], outwards), 1e-7) << info.name;
    }
  }
}

// ---- degenerate faces -----------------------------------------------------------------------------------------------

TEST(Weighting, faces_without_area_add_nothing_whatever_the_weighting) {
  const std::vector<Point> points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.5, 0.5, 0}, {0.7, 0, 0}, {0.1, 0.3, 0.9}};
  const Motion plain = test::still(fixtures::make_triangles(6, {0, 1, 2}), points);
  // The additional faces of the second mesh add nothing: their corners are on a line or nearly on a line, or they
  // repeat a vertex once or twice.
  const Motion more = test::still(fixtures::make_triangles(6, {0, 1, 2, 0, 4, 1, 1, 1, 2, 0, 0, 0, 1, 3, 2}), points);
  for (const WeightingInfo& info : kAllWeightings) {
    const auto expected = weighted(plain, info.weighting), found = weighted(more, info.weighting);
    for (std::size_t v = 0; v < 3; ++v) EXPECT_EQ(found[v], expected[v]) << info.name;
    for (std::size_t v = 3; v < 6; ++v) EXPECT_EQ(found[v], Vec3d{}) << info.name;
  }
}

TEST(Weighting, a_corner_at_an_edge_without_length_adds_nothing_by_angle) {
  // The quad has two vertices at the same position.
  const Motion motion =
      test::still(fixtures::make_polygons(4, {0, 4}, {0, 1, 2, 3}), {{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  for (const Weighting weighting : {Weighting::kAngle, Weighting::kAreaAngle, Weighting::kMax, Weighting::kInverseEdges,
                                    Weighting::kInverseRoots}) {
    EXPECT_EQ(weighted(motion, weighting)[1], Vec3d{});
    EXPECT_GT(weighted(motion, weighting)[0].z, 0);
  }
  EXPECT_EQ(weighted(motion, Weighting::kUniform)[1], (Vec3d{0, 0, 1}));
}

TEST(Weighting, a_corner_at_an_edge_without_length_takes_nothing_from_the_faces_around_it) {
  // The edge of the quad from vertex 1 to vertex 2 has length zero. This edge is one of the two edges at corner 1, and
  // one of the two edges at corner 2.
  const std::vector<Point> points = {{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 3, 2}};
  const Motion alone = test::still(fixtures::make_triangles(5, {1, 4, 3, 2, 4, 0}), points);
  const Motion both = test::still(fixtures::make_polygons(5, {0, 3, 6, 10}, {1, 4, 3, 2, 4, 0, 0, 1, 2, 3}), points);
  for (const Weighting weighting : {Weighting::kAngle, Weighting::kAreaAngle, Weighting::kMax, Weighting::kInverseEdges,
                                    Weighting::kInverseRoots}) {
    const auto expected = weighted(alone, weighting), found = weighted(both, weighting);
    for (const std::size_t v : {std::size_t{1}, std::size_t{2}}) {
      EXPECT_GT(max_abs(expected[v]), 0.1);
      EXPECT_EQ(found[v], expected[v]) << weighting_name(weighting) << ", vertex " << v;
    }
  }
}

TEST(Weighting, both_sides_of_a_sheet_cancel_to_zero) {
  Motion sheet = test::still(fixtures::make_triangles(3, {0, 1, 2, 2, 1, 0}),
                             {{0.1, 0.7, 0.2}, {1.3, 0.1, -0.4}, {0.3, 1.9, 0.6}});
  for (float& p : sheet.keyframes[1].positions) p = p * p + 0.3F;
  for (const WeightingInfo& info : kAllWeightings) {
    for (const Vec3d& n : weighted(sheet, info.weighting, 0.37)) EXPECT_EQ(n, Vec3d{}) << info.name;
  }
}

TEST(Weighting, a_duplicate_face_adds_twice) {
  const std::vector<Point> points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const Motion motion = test::still(fixtures::make_triangles(4, {0, 1, 2, 0, 1, 2, 0, 2, 3}), points);
  expect_near(weighted(motion, Weighting::kUniform)[0], {1, 0, 2});
  expect_near(weighted(motion, Weighting::kAngle)[0], {kQuarter, 0, 2 * kQuarter});
}

TEST(Weighting, extreme_sizes_neither_overflow_nor_vanish) {
  for (const double size : {1e-30, 1e30}) {
    const Motion motion = test::still(fixtures::make_triangles(3, {0, 1, 2}), {{0, 0, 0}, {size, 0, 0}, {0, size, 0}});
    for (const WeightingInfo& info : kAllWeightings)
      expect_near(unit(weighted(motion, info.weighting, 0.5)[0]), {0, 0, 1}, 1e-15);
  }
}

// Compares weighted normals with eq. 19 of docs/theory.md, which is about two triangles that share an edge. One of the
// two triangles rests.
TEST(Weighting, is_along_what_the_theory_says_of_two_triangles) {
  Motion motion{Topology::triangles(4, {0, 1, 2, 1, 0, 3}).value(), std::vector<Motion::Keyframe>(2), {}};
  motion.keyframes[0] = {{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, -1, 0}, 0, {}};
  motion.keyframes[1] = {{0, 0, 0, 1, 0, 0, 0, 1, 1, 0, -1, 0}, 1, {}};
  motion.connect_as_sequence();
  for (const double t : {0.0, 0.25, 0.5, 1.0}) {
    const double r = std::sqrt(1 + t * t);
    const auto slope = [&](Weighting weighting, std::size_t vertex) {
      const Vec3d n = weighted(motion, weighting, t)[vertex];
      EXPECT_NEAR(n.x, 0, 1e-15);
      return n.y / n.z;
    };
    EXPECT_NEAR(slope(Weighting::kArea, 0), -t / 2, 1e-14);
    EXPECT_NEAR(slope(Weighting::kUniform, 0), -t / (1 + r), 1e-14);
    EXPECT_NEAR(slope(Weighting::kAngle, 0), -t / (1 + r), 1e-14);
    EXPECT_NEAR(slope(Weighting::kAreaAngle, 1), -t / (1 + std::numbers::pi / (4 * std::atan(r))), 1e-14);
    EXPECT_NEAR(slope(Weighting::kMax, 0), -t / (2 + t * t), 1e-14);
  }
}

}  // namespace
}  // namespace chronormal::weighting_test
