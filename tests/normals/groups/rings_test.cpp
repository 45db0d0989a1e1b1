// Checks that the path around an element encloses the vector area of the faces of the element. Tests closed paths, open
// paths, paths in several pieces, and polygons.
#include "normals/groups/rings.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "chronormal/core/vec3.h"
#include "chronormal/normals/normal_groups.h"
#include "tests/support/fixtures.h"

namespace chronormal::rings_test {
namespace {

// Returns a point with integer coordinates, so every sum of products is exact.
Vec3d point(std::size_t v) {
  const auto of = [v](std::size_t factor, std::size_t modulus) { return static_cast<double>(v * factor % modulus); };
  return {of(7, 19), of(11, 23), of(5, 17)};
}

Vec3d area_of_face(const Topology& topology, std::size_t f) {
  const auto face = topology.face(f);
  Vec3d sum;
  for (std::size_t c = 0; c < face.size(); ++c) sum = sum + cross(point(face[c]), point(face[(c + 1) % face.size()]));
  return sum;
}

Vec3d area_of_path(const RingSlices& slices, std::size_t element) {
  const std::size_t slice = element / kRingLanes;
  const auto at = [&](std::size_t row) { return point(slices.indices[kRingLanes * row + element % kRingLanes]); };
  const std::size_t first = slices.first_row[slice];
  Vec3d sum;
  for (std::size_t row = first + 2; row < slices.first_row[slice + 1]; ++row)
    sum = sum + cross(at(row - 1) - at(first), at(row) - at(first));
  return sum;
}

void expect_areas(const Topology& topology, const NormalGroups& groups, const std::string& what) {
  const Rings of_groups = Rings::of_groups(topology, groups), of_faces = Rings::of_faces(topology);
  for (std::size_t e = 0; e < groups.size(); ++e) {
    Vec3d expected;
    for (const std::uint32_t f : groups.faces(e)) expected = expected + area_of_face(topology, f);
    EXPECT_EQ(area_of_path(of_groups.view(), e), expected) << what << ", element " << e;
  }
  for (std::size_t f = 0; f < topology.face_count(); ++f)
    EXPECT_EQ(area_of_path(of_faces.view(), f), area_of_face(topology, f)) << what << ", face " << f;
}

TEST(Rings, have_the_area_of_the_faces_around_each_element) {
  const auto check = [](const Topology& topology, const std::string& what) {
    expect_areas(topology, NormalGroups::of_vertices(topology, separate_points(topology.vertex_count())), what);
  };
  check(fixtures::make_triangles(7, {0, 1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 5, 0, 5, 6, 0, 6, 1}), "closed");
  check(fixtures::make_triangles(7, {0, 3, 4, 0, 1, 2, 0, 2, 3}), "open, in another order");
  check(fixtures::make_triangles(9, {0, 1, 2, 0, 3, 4, 0, 4, 5}), "two pieces, and a vertex by itself");
  check(fixtures::make_triangles(5, {0, 1, 2, 0, 2, 1, 0, 1, 2}), "one face three times, once the other way round");
  check(fixtures::make_polygons(8, {0, 5, 9, 12}, {0, 1, 2, 3, 4, 0, 4, 5, 6, 0, 6, 7}), "polygons");
  check(fixtures::make_polygons(6, {0, 6}, {0, 1, 2, 0, 3, 4}), "a polygon that comes back to a corner");
}

TEST(Rings, of_points_at_one_place_go_around_the_faces_of_each) {
  const Topology topology = fixtures::make_triangles(36, {0, 1, 2, 19, 3, 4, 0, 5, 6});
  Points points = separate_points(36);
  points.point_of_vertex[19] = 0;
  for (std::size_t v = 20; v < 36; ++v) --points.point_of_vertex[v];
  points.count = 35;
  expect_areas(topology, NormalGroups::of_vertices(topology, points), "vertices 0 and 19 are one point");
}

TEST(Rings, with_too_many_points_are_left_out) {
  const Topology topology = fixtures::make_polygons(9, {0, 6, 9, 12}, {0, 1, 2, 3, 4, 5, 0, 5, 6, 6, 7, 8});
  const NormalGroups groups = NormalGroups::of_vertices(topology, separate_points(9));
  const Rings some = Rings::of_groups(topology, groups, 5), whole = Rings::of_groups(topology, groups);
  EXPECT_LT(some.row_count(), whole.row_count());
  EXPECT_EQ(area_of_path(some.view(), 0), Vec3d{}) << "five points of the polygon, and two of a triangle";
  EXPECT_EQ(area_of_path(some.view(), 1), area_of_face(topology, 0)) << "five points";
  EXPECT_EQ(area_of_path(some.view(), 6), area_of_face(topology, 1) + area_of_face(topology, 2));
  const std::vector<std::uint32_t> left_out(some.left_out().begin(), some.left_out().end());
  EXPECT_EQ(left_out, (std::vector<std::uint32_t>{0, 5})) << "the two corners of both";
  EXPECT_TRUE(whole.left_out().empty());
  const Rings faces = Rings::of_faces(topology, 4);
  EXPECT_EQ(area_of_path(faces.view(), 0), Vec3d{});
  EXPECT_EQ(area_of_path(faces.view(), 1), area_of_face(topology, 1));
}

TEST(Rings, of_few_triangles_are_those_of_any_polygons) {
  // A square of vertices 8 to 11, which no other face has, turns the triangle mesh into a mesh of polygons. All other
  // faces stay the same.
  fixtures::Random random(17);
  for (int i = 0; i < 200; ++i) {
    std::vector<std::uint32_t> corners;
    for (std::size_t f = 0; f < 1 + random.below(18); ++f) {
      const auto a = static_cast<std::uint32_t>(1 + random.below(7)),
                 b = static_cast<std::uint32_t>(1 + random.below(7));
      if (a != b) corners.insert(corners.end(), {0U, a, b});
    }
    const std::size_t triangles = corners.size() / 3;
    std::vector<std::uint32_t> offsets;
    for (std::size_t f = 0; f <= triangles; ++f) offsets.push_back(static_cast<std::uint32_t>(3 * f));
    const Topology alone = fixtures::make_triangles(12, corners);
    corners.insert(corners.end(), {8, 9, 10, 11});
    offsets.push_back(static_cast<std::uint32_t>(corners.size()));
    const Topology beside = fixtures::make_polygons(12, offsets, corners);
    const auto paths = [](const Topology& topology) {
      return Rings::of_groups(topology, NormalGroups::of_vertices(topology, separate_points(12)));
    };
    const Rings a = paths(alone), b = paths(beside);
    ASSERT_GE(b.row_count(), a.row_count());
    for (std::size_t row = 0; row < b.row_count(); ++row) {
      for (std::size_t e = 0; e < 8; ++e) {
        const auto of = [row, e](const Rings& rings) {
          return rings.view().indices[kRingLanes * (row < rings.row_count() ? row : 0) + e];
        };
        ASSERT_EQ(of(a), of(b)) << "mesh " << i << ", element " << e << ", row " << row;
      }
    }
  }
}

TEST(Rings, repeat_the_last_element_behind_it) {
  const Topology topology = fixtures::make_triangles(7, {0, 3, 4, 0, 1, 2, 0, 2, 3, 6, 4, 5});
  const Rings rings = Rings::of_groups(topology, NormalGroups::of_vertices(topology, separate_points(7)));
  for (std::size_t lane = 7; lane < kRingLanes; ++lane)
    EXPECT_EQ(area_of_path(rings.view(), lane), area_of_path(rings.view(), 6));
}

TEST(Rings, take_the_memory_of_the_longest_of_sixteen) {
  EXPECT_EQ(Rings().row_count(), 0U);
  EXPECT_TRUE(Rings::of_faces(fixtures::make_triangles(3, {})).empty());
  const Rings rings = Rings::of_faces(fixtures::make_polygons(5, {0, 3, 8}, {0, 1, 2, 0, 1, 2, 3, 4}));
  EXPECT_EQ(rings.row_count(), 5U);
  EXPECT_EQ(rings.bytes(), 16 * 5 * sizeof(std::uint32_t) + 2 * sizeof(std::size_t));
}

}  // namespace
}  // namespace chronormal::rings_test
