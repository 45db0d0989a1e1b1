// Tests properties of the normals of vertices and corners that theory proves, and degenerate normals.

#include "chronormal/normals/normal_groups.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "chronormal/normals/normal_curves.h"
#include "tests/support/elements.h"
#include "tests/support/fixtures.h"
#include "tests/support/reference_elements.h"

namespace chronormal::group_normals_test {
namespace {

using fixtures::Point;

NormalGroups vertices_of(const Motion& motion) {
  return NormalGroups::of_vertices(motion.topology, separate_points(motion.topology.vertex_count()));
}

std::vector<ControlNormals> vertex_controls(const Motion& motion) {
  return all_group_control_normals(motion.segment(0), vertices_of(motion));
}

std::vector<Vec3f> unit_normals(const std::vector<ControlNormals>& normals, double t, std::size_t* zeros = nullptr) {
  std::vector<float> packed(3 * normals.size());
  const auto view = VectorView<float>::packed(packed.data(), normals.size());
  const std::size_t count = NormalCurves(normals).unit_normals(t, view);
  if (zeros != nullptr) *zeros = count;
  std::vector<Vec3f> result;
  for (std::size_t i = 0; i < normals.size(); ++i) result.push_back(view[i]);
  return result;
}

double largest(const ControlNormals& c) { return std::max({max_abs(c.n0), max_abs(c.m), max_abs(c.n1)}); }

ControlNormals difference(const ControlNormals& a, const ControlNormals& b) {
  return {a.n0 - b.n0, a.m - b.m, a.n1 - b.n1};
}

// Compares the normal of every element with the normal that the oracle computes, at several times. Returns the largest
// angle between the two normals, in radians. Skips elements whose terms cancel by a factor of more than 1e6.
double largest_error(const Motion& motion, const NormalGroups& groups, const std::string& weighting = "area") {
  const reference::Mesh mesh = test::reference_mesh(motion.segment(0));
  const auto corners = test::reference_corners(mesh, groups);
  const auto controls = all_group_control_normals(motion.segment(0), groups);
  double worst = 0;
  for (const double t : {0.0, 0.13, 0.5, 0.77, 1.0}) {
    const auto found = unit_normals(controls, t);
    for (std::size_t e = 0; e < groups.size(); ++e) {
      const auto expected = reference::element_normal(mesh, corners[e], weighting, t);
      reference::Real terms = 0;
      for (const auto& corner : corners[e])
        terms += reference::length(reference::contribution(mesh, corner, weighting, t));
      if (!(reference::length(expected) > 1e-6L * terms)) continue;
      worst = std::max(worst, static_cast<double>(reference::angle(test::to_real(found[e]), expected)));
    }
  }
  return worst;
}

Motion any_mesh(double distance, std::uint64_t seed, bool of_polygons) {
  return fixtures::shaken(of_polygons ? fixtures::box_grid(3) : fixtures::icosphere(1), distance, seed);
}

// ---- accuracy of the normals of vertices and corners ----------------------------------------------------------------

RC_GTEST_PROP(GroupNormals, vertices_and_corners_equal_recomputing_at_every_t_within_1e_6_rad, ()) {
  const auto seed = *rc::gen::arbitrary<std::uint64_t>();
  const Motion motion = any_mesh(*rc::gen::element(0.01, 0.3, 2.0), seed, *rc::gen::arbitrary<bool>());
  RC_ASSERT(largest_error(motion, vertices_of(motion)) < 1e-6);
  const Points points = separate_points(motion.topology.vertex_count());
  RC_ASSERT(largest_error(motion, NormalGroups::by_crease_angle(motion, points, 40).value()) < 1e-6);
}

RC_GTEST_PROP(GroupNormals, a_range_of_elements_has_the_bits_that_it_has_in_all, ()) {
  const Motion motion = any_mesh(0.5, *rc::gen::arbitrary<std::uint64_t>(), true);
  const NormalGroups groups = vertices_of(motion);
  const auto all = all_group_control_normals(motion.segment(0), groups);
  const auto first = *rc::gen::inRange<std::size_t>(0, all.size());
  const auto count = *rc::gen::inRange<std::size_t>(0, all.size() - first + 1);
  std::vector<ControlNormals> part(count);
  group_control_normals(groups, all_face_control_normals(motion.segment(0)), {first, count}, part);
  RC_ASSERT(std::equal(part.begin(), part.end(), all.begin() + static_cast<std::ptrdiff_t>(first)));
}

// ---- theorems about the normals of vertices and corners -------------------------------------------------------------

RC_GTEST_PROP(GroupNormals, triangles_give_each_vertex_their_normal_so_a_closed_mesh_sums_to_zero, ()) {
  const auto seed = *rc::gen::arbitrary<std::uint64_t>();
  ControlNormals sum;
  double size = 0;
  for (const ControlNormals& c : vertex_controls(any_mesh(1, seed, false))) {
    sum = sum + c;
    size += largest(c);
  }
  RC_ASSERT(largest(sum) <= 64 * 0x1p-53 * size);
}

RC_GTEST_PROP(GroupNormals, scale_by_a_power_of_two_gives_its_square_bit_for_bit, ()) {
  const auto seed = *rc::gen::arbitrary<std::uint64_t>();
  const Motion motion = any_mesh(1, seed, *rc::gen::arbitrary<bool>());
  const int exponent = *rc::gen::inRange(-20, 21);
  const double scale = std::ldexp(1.0, exponent), square = scale * scale;
  const auto before = vertex_controls(motion);
  const auto after = vertex_controls(test::with_positions(motion, [scale](const Point& p) {
    return Point{scale * p[0], scale * p[1], scale * p[2]};
  }));
  for (std::size_t e = 0; e < before.size(); ++e) {
    RC_ASSERT(after[e] == (ControlNormals{square * before[e].n0, square * before[e].m, square * before[e].n1}));
  }
}

RC_GTEST_PROP(GroupNormals, any_scale_gives_its_square, ()) {
  const Motion motion = any_mesh(1, *rc::gen::arbitrary<std::uint64_t>(), *rc::gen::arbitrary<bool>());
  const double s = *rc::gen::inRange(1, 1000) / 37.0;
  const auto before = vertex_controls(motion);
  const auto after = vertex_controls(test::with_positions(motion, [s](const Point& p) {
    return Point{s * p[0], s * p[1], s * p[2]};
  }));
  for (std::size_t e = 0; e < before.size(); ++e) {
    const ControlNormals expected{s * s * before[e].n0, s * s * before[e].m, s * s * before[e].n1};
    RC_ASSERT(largest(difference(after[e], expected)) <= s * s * 1e-4);  // scaled positions are rounded to float32
  }
}

RC_GTEST_PROP(GroupNormals, a_rotation_by_quarter_turns_rotates_them_bit_for_bit, ()) {
  // The map from (x, y, z) to (z, -x, -y) is a cyclic permutation of the axes, followed by a half turn about x. This
  // rotation causes no rounding errors.
  const Motion motion = any_mesh(1, *rc::gen::arbitrary<std::uint64_t>(), *rc::gen::arbitrary<bool>());
  const auto turned = [](const Vec3d& v) { return Vec3d{v.z, -v.x, -v.y}; };
  const auto before = vertex_controls(motion);
  const auto after = vertex_controls(test::with_positions(motion, [](const Point& p) {
    return Point{p[2], -p[0], -p[1]};
  }));
  for (std::size_t e = 0; e < before.size(); ++e) {
    RC_ASSERT(after[e] == (ControlNormals{turned(before[e].n0), turned(before[e].m), turned(before[e].n1)}));
  }
}

RC_GTEST_PROP(GroupNormals, time_reversal_swaps_the_ends_bit_for_bit, ()) {
  Motion motion = any_mesh(1, *rc::gen::arbitrary<std::uint64_t>(), *rc::gen::arbitrary<bool>());
  const auto before = vertex_controls(motion);
  std::swap(motion.keyframes[0].positions, motion.keyframes[1].positions);
  const auto after = vertex_controls(motion);
  for (std::size_t e = 0; e < before.size(); ++e) {
    RC_ASSERT(after[e].n0 == before[e].n1 && after[e].n1 == before[e].n0);
    RC_ASSERT(max_abs(after[e].m - before[e].m) <= 64 * 0x1p-53 * largest(before[e]));
  }
}

RC_GTEST_PROP(GroupNormals, shuffled_faces_give_the_same_bits, ()) {
  const auto seed = *rc::gen::arbitrary<std::uint64_t>();
  Motion motion = any_mesh(1, seed, *rc::gen::arbitrary<bool>());
  // Every face occurs twice in the new mesh. The first copies of the faces are in random order, and their lists of
  // corners begin with another corner.
  auto order = test::shuffled_order(motion.topology.face_count(), seed);
  const std::size_t face_count = order.size();
  for (std::size_t i = 0; i < face_count; ++i) order.push_back(i);
  motion = test::with_faces_in_order(motion, order);
  std::vector<std::uint32_t> offsets = {0}, corners;
  for (std::size_t f = 0; f < motion.topology.face_count(); ++f) {
    std::vector<std::uint32_t> face(motion.topology.face(f).begin(), motion.topology.face(f).end());
    if (f < face_count) std::rotate(face.begin(), face.begin() + 1, face.end());
    corners.insert(corners.end(), face.begin(), face.end());
    offsets.push_back(static_cast<std::uint32_t>(corners.size()));
  }
  motion.topology = fixtures::make_polygons(motion.topology.vertex_count(), offsets, corners);

  const auto shuffle = test::shuffled_order(motion.topology.face_count(), seed + 1);
  const Motion shuffled = test::with_faces_in_order(motion, shuffle);
  RC_ASSERT(vertex_controls(shuffled) == vertex_controls(motion));

  // Face i of the shuffled mesh is face shuffle[i] of the original mesh.
  const Points points = separate_points(motion.topology.vertex_count());
  const double degrees = *rc::gen::inRange(0, 90);
  const auto a = NormalGroups::by_crease_angle(motion, points, degrees).value();
  const auto b = NormalGroups::by_crease_angle(shuffled, points, degrees).value();
  const auto of_a = all_group_control_normals(motion.segment(0), a);
  const auto of_b = all_group_control_normals(shuffled.segment(0), b);
  std::size_t corner = 0;
  for (const std::size_t f : shuffle) {
    const auto face = motion.topology.face(f);
    const auto first = static_cast<std::size_t>(face.data() - motion.topology.corners().data());
    for (std::size_t i = 0; i < face.size(); ++i, ++corner)
      RC_ASSERT(of_b[b.element_of_corner()[corner]] == of_a[a.element_of_corner()[first + i]]);
  }
}

RC_GTEST_PROP(GroupNormals, a_welded_seam_shows_the_same_bits_on_every_copy, ()) {
  const Motion whole = any_mesh(0.5, *rc::gen::arbitrary<std::uint64_t>(), *rc::gen::arbitrary<bool>());
  const Motion cut = test::torn(whole);
  const NormalGroups groups = NormalGroups::of_vertices(cut.topology, weld_coincident(cut));
  RC_ASSERT(groups.size() == whole.topology.vertex_count());
  const NormalCurves curves(all_group_control_normals(cut.segment(0), groups));
  const std::size_t copies = cut.topology.vertex_count();
  std::vector<float> of_elements(3 * groups.size()), of_vertices(3 * copies);
  (void)curves.unit_normals(0.3, VectorView<float>::packed(of_elements.data(), groups.size()));
  groups.copy_to_outputs(VectorView<const float>::packed(of_elements.data(), groups.size()),
                         VectorView<float>::packed(of_vertices.data(), copies));
  const auto expected = unit_normals(vertex_controls(whole), 0.3);
  std::vector<std::array<float, 3>> seen(whole.topology.vertex_count());
  for (std::size_t c = 0; c < copies; ++c) {
    const std::uint32_t vertex = whole.topology.corners()[c];
    const std::array<float, 3> shown = {of_vertices[3 * c], of_vertices[3 * c + 1], of_vertices[3 * c + 2]};
    if (seen[vertex] == std::array<float, 3>{}) seen[vertex] = shown;
    RC_ASSERT(std::memcmp(shown.data(), seen[vertex].data(), sizeof shown) == 0);
    const auto angle =
        reference::angle(reference::Vector{shown[0], shown[1], shown[2]}, test::to_real(expected[vertex]));
    RC_ASSERT(angle < 1e-6L);
  }
}

TEST(GroupNormals, near_and_far_from_the_origin_within_2e_6_rad_of_the_truth_of_the_same_positions) {
  for (const double offset : {0.0, 1e3, -2e3}) {
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
      const Motion motion = test::with_positions(any_mesh(0.3, seed, seed == 2), [offset](const Point& p) {
        return Point{p[0] + offset, p[1] - 2 * offset, p[2] + offset / 3};
      });
      EXPECT_LT(largest_error(motion, vertices_of(motion)), 2e-6) << offset;
    }
  }
}

// ---- degenerate normals ---------------------------------------------------------------------------------------------

TEST(GroupNormals, isolated_vertices_are_zero_and_counted) {
  const Motion motion =
      test::still(fixtures::make_triangles(5, {0, 1, 2}), {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {4, 4, 4}, {5, 5, 5}});
  std::size_t zeros = 0;
  const auto normals = unit_normals(vertex_controls(motion), 0.5, &zeros);
  EXPECT_EQ(zeros, 2u);
  EXPECT_EQ(normals[0], (Vec3f{0, 0, 1}));
  EXPECT_EQ(normals[3], (Vec3f{0, 0, 0}));
  EXPECT_EQ(vertices_of(motion).isolated_count(), 2u);
}

TEST(GroupNormals, faces_without_area_add_nothing) {
  const Motion motion = test::still(fixtures::make_triangles(5, {0, 1, 2, 0, 1, 1, 1, 3, 2, 0, 0, 0, 4, 0, 1}),
                                    {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.5, 0.5, 0}, {2, 0, 0}});
  const auto controls = vertex_controls(motion);
  EXPECT_EQ(controls[0].n0, (Vec3d{0, 0, 1}));
  EXPECT_EQ(controls[1].n0, (Vec3d{0, 0, 1}));
  EXPECT_EQ(controls[4].n0, (Vec3d{0, 0, 0})) << "its only face is a line";
}

