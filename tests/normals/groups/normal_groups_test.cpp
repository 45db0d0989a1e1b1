// Tests which corners share a normal. Tests small meshes made by hand, and compares random meshes with an oracle.

#include "chronormal/normals/normal_groups.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "tests/support/elements.h"
#include "tests/support/fixtures.h"
#include "tests/support/reference_elements.h"

namespace chronormal::normal_groups_test {
namespace {

using fixtures::make_polygons;
using fixtures::make_triangles;
using fixtures::Point;

using Elements = std::vector<std::uint32_t>;

Elements elements(const NormalGroups& groups) {
  const auto all = groups.element_of_corner();
  return {all.begin(), all.end()};
}

Points no_welding(const Motion& motion) { return separate_points(motion.topology.vertex_count()); }

NormalGroups creased(const Motion& motion, double degrees) {
  return NormalGroups::by_crease_angle(motion, no_welding(motion), degrees).value();
}

// Makes triangles around the z axis, like the pages of a book, at the given angles in degrees. All triangles share the
// edge from (0, 0, 0) to (0, 0, 1), whose vertices are 0 and 1. Corner 3 f + 2 of face f is its third point.
// Neighbouring faces pass the common edge in opposite directions, as on a surface.
Motion pages(const std::vector<double>& angles) {
  std::vector<Point> points = {{0, 0, 0}, {0, 0, 1}};
  std::vector<std::uint32_t> corners;
  for (std::size_t i = 0; i < angles.size(); ++i) {
    const double radians = angles[i] * 0.017453292519943295;
    points.push_back({std::cos(radians), std::sin(radians), 0.5});
    const auto tip = static_cast<std::uint32_t>(i + 2);
    if (i % 2 == 0)
      corners.insert(corners.end(), {0, 1, tip});
    else
      corners.insert(corners.end(), {1, 0, tip});
  }
  return test::still(make_triangles(points.size(), corners), points);
}

// ---- the partition of corners into groups ---------------------------------------------------------------------------

TEST(NormalGroups, the_example_of_the_header) {
  const Topology topology = make_triangles(5, {0, 1, 2, 2, 1, 3});
  const NormalGroups groups = NormalGroups::of_vertices(topology, separate_points(5));
  ASSERT_EQ(groups.size(), 5u);
  EXPECT_EQ(elements(groups), (Elements{0, 1, 2, 2, 1, 3}));
  EXPECT_EQ(std::vector<std::uint32_t>(groups.corners(1).begin(), groups.corners(1).end()), (Elements{1, 4}));
  EXPECT_EQ(std::vector<std::uint32_t>(groups.faces(1).begin(), groups.faces(1).end()), (Elements{0, 1}));
  EXPECT_TRUE(groups.corners(4).empty());
  EXPECT_EQ(groups.isolated_count(), 1u);
  EXPECT_TRUE(groups.outputs_are_vertices());
  EXPECT_EQ(groups.element_of_output().size(), 5u);
}

TEST(NormalGroups, no_faces_give_no_elements) {
  EXPECT_EQ(NormalGroups().size(), 0u);
  EXPECT_EQ(NormalGroups::of_vertices(Topology(), Points()).size(), 0u);
}

RC_GTEST_PROP(NormalGroups, every_corner_is_in_one_element_and_both_ways_agree, ()) {
  const auto seed = *rc::gen::arbitrary<std::uint64_t>();
  const Motion motion = fixtures::shaken(fixtures::box_grid(3), 0.5, seed);
  const NormalGroups groups = creased(motion, *rc::gen::inRange(0, 181));
  std::size_t listed = 0;
  for (std::size_t e = 0; e < groups.size(); ++e) {
    const auto corners = groups.corners(e), faces = groups.faces(e);
    RC_ASSERT(corners.size() == faces.size() && !corners.empty());
    for (std::size_t i = 0; i < corners.size(); ++i) {
      RC_ASSERT(groups.element_of_corner()[corners[i]] == e);
      const auto face = motion.topology.face(faces[i]);
      const std::uint32_t* const corner = motion.topology.corners().data() + corners[i];
      RC_ASSERT(face.data() <= corner && corner < face.data() + face.size());
    }
    listed += corners.size();
  }
  RC_ASSERT(listed == motion.topology.corner_count());
}

TEST(NormalGroups, copies_show_the_normal_of_their_element) {
  const Topology topology = make_triangles(4, {0, 1, 2});
  const NormalGroups groups = NormalGroups::of_vertices(topology, {{0, 1, 2, 1}, 3});
  const std::vector<float> of_elements = {1, 2, 3, 4, 5, 6, 7, 8, 9};
  std::vector<float> of_outputs(12);
  groups.copy_to_outputs(VectorView<const float>::packed(of_elements.data(), 3),
                         VectorView<float>::packed(of_outputs.data(), 4));
  EXPECT_EQ(of_outputs, (std::vector<float>{1, 2, 3, 4, 5, 6, 7, 8, 9, 4, 5, 6}));
}

// ---- groups by crease angle -----------------------------------------------------------------------------------------

TEST(CreaseAngle, an_edge_is_hard_above_it_and_smooth_at_it) {
  const Motion motion = pages({0, 150});  // the normals are 30 degrees apart
  EXPECT_EQ(elements(creased(motion, 29.9)), (Elements{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(elements(creased(motion, 30)), (Elements{0, 1, 2, 1, 0, 3}));
  EXPECT_EQ(elements(creased(motion, 180)), (Elements{0, 1, 2, 1, 0, 3}));
  const fixtures::ClosedMesh cube = fixtures::box_grid(1);
  const Motion box = test::still(cube.topology, cube.points);
  EXPECT_EQ(creased(box, 89).size(), 24u);
  EXPECT_EQ(creased(box, 90).size(), 8u);
}

TEST(CreaseAngle, is_measured_in_keyframe_0_alone) {
  Motion motion = pages({0, 180});
  motion.keyframes[1] = pages({0, 60}).keyframes[1];
  EXPECT_EQ(creased(motion, 1).size(), 4u);
  std::swap(motion.keyframes[0].positions, motion.keyframes[1].positions);
  EXPECT_EQ(creased(motion, 1).size(), 6u);
}

TEST(CreaseAngle, smoothness_spreads_from_edge_to_edge) {
  // A cone with 12 faces. The normals of neighbouring faces differ by 21.5 degrees, and the normals of opposite faces
  // by 92 degrees. With a crease angle of 30 degrees, all faces share a normal at the tip.
  std::vector<Point> points = {{0, 0, 1}};
  std::vector<std::uint32_t> corners;
  for (std::uint32_t i = 0; i < 12; ++i) {
    const double angle = i * 0.5235987755982988;
    points.push_back({std::cos(angle), std::sin(angle), 0});
    corners.insert(corners.end(), {0, 1 + i, 1 + (i + 1) % 12});
  }
  const Motion cone = test::still(make_triangles(13, corners), points);
  EXPECT_EQ(creased(cone, 30).size(), 13u);
  EXPECT_EQ(creased(cone, 10).size(), 36u);
}

TEST(CreaseAngle, fans_that_touch_in_a_point_stay_apart) {
  const Motion motion =
      test::still(make_triangles(5, {0, 1, 2, 0, 3, 4}), {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}});
  EXPECT_EQ(elements(creased(motion, 180)), (Elements{0, 1, 2, 3, 4, 5}));
}

TEST(CreaseAngle, an_edge_of_three_faces_is_smooth_between_those_that_are_close) {
  // Faces 0 and 1 lie in one plane. Face 2 meets their common edge, at a right angle to both faces.
  const Motion motion = pages({0, 180, 90});
  const NormalGroups groups = creased(motion, 30);
  EXPECT_EQ(groups.element_of_corner()[0], groups.element_of_corner()[4]);
  EXPECT_NE(groups.element_of_corner()[0], groups.element_of_corner()[6]);
}

TEST(CreaseAngle, every_pair_of_the_faces_at_an_edge_counts_and_not_only_neighbours_in_the_file) {
  // In the list of faces, the perpendicular face comes between the two faces that lie in one plane.
  const Motion motion = test::with_faces_in_order(pages({0, 180, 90}), {0, 2, 1});
  const NormalGroups groups = creased(motion, 30);
  EXPECT_EQ(groups.element_of_corner()[0], groups.element_of_corner()[7]);
  EXPECT_NE(groups.element_of_corner()[0], groups.element_of_corner()[3]);
}

TEST(CreaseAngle, an_edge_of_seventeen_faces_is_hard) {
  EXPECT_EQ(creased(pages(std::vector<double>(16, 0)), 179).size(), 2u * 2u + 16u) << "two windings";
  EXPECT_EQ(creased(pages(std::vector<double>(17, 0)), 179).size(), 3u * 17u);
}

TEST(CreaseAngle, neighbours_wound_in_opposite_ways_have_a_hard_edge) {
  const Motion motion =
      test::still(make_triangles(4, {0, 1, 2, 1, 2, 3}), {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}});
  EXPECT_EQ(creased(motion, 30).size(), 6u);
}

TEST(CreaseAngle, a_face_without_area_shares_with_none_below_180_degrees) {
  const Motion motion = test::still(make_triangles(5, {0, 1, 2, 2, 1, 3, 3, 1, 4}),
                                    // Points 1, 2 and 3 are on a line, so one face has no normal.
                                    {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 2, 0}, {2, 2, 0}});
  EXPECT_EQ(creased(motion, 179).size(), 9u);
  EXPECT_EQ(creased(motion, 180).size(), 5u);
}

TEST(CreaseAngle, a_duplicate_face_shares_with_its_original) {
  const Motion motion = test::still(make_triangles(3, {0, 1, 2, 1, 2, 0}), {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  EXPECT_EQ(elements(creased(motion, 0)), (Elements{0, 1, 2, 1, 2, 0}));
}

TEST(CreaseAngle, a_welded_seam_is_smooth_and_an_open_one_is_not) {
  const Motion whole = test::still(make_triangles(4, {0, 1, 2, 2, 1, 3}), {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}});
  const Motion cut = test::torn(whole);
  EXPECT_EQ(creased(cut, 30).size(), 6u);
  EXPECT_EQ(elements(NormalGroups::by_crease_angle(cut, weld_coincident(cut), 30).value()),
            elements(creased(whole, 30)));
}

TEST(CreaseAngle, outside_0_to_180_degrees_is_an_error) {
  const Motion motion = pages({0, 150});
  for (const double degrees : {-1.0, 181.0, std::nan("")}) {
    const auto groups = NormalGroups::by_crease_angle(motion, no_welding(motion), degrees);
    ASSERT_FALSE(groups.ok());
    EXPECT_EQ(groups.error().code, ErrorCode::kUsage);
  }
}

// Makes a mesh with random displacements from `seed`. Tells whether corners share normals exactly as by a flood fill
// that compares all pairs of corners.
bool equals_a_flood(std::uint64_t seed, bool of_polygons, bool tear, double degrees) {
  Motion motion = fixtures::shaken(of_polygons ? fixtures::box_grid(2) : fixtures::icosphere(0), 0.8, seed);
  std::swap(motion.keyframes[0].positions, motion.keyframes[1].positions);  // puts the irregular keyframe first
  if (tear) motion = test::torn(motion);
  const Points points = tear ? weld_coincident(motion) : no_welding(motion);
  const NormalGroups groups = NormalGroups::by_crease_angle(motion, points, degrees).value();
  const auto expected = reference::crease_classes(
      test::reference_mesh(motion.segment(0)),
      std::vector<std::size_t>(points.point_of_vertex.begin(), points.point_of_vertex.end()), degrees);
  const auto found = groups.element_of_corner();
  return std::vector<std::size_t>(found.begin(), found.end()) == expected;
}

RC_GTEST_PROP(CreaseAngle, equals_a_flood_over_all_pairs_of_corners, ()) {
  const auto seed = *rc::gen::arbitrary<std::uint64_t>();
  const bool of_polygons = *rc::gen::arbitrary<bool>(), tear = *rc::gen::arbitrary<bool>();
  RC_ASSERT(equals_a_flood(seed, of_polygons, tear, *rc::gen::inRange(0, 179) + 0.3217));
}

TEST(CreaseAngle, allows_a_millionth_more_for_the_rounding_of_positions) {
  // Two faces of this mesh meet at an angle that exceeds 65.3217 degrees by less than 1e-6 radians, which the tolerance
  // for rounding allows.
  for (const bool tear : {false, true}) EXPECT_TRUE(equals_a_flood(154186546385, false, tear, 65.3217));
  // In a mesh made by hand, an angle may exceed the limit by 1e-7 radians, but not by 1e-5 radians.
  constexpr double kDegreesPerRadian = 57.29577951308232;
  const Motion motion = pages({0, 150});  // the normals of its faces are 30 degrees apart
  EXPECT_EQ(creased(motion, 30 - 1e-7 * kDegreesPerRadian).size(), creased(motion, 31).size());
  EXPECT_EQ(creased(motion, 30 - 1e-5 * kDegreesPerRadian).size(), creased(motion, 29).size());
  EXPECT_NE(creased(motion, 29).size(), creased(motion, 31).size());
}

// ---- groups by smoothing group --------------------------------------------------------------------------------------

TEST(SmoothingGroups, faces_of_one_group_share_and_those_of_group_0_do_not) {
  const Topology strip = make_triangles(6, {0, 1, 2, 2, 1, 3, 2, 3, 4, 4, 3, 5});
  const auto by = [&](std::vector<std::uint32_t> groups) {
    return elements(NormalGroups::by_smoothing_group(strip, separate_points(6), groups).value());
  };
  EXPECT_EQ(by({0, 0, 0, 0}), (Elements{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}));
  EXPECT_EQ(by({7, 7, 7, 7}), (Elements{0, 1, 2, 2, 1, 3, 2, 3, 4, 4, 3, 5}));
  EXPECT_EQ(by({1, 1, 2, 2}), (Elements{0, 1, 2, 2, 1, 3, 4, 5, 6, 6, 5, 7}));
  EXPECT_EQ(by({1, 0, 1, 0}), (Elements{0, 1, 2, 3, 4, 5, 2, 6, 7, 8, 9, 10}));
}

TEST(SmoothingGroups, need_no_edge_in_common) {
  const Topology bow = make_triangles(5, {0, 1, 2, 0, 3, 4});
  const std::vector<std::uint32_t> groups = {3, 3};
  EXPECT_EQ(elements(NormalGroups::by_smoothing_group(bow, separate_points(5), groups).value()),
            (Elements{0, 1, 2, 0, 3, 4}));
}

TEST(SmoothingGroups, must_be_one_for_each_face) {
  const Topology topology = make_triangles(4, {0, 1, 2, 2, 1, 3});
  const std::vector<std::uint32_t> groups = {1, 1, 1};
  const auto result = NormalGroups::by_smoothing_group(topology, separate_points(4), groups);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().text(),
            "the list of smoothing groups has 3 entries for 2 faces; give one entry for each face");
}

// ---- groups by split normals ----------------------------------------------------------------------------------------

Result<NormalGroups> split(const Topology& topology, const std::vector<float>& normals, double degrees = 0.1) {
  return NormalGroups::by_split_normals(topology, separate_points(topology.vertex_count()),
                                        VectorView<const float>::packed(normals.data(), normals.size() / 3), degrees);
}

TEST(SplitNormals, corners_with_one_stored_normal_share_it) {
  const Topology topology = make_triangles(4, {0, 1, 2, 2, 1, 3});
  // The normals at vertex 1 (corners 1 and 4) have one direction but two lengths. The normals at vertex 2 (corners 2
  // and 3) have two directions.
  const auto groups = split(topology, {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 0, 2, 0, 0, 1});
  EXPECT_EQ(elements(groups.value()), (Elements{0, 1, 2, 3, 1, 4}));
}

TEST(SplitNormals, agree_within_the_tolerance_and_through_others) {
  const Topology fan = make_triangles(7, {0, 1, 2, 0, 3, 4, 0, 5, 6});
  const auto at = [](double degrees) {
    return std::vector<float>{static_cast<float>(std::sin(degrees * 0.017453292519943295)), 0,
                              static_cast<float>(std::cos(degrees * 0.017453292519943295))};
  };
  const auto normals = [&](double a, double b, double c) {
    std::vector<float> all;
    for (const double degrees : {a, b, c}) {
      for (int corner = 0; corner < 3; ++corner) {
        const auto n = at(degrees);
        all.insert(all.end(), n.begin(), n.end());
      }
    }
    return all;
  };
  const auto shared = [&](double a, double b, double c) {
    const NormalGroups groups = split(fan, normals(a, b, c), 1).value();
    return Elements{groups.element_of_corner()[0], groups.element_of_corner()[3], groups.element_of_corner()[6]};
  };
  EXPECT_EQ(shared(0, 0.99, 40), (Elements{0, 0, 5}));
  EXPECT_EQ(shared(0, 1.01, 40), (Elements{0, 3, 6}));
  EXPECT_EQ(shared(0, 1.8, 0.9), (Elements{0, 0, 0})) << "0 and 1.8 through 0.9";
  EXPECT_EQ(shared(-179.7, 179.7, 90), (Elements{0, 0, 5})) << "across the back";
}

TEST(SplitNormals, zero_shares_with_zero_only) {
  const Topology fan = make_triangles(7, {0, 1, 2, 0, 3, 4, 0, 5, 6});
  std::vector<float> normals(27, 0.0F);
  normals[2] = 1;
  const NormalGroups groups = split(fan, normals, 45).value();
  EXPECT_NE(groups.element_of_corner()[0], groups.element_of_corner()[3]);
  EXPECT_EQ(groups.element_of_corner()[3], groups.element_of_corner()[6]);
}

TEST(SplitNormals, bad_ones_are_errors_with_a_place) {
  const Topology topology = make_triangles(3, {0, 1, 2});
  EXPECT_EQ(split(topology, {0, 0, 1}).error().text(),
            "the list of normals has 1 entry for 3 corners; give one normal for each corner");
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(split(topology, {0, 0, 1, 0, nan, 1, 0, 0, 1}).error().text(),
            "corner 1: the normal is NaN or infinite; give finite normals");
  const std::vector<float> good = {0, 0, 1, 0, 0, 1, 0, 0, 1};
  EXPECT_EQ(split(topology, good, -1).error().code, ErrorCode::kUsage);
  EXPECT_EQ(split(topology, good, 46).error().code, ErrorCode::kUsage);
}

RC_GTEST_PROP(SplitNormals, equal_a_flood_over_all_pairs_of_corners, ()) {
  const Motion motion = test::still(fixtures::icosphere(0).topology, fixtures::icosphere(0).points);
  fixtures::Random random(*rc::gen::arbitrary<std::uint64_t>());
  const double spread = random.uniform(0, 0.2);
  std::vector<float> normals;
  for (std::size_t c = 0; c < motion.topology.corner_count(); ++c) {
    const Point p = random.in_cube(spread);
    for (const double x : {p[0], p[1], 1 + p[2]}) normals.push_back(static_cast<float>(x));
  }
  const NormalGroups groups = split(motion.topology, normals, 3.0).value();
  const auto expected = reference::flood(motion.topology.corner_count(), [&](std::size_t a, std::size_t b) {
    if (motion.topology.corners()[a] != motion.topology.corners()[b]) return false;
    const auto at = [&](std::size_t c) {
      return reference::Vector{normals[3 * c], normals[3 * c + 1], normals[3 * c + 2]};
    };
    return reference::angle(at(a), at(b)) <= 3 * reference::kPi / 180;
  });
  RC_ASSERT(std::vector<std::size_t>(groups.element_of_corner().begin(), groups.element_of_corner().end()) == expected);
}

TEST(CreaseAngle, of_180_makes_edges_smooth_of_however_many_faces) {
  std::vector<double> angles;
  for (int page = 0; page < 40; ++page) angles.push_back(9.0 * page);
  const Motion motion = pages(angles);
  EXPECT_EQ(creased(motion, 180).size(), 42u) << "one for each end of the hinge, and one for each tip";
  EXPECT_EQ(creased(motion, 179).size(), 120u) << "below, an edge of more than 16 faces is hard";
}

}  // namespace
}  // namespace chronormal::normal_groups_test
