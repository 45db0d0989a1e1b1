// Checks that the library separates two sheets back to back into two sides, each with its own normals.
#include "normals/groups/sides.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "tests/support/fixtures.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/shaded_mesh.h"
#include "workflow/shading/gltf_shading.h"

namespace chronormal::sides_test {
namespace {

using fixtures::Point;
using test::GltfFixture;
using test::ShadedMesh;

constexpr unsigned kSeed = 51;

// A sheet with hills. `corners` has the triangles as indices of points.
struct Sheet {
  std::size_t side = 5;
  std::vector<Point> points;
  std::vector<std::uint32_t> corners;

  explicit Sheet(std::mt19937& random) {
    std::uniform_real_distribution<float> hill(-0.3F, 0.3F);
    for (std::size_t i = 0; i < side * side; ++i)
      points.push_back(
          {static_cast<float>(i % side) + hill(random), static_cast<float>(i / side) + hill(random), hill(random)});
    for (std::uint32_t row = 0; row + 1 < side; ++row) {
      for (std::uint32_t column = 0; column + 1 < side; ++column) {
        const auto s = static_cast<std::uint32_t>(side);
        const std::uint32_t a = row * s + column;
        for (const std::uint32_t v : {a, a + 1, a + s + 1, a, a + s + 1, a + s}) corners.push_back(v);
      }
    }
  }
};

// Returns the sum of the cross products of all faces at a vertex.
std::array<double, 3> sum_at(const std::vector<Point>& points, const std::vector<std::uint32_t>& corners,
                             std::uint32_t vertex) {
  std::array<double, 3> sum{};
  for (std::size_t t = 0; t < corners.size(); t += 3) {
    if (std::find(&corners[t], &corners[t] + 3, vertex) == &corners[t] + 3) continue;
    std::array<double, 3> e{}, f{};
    for (std::size_t c = 0; c < 3; ++c) {
      e[c] = static_cast<double>(points[corners[t + 1]][c]) - static_cast<double>(points[corners[t]][c]);
      f[c] = static_cast<double>(points[corners[t + 2]][c]) - static_cast<double>(points[corners[t]][c]);
    }
    for (std::size_t c = 0; c < 3; ++c) sum[c] += e[(c + 1) % 3] * f[(c + 2) % 3] - e[(c + 2) % 3] * f[(c + 1) % 3];
  }
  return sum;
}

TEST(Sides, sheets_with_vertices_of_their_own_share_none_and_seams_still_do) {
  std::mt19937 random(kSeed);
  for (int draw = 0; draw < 30; ++draw) {
    const Sheet sheet(random);
    const std::size_t triangles = sheet.corners.size() / 3;
    // Some corners get a vertex of their own, which is a copy of their point. The two sides choose these corners
    // separately. The faces are in random order.
    std::vector<Point> places;
    std::vector<int> side_of;
    std::vector<std::uint32_t> point_of, corners;
    std::vector<std::array<std::uint32_t, 3>> faces;
    for (const int side : {0, 1}) {
      std::vector<std::vector<std::uint32_t>> copies(sheet.points.size());
      for (std::size_t t = 0; t < triangles; ++t) {
        std::array<std::uint32_t, 3> face{};
        for (std::size_t c = 0; c < 3; ++c) {
          const std::uint32_t p = sheet.corners[3 * t + c];
          const bool is_new = copies[p].empty() || random() % 4 == 0;
          if (is_new) {
            copies[p].push_back(static_cast<std::uint32_t>(places.size()));
            places.push_back(sheet.points[p]);
            point_of.push_back(p);
            side_of.push_back(side);
          }
          face[c] = is_new ? copies[p].back() : copies[p][random() % copies[p].size()];
        }
        if (side == 1) std::swap(face[1], face[2]);
        std::rotate(face.begin(), face.begin() + static_cast<std::ptrdiff_t>(random() % 3), face.end());
        faces.push_back(face);
      }
    }
    std::shuffle(faces.begin(), faces.end(), random);
    for (const auto& face : faces) corners.insert(corners.end(), face.begin(), face.end());
    const Motion motion = fixtures::make_motion(fixtures::make_triangles(places.size(), corners), places, places);
    const Points points = weld_coincident(motion);
    for (std::uint32_t a = 0; a < places.size(); ++a)
      for (std::uint32_t b = 0; b < a; ++b)
        EXPECT_EQ(points.point_of_vertex[a] == points.point_of_vertex[b],
                  point_of[a] == point_of[b] && side_of[a] == side_of[b])
            << draw << ": " << a << " and " << b;
  }
}

TEST(Sides, polygons_lie_back_to_back_where_one_has_the_points_of_the_other_in_reverse) {
  std::mt19937 random(kSeed + 3);
  RecordProperty("seed", static_cast<int>(kSeed + 3));
  std::size_t pairs = 0;
  for (int draw = 0; draw < 200; ++draw) {
    std::vector<std::vector<std::uint32_t>> loops(30);
    for (std::vector<std::uint32_t>& loop : loops)
      for (std::size_t c = 0, size = 2 + random() % 3; c < size && size > 2; ++c)
        loop.push_back(static_cast<std::uint32_t>(random() % 4));
    const auto is_simple = [](std::vector<std::uint32_t> loop) {
      std::sort(loop.begin(), loop.end());
      return !loop.empty() && std::adjacent_find(loop.begin(), loop.end()) == loop.end();
    };
    std::vector<BackToBack> right;
    std::vector<bool> is_taken(loops.size());
    for (std::uint32_t a = 0; a < loops.size(); ++a) {
      for (std::uint32_t b = a + 1; b < loops.size() && !is_taken[a]; ++b) {
        std::vector<std::uint32_t> back(loops[b].rbegin(), loops[b].rend());
        bool is_back = false;
        for (std::size_t turn = 0; turn < back.size(); ++turn) {
          std::rotate(back.begin(), back.begin() + 1, back.end());
          is_back = is_back || back == loops[a];
        }
        if (!is_back || is_taken[b] || !is_simple(loops[a])) continue;
        is_taken[a] = is_taken[b] = true;
        right.emplace_back(a, b);
      }
    }
    pairs += right.size();
    EXPECT_EQ(find_backs(loops.size(), [&](std::uint32_t i, auto& loop) { loop = loops[i]; }), right) << draw;
  }
  EXPECT_GT(pairs, 100U);
}

TEST(Sides, faces_go_together_along_edges_that_one_leaves_by_and_the_other_comes_by) {
  // Faces 0 and 1 pass their common edge to vertex 5 in the same direction, so their windings are opposite. Faces 1 and
  // 2 pass the edge to vertex 6 in opposite directions, so they belong to the same side.
  const std::vector<std::pair<std::uint32_t, std::uint32_t>> apart = {{0, 2}};
  EXPECT_EQ(split_sides(3, {{0, 5, true}, {1, 5, true}, {1, 6, true}, {2, 6, false}}, apart),
            (std::vector<std::uint32_t>{0, 1, 1}));
  EXPECT_EQ(split_sides(3, {{0, 5, true}, {1, 5, false}, {1, 6, true}, {2, 6, false}}, apart),
            (std::vector<std::uint32_t>{0, 0, 1}));
  // A face without a common edge joins the first side that has no face from which it must be separate.
  EXPECT_EQ(split_sides(4, {}, std::vector<std::pair<std::uint32_t, std::uint32_t>>{{0, 1}, {0, 2}}),
            (std::vector<std::uint32_t>{0, 1, 1, 0}));
}

TEST(Sides, walls_of_two_boxes_that_touch_stay_one_surface_around_their_rim) {
  // Two cubes touch along a wall. Each cube has twelve triangles, and each triangle has its own copies of its corners.
  std::vector<Point> places;
  std::vector<std::uint32_t> corners;
  for (const float x : {0.0F, 1.0F}) {
    const auto first = static_cast<std::uint32_t>(places.size());
    for (std::uint32_t v = 0; v < 8; ++v)
      places.push_back({x + static_cast<float>(v & 1U), static_cast<float>(v >> 1U & 1U), static_cast<float>(v >> 2U)});
    for (const auto& quad : {std::array{0U, 2U, 3U, 1U},
                             {4U, 5U, 7U, 6U},
                             {0U, 1U, 5U, 4U},
                             {2U, 6U, 7U, 3U},
                             {0U, 4U, 6U, 2U},
                             {1U, 3U, 7U, 5U}})
      for (const std::size_t i : {0U, 1U, 2U, 0U, 2U, 3U}) corners.push_back(first + quad[i]);
  }
  const Motion motion = fixtures::make_motion(fixtures::make_triangles(16, corners), places, places);
  EXPECT_EQ(weld_coincident(motion).count, 12U);
}

// Makes a sheet whose two sides use the same vertices. If is_cut_otherwise, pairs of triangles form quads, and the back
// divides each quad along its other diagonal.
ShadedMesh two_sided(const Sheet& sheet, bool is_cut_otherwise, bool looks_back) {
  ShadedMesh mesh;
  std::vector<std::uint32_t> back;
  for (std::size_t t = 0; t < sheet.corners.size(); t += 6) {
    const std::uint32_t a = sheet.corners[t], b = sheet.corners[t + 1], c = sheet.corners[t + 2],
                        d = sheet.corners[t + 5];
    for (const std::uint32_t v : is_cut_otherwise ? std::array{d, c, b, d, b, a} : std::array{c, b, a, c, a, d})
      back.push_back(v);
  }
  mesh.corners = sheet.corners;
  mesh.corners.insert(mesh.corners.end(), back.begin(), back.end());
  mesh.targets.resize(1);
  for (std::size_t i = 0; i < sheet.points.size(); ++i) {
    const float z = looks_back ? -1.0F : 1.0F;
    mesh.positions.insert(mesh.positions.end(), sheet.points[i].begin(), sheet.points[i].end());
    mesh.normals.insert(mesh.normals.end(), {0, 0, z});
    mesh.targets[0].positions.insert(mesh.targets[0].positions.end(), {0, 0, 0.1F * static_cast<float>(i)});
  }
  return mesh;
}

TEST(Sides, the_stored_normal_of_a_vertex_says_which_side_it_shows) {
  std::mt19937 random(kSeed + 1);
  for (int draw = 0; draw < 20; ++draw) {
    const Sheet sheet(random);
    for (const bool is_cut_otherwise : {false, true}) {
      for (const bool looks_back : {false, true}) {
        const ShadedMesh mesh = two_sided(sheet, is_cut_otherwise, looks_back);
        const GltfFixture fixture(mesh.file());
        ASSERT_TRUE(fixture.ok()) << fixture.error();
        const GltfShading shading = read_gltf_shading(*fixture, 0).value();
        const std::vector<std::uint32_t> seen(
            mesh.corners.begin() + static_cast<std::ptrdiff_t>(looks_back ? sheet.corners.size() : 0),
            looks_back ? mesh.corners.end() : mesh.corners.begin() + static_cast<std::ptrdiff_t>(sheet.corners.size()));
        const std::vector<Vec3d> normals = normals_from_positions(shading, std::array{0.0});
        for (std::uint32_t v = 0; v < sheet.points.size(); ++v) {
          const std::array<double, 3> right = sum_at(sheet.points, seen, v);
          const Vec3d found = normals[shading.element_of_vertex[v]];
          EXPECT_NEAR(found.x, right[0], 1e-9) << draw << " " << is_cut_otherwise << " " << looks_back << " " << v;
          EXPECT_NEAR(found.y, right[1], 1e-9);
          EXPECT_NEAR(found.z, right[2], 1e-9);
        }
      }
    }
  }
}

TEST(Sides, corners_of_both_sides_that_store_one_normal_are_elements_of_their_own) {
  std::mt19937 random(kSeed + 2);
  const Sheet sheet(random);
  ShadedMesh mesh = two_sided(sheet, false, false);
  const auto groups_of = [&sheet](const std::vector<std::uint32_t>& corners) {
    const Topology topology = Topology::triangles(sheet.points.size(), corners).value();
    std::vector<float> of_corners;
    for (std::size_t c = 0; c < corners.size(); ++c) of_corners.insert(of_corners.end(), {0, 0, 1});
    return NormalGroups::by_split_normals(topology, separate_points(sheet.points.size()),
                                          VectorView<const float>::packed(of_corners.data(), corners.size()));
  };
  const Result<NormalGroups> groups = groups_of(mesh.corners);
  ASSERT_TRUE(groups.ok());
  EXPECT_EQ(groups.value().size(), 2 * sheet.points.size());
  const auto element = groups.value().element_of_corner();
  for (std::size_t c = 0; c < sheet.corners.size(); ++c)
    for (std::size_t d = sheet.corners.size(); d < mesh.corners.size(); ++d) EXPECT_NE(element[c], element[d]);
  // If the back of one face is missing, the three points of this face have only one side.
  mesh.corners.resize(mesh.corners.size() - 3);
  EXPECT_EQ(groups_of(mesh.corners).value().size(), 2 * sheet.points.size() - 3);
}

}  // namespace
}  // namespace chronormal::sides_test