TEST(GroupNormals, duplicate_faces_count_as_often_as_they_are_there_and_opposite_ones_cancel) {
  const std::vector<Point> points = {{0.1, 0.7, 0.2}, {1.3, 0.1, -0.4}, {0.3, 1.9, 0.6}};
  const auto one = vertex_controls(test::still(fixtures::make_triangles(3, {0, 1, 2}), points));
  const auto two = vertex_controls(test::still(fixtures::make_triangles(3, {0, 1, 2, 0, 1, 2}), points));
  EXPECT_EQ(two[1].n0, 2.0 * one[1].n0);
  // The two faces are the two sides of a sheet, but begin with different corners. Their normals must add up to exactly
  // zero, and not to a rounding error that has a direction.
  for (const std::vector<std::uint32_t>& other : {std::vector<std::uint32_t>{0, 2, 1}, {2, 1, 0}, {1, 0, 2}}) {
    std::vector<std::uint32_t> corners = {0, 1, 2};
    corners.insert(corners.end(), other.begin(), other.end());
    Motion sheet = test::still(fixtures::make_triangles(3, corners), points);
    for (float& p : sheet.keyframes[1].positions) p = p * p + 0.3F;
    std::size_t zeros = 0;
    (void)unit_normals(vertex_controls(sheet), 0.4, &zeros);
    EXPECT_EQ(zeros, 3u);
  }
}

