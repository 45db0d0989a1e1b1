// Tests which vertices count as one point (welding).

#include "normals/groups/weld.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cstdint>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "chronormal/normals/normal_groups.h"
#include "tests/support/elements.h"
#include "tests/support/fixtures.h"
#include "tests/support/reference_elements.h"

namespace chronormal::weld_test {
namespace {

using fixtures::Point;

Motion two_keyframes(const std::vector<Point>& from, const std::vector<Point>& to) {
  return fixtures::make_motion(fixtures::make_triangles(from.size(), {0, 1, 2}), from, to);
}

TEST(Weld, vertices_that_coincide_in_every_keyframe_are_one_point) {
  const Motion motion = two_keyframes({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 0, 0}, {2, 0, 0}},
                                      {{0, 0, 1}, {1, 0, 1}, {2, 0, 1}, {1, 0, 1}, {2, 0, 2}});
  const Points points = weld_coincident(motion);
  EXPECT_EQ(points.point_of_vertex, (std::vector<std::uint32_t>{0, 1, 2, 1, 3})) << "2 and 4 part";
  EXPECT_EQ(points.count, 4u);
}

TEST(Weld, without_welding_every_vertex_is_a_point) {
  const Points points = separate_points(3);
  EXPECT_EQ(points.point_of_vertex, (std::vector<std::uint32_t>{0, 1, 2}));
  EXPECT_EQ(points.count, 3u);
}

TEST(Weld, minus_zero_is_zero_and_the_next_float_is_not) {
  Motion motion = two_keyframes({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}});
  motion.keyframes[0].positions[3] = -0.0F;
  motion.keyframes[0].positions[7] = std::numeric_limits<float>::denorm_min();
  EXPECT_EQ(weld_coincident(motion).point_of_vertex, (std::vector<std::uint32_t>{0, 0, 1}));
}

TEST(Weld, no_vertices_are_no_points) { EXPECT_EQ(weld_coincident(Motion{}).count, 0u); }

RC_GTEST_PROP(Weld, equals_a_comparison_of_all_pairs, ()) {
  // Vertices have few different positions, so many vertices coincide in one keyframe, and some coincide in both
  // keyframes.
  const auto count = *rc::gen::inRange<std::size_t>(3, 40);
  const auto place = rc::gen::container<Point>(rc::gen::map(rc::gen::inRange(0, 2), [](int k) { return double(k); }));
  const auto from = *rc::gen::container<std::vector<Point>>(count, place);
  const auto to = *rc::gen::container<std::vector<Point>>(count, place);
  const Points points = weld_coincident(two_keyframes(from, to));
  const auto expected =
      reference::flood(count, [&](std::size_t a, std::size_t b) { return from[a] == from[b] && to[a] == to[b]; });
  RC_ASSERT(std::vector<std::size_t>(points.point_of_vertex.begin(), points.point_of_vertex.end()) == expected);
}

TEST(Weld, many_vertices_are_welded_as_a_map_of_places_says) {
  constexpr std::size_t kCount = 40000;
  fixtures::Random random(20261125);
  std::vector<Point> from(kCount), to(kCount);
  for (std::size_t v = 0; v < kCount; ++v) {
    // A third of the vertices share a few thousand positions, and some vertices at one position separate in the second
    // keyframe.
    const auto wide = v % 3 == 0 ? std::size_t{15} : std::size_t{1000};
    for (double& c : from[v]) c = static_cast<double>(random.below(wide));
    to[v] = from[v];
    to[v][0] += static_cast<double>(random.below(2));
  }
  const Motion motion = two_keyframes(from, to);
  MotionStream stream(motion);
  const WeldedPoints welded = weld_from_start(stream).value();
  std::map<Point, std::uint32_t> at_start;
  std::map<std::pair<Point, Point>, std::uint32_t> always;
  for (std::size_t v = 0; v < kCount; ++v) {
    const auto next_start = static_cast<std::uint32_t>(at_start.size()),
               next = static_cast<std::uint32_t>(always.size());
    ASSERT_EQ(welded.at_start.point_of_vertex[v], at_start.try_emplace(from[v], next_start).first->second) << v;
    ASSERT_EQ(welded.always.point_of_vertex[v], always.try_emplace({from[v], to[v]}, next).first->second) << v;
  }
  EXPECT_EQ(welded.at_start.count, at_start.size());
  EXPECT_EQ(welded.always.count, always.size());
  EXPECT_LT(at_start.size(), always.size());
  EXPECT_LT(always.size(), kCount);
}

// The library first sorts positions by a 32-bit key. This test has so many positions that some different positions have
// the same key.
TEST(Weld, places_that_only_look_alike_stay_apart) {
  constexpr std::size_t kCount = 500000;
  Motion motion;
  motion.topology = fixtures::make_triangles(kCount, {0, 1, 2});
  motion.keyframes.resize(1);
  std::vector<float>& positions = motion.keyframes[0].positions;
  for (std::size_t v = 0; v < kCount; ++v) {
    for (const std::size_t c : {v % 1000, v / 1000, 7 * v % 999}) positions.push_back(static_cast<float>(c));
  }
  EXPECT_EQ(weld_coincident(motion).count, kCount);
}

TEST(Weld, vertices_of_two_bodies_are_never_one_point) {
  Motion motion =
      two_keyframes({{0, 0, 0}, {1, 0, 0}, {0, 0, 0}, {0, 0, 0}}, {{2, 0, 0}, {3, 0, 0}, {2, 0, 0}, {2, 0, 0}});
  motion.body_of_vertex = {0, 0, 0, 1};
  EXPECT_EQ(weld_coincident(motion).point_of_vertex, (std::vector<std::uint32_t>{0, 1, 0, 2}));
}

}  // namespace
}  // namespace chronormal::weld_test
