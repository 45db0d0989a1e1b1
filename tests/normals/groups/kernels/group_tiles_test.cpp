// Compares the control normals that the kernel computes in tiles of 16 vertices or corners with sums over single faces,
// in the order of NormalGroups.

#include "normals/groups/kernels/group_tiles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <iostream>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "chronormal/core/parallel.h"
#include "chronormal/normals/normal_groups.h"
#include "normals/control/exact_curve.h"
#include "normals/groups/rings.h"
#include "simd/targets.h"
#include "tests/support/elements.h"
#include "tests/support/fixtures.h"
#include "tests/support/float_tiles.h"

namespace chronormal::group_tiles_test {
namespace {

using fixtures::Point;

NormalGroups vertices_of(const Motion& motion) {
  return NormalGroups::of_vertices(motion.topology, separate_points(motion.topology.vertex_count()));
}

// The expected control normals: sums over faces. face_control_normals() computes the faces one by one, and therefore
// without SIMD lanes. `magnitudes` measures rounding errors: for each element, the largest component of the sums of
// absolute products along the path around the element.
struct Expected {
  std::vector<ControlNormals> normals;
  std::vector<double> magnitudes;
};

// Returns, for each component of the edge from b to a, the larger of its absolute values at the two ends of the
// segment.
Vec3d larger_of_ends(const Segment& segment, std::uint32_t a, std::uint32_t b) {
  const Vec3d from = to_double(segment.from[a]) - to_double(segment.from[b]);
  const Vec3d to = to_double(segment.to[a]) - to_double(segment.to[b]);
  return {std::max(std::fabs(from.x), std::fabs(to.x)), std::max(std::fabs(from.y), std::fabs(to.y)),
          std::max(std::fabs(from.z), std::fabs(to.z))};
}

double magnitude_along(const Segment& segment, const RingSlices& rings, std::size_t element) {
  const std::size_t first = rings.first_row[element / kTile], rows = rings.first_row[element / kTile + 1] - first;
  const auto at = [&](std::size_t r) { return rings.indices[kTile * (first + r) + element % kTile]; };
  Vec3d sum;
  const auto add = [&sum](const Vec3d& e, const Vec3d& d) {
    sum = sum + Vec3d{e.y * d.z + e.z * d.y, e.z * d.x + e.x * d.z, e.x * d.y + e.y * d.x};
  };
  std::size_t r = 2;
  for (; r + 1 < rows; r += 2)
    add(larger_of_ends(segment, at(r), at(0)), larger_of_ends(segment, at(r + 1), at(r - 1)));
  if (r < rows) add(larger_of_ends(segment, at(r - 1), at(0)), larger_of_ends(segment, at(r), at(0)));
  return std::max({sum.x, sum.y, sum.z});
}

Expected expected_of(const Segment& segment, const NormalGroups& groups) {
  std::vector<ControlNormals> faces(segment.topology->face_count());
  for (std::size_t f = 0; f < faces.size(); ++f) face_control_normals(segment, {f, 1}, {&faces[f], 1});
  Expected expected;
  expected.normals.resize(groups.size());
  group_control_normals(groups, faces, {0, groups.size()}, expected.normals);
  const RingSlices rings = rings_around(*segment.topology, groups).view();
  for (std::size_t e = 0; e < groups.size(); ++e) expected.magnitudes.push_back(magnitude_along(segment, rings, e));
  return expected;
}

// Tells whether a component of a control normal equals a sum that was computed in another order, except for rounding.
// If the component is zero, the sum must be a zero with the same sign.
bool is_right(float value, double expected, float magnitude) {
  const auto rounded = static_cast<float>(expected);
  if (std::memcmp(&value, &rounded, sizeof(float)) == 0) return true;
  const double off = std::fabs(static_cast<double>(value) - expected);
  return expected != 0 && off <= 0x1p-24 * std::fabs(expected) + 0x1p-47 * static_cast<double>(magnitude) + 0x1p-150;
}

std::string difference(const Expected& expected, IndexRange elements, std::span<const ControlTile> tiles) {
  for (std::size_t i = 0; i < tiles.size() * kTile; ++i) {
    const std::size_t e = elements.first + std::min(i, elements.count - 1);
    const ControlTile& tile = tiles[i / kTile];
    const std::size_t lane = i % kTile;
    const ControlNormals& c = expected.normals[e];
    std::string place = "lane ";
    place += std::to_string(i) + ", element " + std::to_string(e) + " of " + target_name(current_target()) + ": ";
    const double components[9] = {c.n0.x, c.n0.y, c.n0.z, c.m.x, c.m.y, c.m.z, c.n1.x, c.n1.y, c.n1.z};
    for (std::size_t k = 0; k < 9; ++k) {
      if (!is_right(tile.normals[k][lane], components[k], tile.magnitude[lane]))
        return place + "component " + std::to_string(k) + " is " + std::to_string(tile.normals[k][lane]) + " and not " +
               std::to_string(components[k]);
    }
    if (tile.degree[lane] != degree(c)) return place + "degree " + std::to_string(tile.degree[lane]);
    if (!(static_cast<double>(tile.magnitude[lane]) >= expected.magnitudes[e]))
      return place + "magnitude " + std::to_string(tile.magnitude[lane]);
  }
  return "";
}

// Compares the tiles of all elements from element `first` on with the expected control normals, on all instruction
// sets. The kernel writes the tiles in ranges of `step` elements. `first` and `step` are multiples of 16. Describes the
// first difference, or returns "".
std::string difference_on_all_targets(const Segment& segment, const NormalGroups& groups, std::size_t first = 0,
                                      std::size_t step = 256) {
  const Expected expected = expected_of(segment, groups);
  for (const auto target : supported_targets()) {
    const ScopedTarget scope(target);
    for (const bool fetch : {false, true}) {
      const GroupTiles writer(segment, groups, fetch);
      for (std::size_t e = first; e < groups.size(); e += step) {
        const IndexRange elements{e, std::min(step, groups.size() - e)};
        std::vector<ControlTile> tiles((elements.count + kTile - 1) / kTile);
        writer.write(elements, tiles);
        std::string found = difference(expected, elements, tiles);
        if (!found.empty()) return found;
      }
    }
  }
  return "";
}

std::string difference_on_all_targets(const Motion& motion, std::size_t first = 0, std::size_t step = 256) {
  return difference_on_all_targets(motion.segment(0), vertices_of(motion), first, step);
}

// Makes a grid of columns x rows cells, each of two triangles. The cells are in the order of rows, and every vertex
// moves.
Motion grid(std::size_t columns, std::size_t rows) {
  fixtures::Random random(11);
  std::vector<Point> from, to;
  for (std::size_t j = 0; j <= rows; ++j) {
    for (std::size_t i = 0; i <= columns; ++i) {
      for (auto* points : {&from, &to}) {
        const Point noise = random.in_cube(0.3);
        points->push_back({static_cast<double>(i) + noise[0], static_cast<double>(j) + noise[1], noise[2]});
      }
    }
  }
  std::vector<std::uint32_t> corners;
  const auto vertex = [columns](std::size_t i, std::size_t j) {
    return static_cast<std::uint32_t>(j * (columns + 1) + i);
  };
  for (std::size_t j = 0; j < rows; ++j) {
    for (std::size_t i = 0; i < columns; ++i) {
      corners.insert(corners.end(), {vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)});
      corners.insert(corners.end(), {vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
    }
  }
  return fixtures::make_motion(fixtures::make_triangles(from.size(), corners), from, to);
}

// Returns the same mesh with its faces in random order. If vertices_too, the vertices are in random order as well.
Motion in_another_order(const Motion& motion, bool vertices_too) {
  const std::size_t vertex_count = motion.topology.vertex_count();
  std::vector<std::size_t> place(vertex_count);
  for (std::size_t v = 0; v < vertex_count; ++v) place[v] = v;
  if (vertices_too) place = test::shuffled_order(vertex_count, 3);
  Motion result = motion;
  for (std::size_t k = 0; k < motion.keyframes.size(); ++k) {
    for (std::size_t v = 0; v < vertex_count; ++v)
      std::copy_n(motion.keyframes[k].positions.data() + 3 * v, 3, result.keyframes[k].positions.data() + 3 * place[v]);
  }
  std::vector<std::uint32_t> corners;
  for (const std::size_t f : test::shuffled_order(motion.topology.face_count(), 4)) {
    for (const std::uint32_t v : motion.topology.face(f)) corners.push_back(static_cast<std::uint32_t>(place[v]));
  }
  result.topology = fixtures::make_triangles(vertex_count, corners);
  return result;
}

TEST(GroupTiles, have_the_public_sums_for_every_count_and_offset) {
  const Motion motion = fixtures::shaken(fixtures::icosphere(2), 0.3, 5);
  const NormalGroups groups = vertices_of(motion);
  for (std::size_t step = kTile; step <= 10 * kTile; step += kTile)
    ASSERT_EQ(difference_on_all_targets(motion.segment(0), groups, 3 * kTile, step), "");
  // The paths around the vertices are open or closed, and of even or odd length. The paths are at every position in a
  // slice (the paths of 16 elements) and at its end.
  for (std::size_t columns = 1; columns < 12; ++columns)
    ASSERT_EQ(difference_on_all_targets(grid(columns, 7)), "") << columns;
}

TEST(GroupTiles, agree_in_any_order_of_faces_and_vertices) {
  for (const Motion& motion : {fixtures::shaken(fixtures::icosphere(2), 0.3, 5), grid(70, 70), grid(250, 60)}) {
    ASSERT_EQ(difference_on_all_targets(in_another_order(motion, false)), "");
    ASSERT_EQ(difference_on_all_targets(in_another_order(motion, true)), "");
    ASSERT_EQ(difference_on_all_targets(in_another_order(motion, true), 1008, 48), "");
  }
}

TEST(GroupTiles, have_the_same_bits_on_all_targets_and_however_faces_are_shuffled) {
  const Motion motion = fixtures::shaken(fixtures::icosphere(3), 0.3, 5), shuffled = in_another_order(motion, false);
  std::vector<ControlTile> first;
  for (const Motion* const one : {&motion, &shuffled}) {
    const NormalGroups groups = vertices_of(*one);
    for (const auto target : supported_targets()) {
      const ScopedTarget scope(target);
      std::vector<ControlTile> tiles((groups.size() + kTile - 1) / kTile);
      GroupTiles(one->segment(0), groups, false).write({0, groups.size()}, tiles);
      if (first.empty()) first = tiles;
      ASSERT_EQ(std::memcmp(first.data(), tiles.data(), tiles.size() * sizeof(ControlTile)), 0) << target_name(target);
    }
  }
}

TEST(GroupTiles, of_copies_and_on_many_threads_make_their_paths_once) {
  const Motion motion = fixtures::shaken(fixtures::icosphere(3), 0.3, 5);
  const NormalGroups groups = vertices_of(motion), copy = groups;
  std::vector<const Rings*> rings(8);
  parallel_for(rings.size(), [&](std::size_t i) { rings[i] = &rings_around(motion.topology, i % 2 ? groups : copy); });
  for (const Rings* const one : rings) EXPECT_EQ(one, rings[0]);
  EXPECT_FALSE(rings[0]->empty());
  EXPECT_TRUE(rings_around(motion.topology, NormalGroups()).empty());
}

TEST(GroupTiles, take_corners_at_creases_and_polygons) {
  for (const bool of_polygons : {false, true}) {
    const Motion motion = fixtures::shaken(of_polygons ? fixtures::box_grid(5) : fixtures::icosphere(2), 0.1, 6);
    ASSERT_EQ(difference_on_all_targets(motion), "");
    for (const double degrees : {0.0, 20.0, 60.0, 180.0}) {
      const auto groups =
          NormalGroups::by_crease_angle(motion, separate_points(motion.topology.vertex_count()), degrees);
      ASSERT_EQ(difference_on_all_targets(motion.segment(0), groups.value()), "");
    }
  }
}

TEST(GroupTiles, are_zero_where_no_face_is) {
  // Only 6 of 100 vertices have faces: vertices 20 to 22 and 60 to 62.
  std::vector<Point> from, to;
  fixtures::Random random(13);
  for (std::size_t v = 0; v < 100; ++v) {
    from.push_back(random.in_cube(1));
    to.push_back(random.in_cube(1));
  }
  const Motion motion = fixtures::make_motion(fixtures::make_triangles(100, {20, 21, 22, 60, 61, 62}), from, to);
  ASSERT_EQ(difference_on_all_targets(motion), "");
  const NormalGroups groups = vertices_of(motion);
  std::vector<ControlTile> tiles(1);
  GroupTiles(motion.segment(0), groups, false).write({0, 16}, tiles);
  EXPECT_EQ(tiles[0].magnitude[3], 0);
  EXPECT_EQ(tiles[0].degree[3], 0);

  const Motion empty = fixtures::make_motion(fixtures::make_triangles(100, {}), from, to);
  ASSERT_EQ(difference_on_all_targets(empty), "");
}

TEST(GroupTiles, take_a_vertex_of_many_faces) {
  for (const std::size_t count :
       std::initializer_list<std::size_t>{15, 16, 17, 21, 22, 31, 32, 33, 63, 64, 65, 700, 5000}) {
    std::vector<Point> from = {{0, 0, 1}}, to = {{0.1, 0.2, 1.5}};
    std::vector<std::uint32_t> corners;
    for (std::size_t i = 0; i < count; ++i) {
      const double angle = 6.283185307179586 * static_cast<double>(i) / static_cast<double>(count);
      from.push_back({std::cos(angle), std::sin(angle), 0});
      to.push_back({std::cos(angle), 2 * std::sin(angle), 0.25});
      corners.insert(corners.end(),
                     {0U, static_cast<std::uint32_t>(1 + i), static_cast<std::uint32_t>(1 + (i + 1) % count)});
    }
    ASSERT_EQ(difference_on_all_targets(fixtures::make_motion(fixtures::make_triangles(count + 1, corners), from, to)),
              "")
        << count;
  }
}

TEST(GroupTiles, have_no_noise_where_faces_cancel) {
  // Every face occurs twice, once in each orientation. In the second case, three faces occur once more.
  for (const std::size_t more : {std::size_t{0}, std::size_t{3}}) {
    Motion motion = fixtures::shaken(fixtures::icosphere(1), 0.3, 7);
    std::vector<std::uint32_t> corners(motion.topology.corners().begin(), motion.topology.corners().end());
    const std::size_t faces = corners.size() / 3;
    for (std::size_t f = 0; f < faces; ++f)
      corners.insert(corners.end(), {corners[3 * f + 1], corners[3 * f], corners[3 * f + 2]});
    for (std::size_t i = 0; i < 3 * more; ++i) corners.push_back(corners[i]);
    motion.topology = fixtures::make_triangles(motion.topology.vertex_count(), corners);
    ASSERT_EQ(difference_on_all_targets(motion), "");
  }
  // Six faces surround a vertex. Other vertices at the same positions have the same faces with the opposite
  // orientation. The path around the second vertex begins at another face, so its sum has other products.
  fixtures::Random random(14);
  std::vector<Point> from = {random.in_cube(1)}, to = {random.in_cube(1)};
  for (std::size_t i = 0; i < 6; ++i) {
    from.push_back(random.in_cube(1));
    to.push_back(random.in_cube(1));
  }
  std::vector<std::uint32_t> corners;
  for (std::uint32_t i = 0; i < 6; ++i) corners.insert(corners.end(), {0, 1 + i, 1 + (i + 1) % 6});
  for (std::uint32_t i = 0; i < 6; ++i) {
    const std::uint32_t place = 1 + (7 - i) % 6;
    from.push_back(from[place]);
    to.push_back(to[place]);
    corners.insert(corners.end(), {0, 7 + i, 7 + (i + 1) % 6});
  }
  ASSERT_EQ(difference_on_all_targets(fixtures::make_motion(fixtures::make_triangles(13, corners), from, to)), "");
  // Each mesh lies in a plane, which is perpendicular to an axis if the slope is 0, and slanted otherwise.
  for (std::size_t k = 0; k < 3; ++k) {
    for (const double slope : {0.0, 1.0, 1.0 / 3}) {
      const Motion flat = test::with_positions(grid(20, 20), [k, slope](const Point& p) {
        Point q = p;
        q[k] = slope * p[(k + 1) % 3];
        return q;
      });
      ASSERT_EQ(difference_on_all_targets(flat), "");
    }
  }
}

TEST(GroupTiles, agree_at_any_scale_and_distance_from_the_origin) {
  for (const double scale : {1e25, 1e19, 1e6, 1e-6, 1e-19, 1e-25, 1e-40}) {
    for (const double offset : {0.0, 1000.0}) {
      const Motion motion = test::with_positions(grid(12, 12), [scale, offset](const Point& p) {
        return Point{scale * (p[0] + offset), scale * (p[1] - offset), scale * p[2]};
      });
      ASSERT_EQ(difference_on_all_targets(motion), "") << scale << " " << offset;
    }
  }
}

// ---- tiles in float32 ----------------------------------------------------------------------------------------------

// Compares the float32 tiles of all elements with sums in double, and adds the differences to `seen`. All instruction
// sets must give the same bits.
void look_at(test::FloatTileFaults& seen, const Segment& segment, const NormalGroups& groups) {
  std::vector<ControlTile> first;
  for (const auto target : supported_targets()) {
    const ScopedTarget scope(target);
    std::vector<ControlTile> tiles((groups.size() + kTile - 1) / kTile);
    GroupTiles(segment, groups, !first.empty()).write_in_float({0, groups.size()}, tiles);
    if (first.empty()) first = tiles;
    if (std::memcmp(first.data(), tiles.data(), tiles.size() * sizeof(ControlTile)) != 0)
      seen.fault = std::string("other bits on ") + target_name(target);
  }
  const Expected expected = expected_of(segment, groups);
  const Rings& rings = rings_around(*segment.topology, groups);
  const auto left_out = rings.left_out();
  for (std::size_t e = 0; e < groups.size(); ++e) {
    const ControlTile& tile = first[e / kTile];
    const std::size_t rows = rings.view().first_row[e / kTile + 1] - rings.view().first_row[e / kTile];
    if (!std::binary_search(left_out.begin(), left_out.end(), static_cast<std::uint32_t>(e))) {
      seen.look_at(tile, e % kTile, expected.normals[e], expected.magnitudes[e], (rows - 1) / 2);
    } else if (!std::isinf(tile.magnitude[e % kTile])) {
      seen.fault = "a bound for element " + std::to_string(e);
    }
  }
}

void look_at(test::FloatTileFaults& seen, const Motion& motion) {
  look_at(seen, motion.segment(0), vertices_of(motion));
}

TEST(FloatGroupTiles, are_off_by_no_more_than_they_say) {
  test::FloatTileFaults seen;
  for (std::size_t columns = 1; columns < 12; ++columns) look_at(seen, grid(columns, 7));
  look_at(seen, grid(60, 60));
  EXPECT_EQ(seen.bending, seen.elements);  // all vertices move, so float32 proves that all curves bend
  EXPECT_LT(seen.largest_bound, 1e-5);
  for (const bool of_polygons : {false, true}) {
    const Motion motion = fixtures::shaken(of_polygons ? fixtures::box_grid(5) : fixtures::icosphere(3), 0.1, 6);
    look_at(seen, motion);
    look_at(seen, motion.segment(0),
            NormalGroups::by_crease_angle(motion, separate_points(motion.topology.vertex_count()), 20).value());
  }
  look_at(seen, in_another_order(grid(70, 70), true));
  EXPECT_EQ(seen.fault, "");
  std::cout << "  largest error: " << seen.largest_share << " of its bound\n";
  EXPECT_GT(seen.largest_share, 0.02);  // shows that the bounds are not uselessly wide
}

TEST(FloatGroupTiles, say_so_of_needles_and_slivers_and_far_from_the_origin) {
  fixtures::Random random(20261125);
  for (int round = 0; round < 60; ++round) {
    test::FloatTileFaults seen;
    const double flat = std::ldexp(1, -static_cast<int>(random.below(24))),
                 scale = std::ldexp(1, static_cast<int>(random.below(60)) - 30), away = random.below(2) == 0 ? 0 : 1000;
    look_at(
        seen, test::with_positions(grid(12, 12), [&](const Point& p) {
          return Point{scale * (p[0] + away), scale * (flat * p[1] - away), scale * p[2] * (round % 3 == 0 ? flat : 1)};
        }));
    ASSERT_EQ(seen.fault, "") << "round " << round;
  }
}

TEST(FloatGroupTiles, leave_a_vertex_of_many_faces_to_double) {
  std::vector<Point> from = {{0, 0, 1}}, to = {{0.1, 0.2, 1.5}};
  std::vector<std::uint32_t> corners;
  constexpr std::uint32_t kCount = 100;
  for (std::uint32_t i = 0; i < kCount; ++i) {
    from.push_back({std::cos(0.06 * i), std::sin(0.06 * i), 0});
    to.push_back({std::cos(0.06 * i), 2 * std::sin(0.06 * i), 0.25});
    corners.insert(corners.end(), {0U, 1 + i, 1 + (i + 1) % kCount});
  }
  test::FloatTileFaults seen;
  look_at(seen, fixtures::make_motion(fixtures::make_triangles(kCount + 1, corners), from, to));
  EXPECT_EQ(seen.fault, "");
  EXPECT_EQ(seen.elements, kCount);  // all elements but vertex 0, which has too many faces
}

TEST(FloatGroupTiles, never_take_a_line_for_a_curve) {
  for (int kind = 0; kind < 4; ++kind) {
    test::FloatTileFaults seen;
    look_at(seen, test::of_low_degree(grid(30, 30), kind));
    EXPECT_EQ(seen.fault, "") << kind;
    EXPECT_EQ(seen.bending, 0U) << kind;
  }
}

TEST(FloatGroupTiles, are_off_by_no_more_than_they_say_where_a_line_stands_for_a_curve) {
  test::expect_lines_within_their_errors(
      grid(30, 30), [](test::FloatTileFaults& seen, const Motion& motion) { look_at(seen, motion); });
}

// Compares elements in double, and the bounds of their errors, with sums of integers of any size. Describes the first
// fault, or returns "". Sets `counted` to the number of elements for which the bounds are useful.
std::string fault_of_bounds(const Segment& segment, const NormalGroups& groups, std::size_t& counted) {
  std::vector<BoundedTile> first;
  for (const auto target : supported_targets()) {
    const ScopedTarget scope(target);
    const GroupTiles writer(segment, groups, false);
    std::vector<BoundedTile> tiles((groups.size() + kTile - 1) / kTile);
    for (std::size_t e = 0; e < groups.size(); e += kTile) {
      BoundedTile& tile = tiles[e / kTile];
      tile.left_out = 0xFFFF;  // stands for the value of an earlier tile, which must be overwritten
      ControlTile rounded;
      writer.write({e, std::min(kTile, groups.size() - e)}, std::span(&rounded, 1), std::span(&tile, 1));
      const std::uint32_t unknown = tile.left_out;
      for (std::size_t lane = 0; lane < kTile; ++lane) {
        const std::size_t i = std::min(e + lane, groups.size() - 1);
        if ((unknown >> lane & 1) != 0) {
          if (groups.faces(i).size() < 22) return "few faces, but unknown";
          continue;
        }
        const ControlNormals c = element_of(tile.normals, lane);
        const BoundedNormals bounded{c, {tile.errors[0][lane], tile.errors[1][lane], tile.errors[2][lane]}};
        if (!(bounded.largest_share() <= 0x1p-30)) continue;
        ++counted;
        const ControlNormals exact = ExactCurve::of_faces(segment, groups.faces(i)).rounded();
        const Vec3d off[] = {c.n0 - exact.n0, c.m - exact.m, c.n1 - exact.n1};
        for (std::size_t k = 0; k < 3; ++k) {
          if (!(max_abs(off[k]) <= bounded.errors[k]))
            return "element " + std::to_string(i) + " is off by " +
                   std::to_string(max_abs(off[k]) / bounded.errors[k]) + " of its bound " + std::to_string(k);
        }
      }
    }
    if (first.empty()) first = tiles;
    for (std::size_t k = 0; k < tiles.size(); ++k) {
      if (std::memcmp(tiles[k].normals, first[k].normals, sizeof(tiles[k].normals)) != 0 ||
          std::memcmp(tiles[k].errors, first[k].errors, sizeof(tiles[k].errors)) != 0)
        return "other bits on " + target_name(target);
    }
  }
  return "";
}

TEST(GroupTiles, bound_the_errors_of_elements_in_double) {
  std::size_t counted = 0;
  for (const double offset : {0.0, 10.0, 1e4, 3e6}) {
    for (const double scale : {1.0, 1e-9, 1e12}) {
      const Motion motion = test::with_positions(grid(12, 12), [scale, offset](const Point& p) {
        return Point{scale * (p[0] + offset), scale * (p[1] - offset), scale * p[2]};
      });
      ASSERT_EQ(fault_of_bounds(motion.segment(0), vertices_of(motion), counted), "") << offset << " " << scale;
    }
  }
  EXPECT_GT(counted, 4000U);
  counted = 0;
  fixtures::Random random(15);
  for (const std::size_t count : std::initializer_list<std::size_t>{3, 4, 5, 17, 40, 63, 64, 200}) {
    std::vector<Point> from = {{1, 2, 3}}, to = {{3, 2, 1}};
    std::vector<std::uint32_t> corners;
    for (std::size_t i = 0; i < count; ++i) {
      from.push_back(random.in_cube(2));
      to.push_back(random.in_cube(2));
      corners.insert(corners.end(),
                     {0U, static_cast<std::uint32_t>(1 + i), static_cast<std::uint32_t>(1 + (i + 1) % count)});
    }
    const Motion motion = fixtures::make_motion(fixtures::make_triangles(count + 1, corners), from, to);
    ASSERT_EQ(fault_of_bounds(motion.segment(0), vertices_of(motion), counted), "") << count;
  }
  EXPECT_GT(counted, 200U);
}

TEST(GroupTiles, have_the_degree_of_the_sum) {
  Motion motion = grid(30, 30);
  auto& to = motion.keyframes[1].positions;
  const auto& from = motion.keyframes[0].positions;
  to = from;
  ASSERT_EQ(difference_on_all_targets(motion), "");
  for (std::size_t i = 0; i < to.size(); ++i) to[i] = i % 3 == 0 ? 4 * from[i] : from[i];
  ASSERT_EQ(difference_on_all_targets(motion), "");
  for (std::size_t i = 0; i < to.size() / 2; ++i) to[i] = from[i];
  ASSERT_EQ(difference_on_all_targets(motion), "");
  for (std::size_t i = 0; i < to.size(); ++i) to[i] = from[i] + static_cast<float>(i % 7) * 1e-6F;
  ASSERT_EQ(difference_on_all_targets(motion), "");
}

TEST(GroupTiles, read_positions_in_planes) {
  const Motion motion = grid(40, 40);
  Segment segment = motion.segment(0);
  const std::size_t n = segment.from.count;
  std::vector<float> planes(6 * n);
  const auto from = VectorView<float>::planes(planes.data(), planes.data() + n, planes.data() + 2 * n, n);
  const auto to = VectorView<float>::planes(planes.data() + 3 * n, planes.data() + 4 * n, planes.data() + 5 * n, n);
  for (std::size_t v = 0; v < n; ++v) {
    from.set(v, segment.from[v]);
    to.set(v, segment.to[v]);
  }
  segment.from = from;
  segment.to = to;
  ASSERT_EQ(difference_on_all_targets(segment, vertices_of(motion)), "");
}

}  // namespace
}  // namespace chronormal::group_tiles_test