TEST(GroupNormals, a_vertex_of_two_fans_is_the_sum_of_both_and_its_corners_are_not) {
  const Motion bow = test::still(fixtures::make_triangles(5, {0, 1, 2, 0, 3, 4}),
                                 {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 2, 0}, {0, 0, 1}});
  EXPECT_EQ(vertex_controls(bow)[0].n0, (Vec3d{2, 0, 1}));
  const auto corners = NormalGroups::by_crease_angle(bow, separate_points(5), 180).value();
  const auto controls = all_group_control_normals(bow.segment(0), corners);
  EXPECT_EQ(controls[corners.element_of_corner()[0]].n0, (Vec3d{0, 0, 1}));
  EXPECT_EQ(controls[corners.element_of_corner()[3]].n0, (Vec3d{2, 0, 0}));
}

TEST(GroupNormals, a_polygon_with_two_corners_at_a_point_counts_with_both) {
  // A square has a slit from a corner to its middle. In the polygon, vertex 4 in the middle occurs once, and vertex 0
  // at the corner twice.
  const Motion slit = test::still(fixtures::make_polygons(5, {0, 6}, {0, 1, 2, 3, 0, 4}),
                                  {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {0, 0, 0}});
  const auto controls = vertex_controls(slit);
  EXPECT_EQ(controls[4].n0, (Vec3d{0, 0, 8}));
  EXPECT_EQ(controls[0].n0, (Vec3d{0, 0, 16}));
}

}  // namespace
}  // namespace chronormal::group_normals_test
