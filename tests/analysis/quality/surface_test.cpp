#include "chronormal/analysis/surface.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "tests/support/fixtures.h"
#include "tests/support/random_mesh.h"

namespace chronormal::surface_test {
namespace {

using Corners = std::vector<std::uint32_t>;

Surface survey_vertices(const Topology& topology) { return survey(topology, separate_points(topology.vertex_count())); }

Surface survey_triangles(std::size_t vertex_count, Corners corners) {
  return survey_vertices(fixtures::make_triangles(vertex_count, std::move(corners)));
}

void expect_no_trouble(const Surface& surface) {
  for (const Found& found :
       {surface.open_edges, surface.non_manifold_edges, surface.turned_edges, surface.seam_edges, surface.unreferenced,
        surface.repeating_faces, surface.doubled_faces, surface.back_to_back})
    EXPECT_EQ(found, Found{});
}

TEST(Surface, closed_meshes_have_no_trouble_and_obey_euler) {
  for (const auto& mesh : {fixtures::icosphere(2), fixtures::box_grid(5)}) {
    const Surface surface = survey_vertices(mesh.topology);
    expect_no_trouble(surface);
    EXPECT_EQ(surface.pieces, 1U);
    EXPECT_EQ(mesh.topology.vertex_count() + mesh.topology.face_count(), surface.edges + 2);
    EXPECT_EQ(2 * surface.edges, mesh.topology.corner_count());
  }
  EXPECT_EQ(survey_vertices(fixtures::icosphere(2).topology).triangles, 320U);
  EXPECT_EQ(survey_vertices(fixtures::box_grid(5).topology).triangles, 0U);
  EXPECT_EQ(survey_vertices(fixtures::box_grid(5).topology).most_corners, 4U);
}

TEST(Surface, hole_has_open_edges_and_a_loose_vertex_no_face) {
  const Topology sphere = fixtures::icosphere(1).topology;
  Corners corners(sphere.corners().begin() + 3, sphere.corners().end());
  const Surface surface = survey_triangles(sphere.vertex_count() + 2, corners);
  EXPECT_EQ(surface.open_edges.count, 3U);
  EXPECT_EQ(surface.unreferenced, (Found{2, sphere.vertex_count()}));
  EXPECT_EQ(surface.turned_edges.count, 0U);
  EXPECT_EQ(surface.pieces, 1U);
}

TEST(Surface, face_wound_the_wrong_way_turns_its_three_edges) {
  const Topology sphere = fixtures::icosphere(1).topology;
  Corners corners(sphere.corners().begin(), sphere.corners().end());
  std::swap(corners[3 * 7], corners[3 * 7 + 1]);
  const Surface surface = survey_triangles(sphere.vertex_count(), corners);
  EXPECT_EQ(surface.turned_edges.count, 3U);
  EXPECT_LE(surface.turned_edges.first, 7U);
  EXPECT_EQ(surface.open_edges.count, 0U);
  EXPECT_EQ(surface.doubled_faces.count, 0U);
}

TEST(Surface, third_face_at_an_edge_makes_it_non_manifold) {
  const Surface surface = survey_triangles(5, {0, 1, 2, 1, 0, 3, 0, 1, 4});
  EXPECT_EQ(surface.edges, 7U);
  EXPECT_EQ(surface.non_manifold_edges, (Found{1, 0}));
  EXPECT_EQ(surface.open_edges.count, 6U);
  EXPECT_EQ(surface.turned_edges.count, 0U);  // only edges with exactly two faces are examined
}

TEST(Surface, a_sheet_that_is_there_twice_is_doubled_and_not_wound_against_itself) {
  const Surface surface = survey_triangles(4, {0, 1, 2, 0, 2, 3, 0, 1, 2, 0, 2, 3});
  EXPECT_EQ(surface.doubled_faces, (Found{2, 2}));
  EXPECT_EQ(surface.turned_edges.count, 0U);
  // An edge counts as turned if its two faces pass it in the same direction, so that their windings contradict each
  // other.
  EXPECT_EQ(survey_triangles(4, {0, 1, 2, 0, 1, 3}).turned_edges.count, 1U);
}

TEST(Surface, doubled_faces_are_told_from_those_back_to_back) {
  // Faces 1 and 3 are copies of face 0, and face 2 has the corners of face 0 in reverse order. Face 4 uses a vertex
  // twice and is ignored.
  const Surface surface = survey_triangles(4, {0, 1, 2, 1, 2, 0, 0, 2, 1, 2, 0, 1, 0, 0, 1, 1, 2, 3});
  EXPECT_EQ(surface.doubled_faces, (Found{2, 1}));
  EXPECT_EQ(surface.back_to_back, (Found{1, 0}));
  EXPECT_EQ(surface.repeating_faces, (Found{1, 4}));
  const Topology quads = fixtures::make_polygons(5, {0, 4, 8, 11, 15}, {0, 1, 2, 3, 3, 2, 1, 0, 0, 1, 2, 2, 3, 0, 1});
  EXPECT_EQ(survey_vertices(quads).doubled_faces, (Found{1, 3}));
  EXPECT_EQ(survey_vertices(quads).back_to_back, (Found{1, 0}));
  EXPECT_EQ(survey_vertices(quads).triangles, 1U);
}

TEST(Surface, polygons_lie_on_each_other_only_with_the_same_outline) {
  const auto pair = [](Corners second) {
    Corners corners = {0, 1, 3, 2};
    corners.insert(corners.end(), second.begin(), second.end());
    return survey_vertices(fixtures::make_polygons(4, {0, 4, 8}, corners));
  };
  EXPECT_EQ(pair({3, 2, 0, 1}).doubled_faces, (Found{1, 1}));
  EXPECT_EQ(pair({3, 1, 0, 2}).back_to_back, (Found{1, 0}));
  // The outlines of the four polygons below cross themselves. Each has the points of the first polygon, but not the
  // same four edges, so it counts neither as a copy nor as a reversed copy.
  for (const Corners& crossed : {Corners{0, 3, 1, 2}, Corners{0, 1, 2, 3}, Corners{2, 1, 0, 3}, Corners{3, 0, 2, 1}}) {
    EXPECT_EQ(pair(crossed).back_to_back, Found{});
    EXPECT_EQ(pair(crossed).doubled_faces, Found{});
  }
}

TEST(Surface, edge_that_one_face_has_twice_is_open) {
  const Surface alone = survey_vertices(fixtures::make_polygons(3, {0, 4}, {0, 1, 0, 2}));
  EXPECT_EQ(alone.edges, 2U);
  EXPECT_EQ(alone.open_edges, (Found{2, 0}));
  EXPECT_EQ(alone.turned_edges, Found{});
  EXPECT_EQ(alone.repeating_faces, (Found{1, 0}));
  // A second face at the edge between vertices 0 and 1 closes the open side of this edge. The edge does not count as
  // non-manifold.
  const Surface both = survey_vertices(fixtures::make_polygons(4, {0, 4, 7}, {0, 1, 0, 2, 0, 1, 3}));
  EXPECT_EQ(both.edges, 4U);
  EXPECT_EQ(both.open_edges.count, 3U);
  EXPECT_EQ(both.non_manifold_edges, Found{});
}

TEST(Surface, faces_that_share_a_vertex_are_one_piece) {
  EXPECT_EQ(survey_triangles(9, {0, 1, 2, 3, 4, 5, 6, 7, 8}).pieces, 3U);
  EXPECT_EQ(survey_triangles(9, {0, 1, 2, 3, 4, 5, 5, 7, 2}).pieces, 1U);
}

// Gives every corner of a closed mesh its own vertex. The mesh then has holes between vertices, but not between points.
TEST(Surface, copies_of_vertices_are_seams_and_not_holes) {
  for (const auto& mesh : {fixtures::icosphere(2), fixtures::box_grid(4)}) {
    std::vector<fixtures::Point> points;
    Corners corners, offsets = {0};
    for (std::size_t f = 0; f < mesh.topology.face_count(); ++f) {
      for (const std::uint32_t vertex : mesh.topology.face(f)) {
        corners.push_back(static_cast<std::uint32_t>(points.size()));
        points.push_back(mesh.points[vertex]);
      }
      offsets.push_back(static_cast<std::uint32_t>(corners.size()));
    }
    const Topology torn = fixtures::make_polygons(points.size(), offsets, corners);
    const Motion motion = fixtures::make_motion(torn, points, points);
    const Points welded = weld_coincident(motion);
    const Surface whole = survey(torn, welded), original = survey_vertices(mesh.topology);
    EXPECT_EQ(whole.edges, original.edges);
    EXPECT_EQ(whole.seam_edges.count, original.edges);
    EXPECT_EQ(whole.open_edges.count, 0U);
    EXPECT_EQ(whole.pieces, 1U);
    EXPECT_EQ(find_copies(welded).count, points.size() - mesh.points.size());
    EXPECT_EQ(survey_vertices(torn).open_edges.count, mesh.topology.corner_count());
    EXPECT_EQ(survey_vertices(torn).pieces, mesh.topology.face_count());
  }
}

TEST(Surface, one_end_of_an_edge_that_is_kept_apart_makes_it_a_seam) {
  // Both faces have the edge between points 0 and 1. Vertex 4 is a copy of vertex 0 in `low`, and of vertex 1 in
  // `high`.
  const Topology low = fixtures::make_triangles(5, {0, 1, 2, 1, 4, 3}),
                 high = fixtures::make_triangles(5, {0, 1, 2, 4, 0, 3});
  EXPECT_EQ(survey(low, {{0, 1, 2, 3, 0}, 4}).seam_edges, (Found{1, 0}));
  EXPECT_EQ(survey(high, {{0, 1, 2, 3, 1}, 4}).seam_edges, (Found{1, 0}));
  EXPECT_EQ(survey(low, {{0, 1, 2, 3, 0}, 4}).open_edges.count, 4U);
}

TEST(Surface, copies_are_the_vertices_that_welding_removes) {
  const Points points{{0, 1, 1, 2, 0, 3}, 4};
  EXPECT_EQ(find_copies(points), (Found{2, 2}));
  EXPECT_EQ(find_copies(separate_points(5)), Found{});
}

// Counts independently what survey() counts, with maps and sets of edges and faces.
TEST(Surface, agrees_with_a_count_by_hand_on_any_mesh) {
  const bool holds = rc::check("any mesh", [] {
    const MeshFrame mesh = test::random_mesh();
    const Topology& topology = mesh.topology;
    const auto point_count = *rc::gen::inRange<std::size_t>(1, topology.vertex_count() + 1);
    Points points{{}, 0};
    for (std::size_t v = 0; v < topology.vertex_count(); ++v) {
      const auto wanted = static_cast<std::size_t>(*rc::gen::inRange<std::size_t>(0, point_count));
      const bool is_new = wanted >= points.count;
      points.point_of_vertex.push_back(static_cast<std::uint32_t>(is_new ? points.count : wanted));
      points.count += is_new ? 1U : 0U;
    }
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::set<std::size_t>> edges;
    std::map<Corners, std::vector<std::size_t>> faces;  // by the smallest of all rotated and reversed outlines
    std::set<std::uint32_t> used;
    std::size_t repeating = 0, pairs = 0;
    std::vector<std::set<std::uint32_t>> pieces;
    for (std::size_t f = 0; f < topology.face_count(); ++f) {
      const auto face = topology.face(f);
      Corners corners;
      for (std::size_t c = 0; c < face.size(); ++c) {
        const std::uint32_t a = points.point_of_vertex[face[c]];
        const std::uint32_t b = points.point_of_vertex[face[(c + 1) % face.size()]];
        corners.push_back(a);
        used.insert(face[c]);
        if (a != b) edges[std::minmax(a, b)].insert(f);
      }
      std::set<std::uint32_t> merged(corners.begin(), corners.end());
      if (merged.size() < corners.size()) {
        ++repeating;
      } else {
        Corners least = corners;
        for (std::size_t turn = 0; turn < 2 * corners.size(); ++turn) {
          std::rotate(corners.begin(), corners.begin() + 1, corners.end());
          if (turn == corners.size()) std::reverse(corners.begin(), corners.end());
          least = std::min(least, corners);
        }
        faces[least].push_back(f);
      }
      std::erase_if(pieces, [&merged](const std::set<std::uint32_t>& piece) {
        const bool touches =
            std::any_of(piece.begin(), piece.end(), [&merged](std::uint32_t p) { return merged.count(p) > 0; });
        if (touches) merged.insert(piece.begin(), piece.end());
        return touches;
      });
      pieces.push_back(merged);
    }
    Found open, non_manifold;
    for (const auto& [edge, at] : edges) {
      if (at.size() == 1) open.add(*at.begin());
      if (at.size() > 2) non_manifold.add(*at.begin());
    }
    for (const auto& [corners, at] : faces) pairs += at.size() - 1;

    const Surface surface = survey(topology, points);
    RC_ASSERT(surface.edges == edges.size());
    RC_ASSERT(surface.open_edges == open);
    RC_ASSERT(surface.non_manifold_edges == non_manifold);
    RC_ASSERT(surface.unreferenced.count == topology.vertex_count() - used.size());
    RC_ASSERT(surface.repeating_faces.count == repeating);
    RC_ASSERT(surface.pieces == pieces.size());
    // Each later face with the same points as an earlier face is either a copy of that face or has its corners in
    // reverse order.
    RC_ASSERT(surface.doubled_faces.count <= pairs);
    RC_ASSERT(surface.doubled_faces.count + surface.back_to_back.count >= pairs);
  });
  EXPECT_TRUE(holds);
}

}  // namespace
}  // namespace chronormal::surface_test
