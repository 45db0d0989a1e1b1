#include "motion/triangles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <iostream>
#include <numeric>
#include <random>
#include <vector>

namespace chronormal::triangles_test {
namespace {

using Place = std::array<std::int64_t, 2>;
using Triangle = std::array<std::uint32_t, 3>;

// Returns twice the signed area of a triangle, as an integer.
std::int64_t area(const Place& a, const Place& b, const Place& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

std::int64_t area(const std::vector<Place>& polygon) {
  std::int64_t sum = 0;
  for (std::size_t i = 2; i < polygon.size(); ++i) sum += area(polygon[0], polygon[i - 1], polygon[i]);
  return sum;
}

bool cross(const Place& a, const Place& b, const Place& c, const Place& d) {
  const auto sign = [](std::int64_t x) { return x > 0 ? 1 : x < 0 ? -1 : 0; };
  const auto is_between = [](const Place& p, const Place& q, const Place& r) {
    return std::min(p[0], q[0]) <= r[0] && r[0] <= std::max(p[0], q[0]) && std::min(p[1], q[1]) <= r[1] &&
           r[1] <= std::max(p[1], q[1]);
  };
  const int s1 = sign(area(a, b, c)), s2 = sign(area(a, b, d)), s3 = sign(area(c, d, a)), s4 = sign(area(c, d, b));
  if (s1 * s2 < 0 && s3 * s4 < 0) return true;
  return (s1 == 0 && is_between(a, b, c)) || (s2 == 0 && is_between(a, b, d)) || (s3 == 0 && is_between(c, d, a)) ||
         (s4 == 0 && is_between(c, d, b));
}

bool is_simple(const std::vector<Place>& polygon) {
  const std::size_t n = polygon.size();
  for (std::size_t i = 0; i < n; ++i) {
    if (polygon[i] == polygon[(i + 1) % n]) return false;
    for (std::size_t j = i + 1; j < n; ++j) {
      const bool are_beside = j == i + 1 || (i == 0 && j + 1 == n);
      if (!are_beside && cross(polygon[i], polygon[(i + 1) % n], polygon[j], polygon[(j + 1) % n])) return false;
    }
  }
  return true;
}

// Puts a plane polygon into space: x and y become two of the three coordinates, and the third coordinate depends
// linearly on x and y.
std::vector<float> in_space(const std::vector<Place>& polygon, std::size_t axis) {
  std::vector<float> positions;
  for (const Place& p : polygon) {
    std::array<float, 3> place{};
    place[(axis + 1) % 3] = static_cast<float>(p[0]);
    place[(axis + 2) % 3] = static_cast<float>(p[1]);
    place[axis] = static_cast<float>(p[0] - p[1]) / 4;
    positions.insert(positions.end(), place.begin(), place.end());
  }
  return positions;
}

std::vector<Triangle> cut(const std::vector<Place>& polygon, std::size_t axis = 2) {
  std::vector<std::uint32_t> face(polygon.size());
  std::iota(face.begin(), face.end(), 0U);
  return triangles_of_face(face, in_space(polygon, axis));
}

// Checks that all triangles are counterclockwise and that their areas add up to the area of the polygon. The sum of
// signed areas is the area of the polygon for every cut, so the triangles then cover the polygon exactly once.
void expect_covers_once(const std::vector<Place>& polygon, std::size_t axis) {
  const std::vector<Triangle> triangles = cut(polygon, axis);
  ASSERT_EQ(triangles.size(), polygon.size() - 2);
  std::int64_t sum = 0;
  std::vector<bool> is_used(polygon.size(), false);
  for (const Triangle& t : triangles) {
    const std::int64_t own = area(polygon[t[0]], polygon[t[1]], polygon[t[2]]);
    ASSERT_GE(own, 0);
    sum += own;
    for (const std::uint32_t corner : t) is_used[corner] = true;
  }
  EXPECT_EQ(sum, area(polygon));
  EXPECT_TRUE(std::all_of(is_used.begin(), is_used.end(), [](bool used) { return used; }));
}

TEST(Triangles, convex_polygons_stay_fans) {
  EXPECT_EQ(cut({{0, 0}, {1, 0}, {1, 1}, {0, 1}}), (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(cut({{0, 0}, {2, 0}, {3, 1}, {2, 2}, {0, 2}}), (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}));
  // A fan from corner 0 covers this polygon, although the angle at corner 0 is concave. The polygon is therefore cut
  // into a fan.
  EXPECT_EQ(cut({{1, 1}, {4, 0}, {1, 4}, {0, 4}, {0, 0}}).front(), (Triangle{0, 1, 2}));
}

TEST(Triangles, an_l_and_a_u_are_covered_once) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    expect_covers_once({{2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}, {0, 0}}, axis);
    expect_covers_once({{0, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}}, axis);
  }
}

TEST(Triangles, a_polygon_that_crosses_itself_or_has_no_area_gets_as_many_triangles) {
  EXPECT_EQ(cut({{0, 0}, {2, 2}, {2, 0}, {0, 2}}).size(), 2U);
  EXPECT_EQ(cut({{0, 0}, {1, 0}, {2, 0}, {1, 0}, {3, 0}}).size(), 3U);
  EXPECT_EQ(cut({{0, 0}, {0, 0}, {0, 0}, {0, 0}}).size(), 2U);
}

TEST(Triangles, polygons_that_are_drawn_are_covered_once) {
  constexpr std::uint32_t kSeed = 5403;
  std::cout << "seed " << kSeed << '\n';
  std::mt19937 random(kSeed);
  std::size_t tried = 0, concave = 0;
  while (tried < 400) {
    // Random points on a small grid become a polygon: parts of the outline are reversed until no two edges cross. Many
    // of the points are on a common line.
    const std::size_t n = 4 + random() % 16;
    const std::int64_t grid = 3 + static_cast<std::int64_t>(random() % 40);
    std::vector<Place> polygon;
    while (polygon.size() < n) {
      const Place p = {static_cast<std::int64_t>(random() % static_cast<std::uint32_t>(grid)),
                       static_cast<std::int64_t>(random() % static_cast<std::uint32_t>(grid))};
      if (std::find(polygon.begin(), polygon.end(), p) == polygon.end())
        polygon.push_back(p);
      else if (static_cast<std::size_t>(grid * grid) < 2 * n)
        break;
    }
    for (int round = 0; round < 300 && !is_simple(polygon); ++round) {
      bool turned = false;
      for (std::size_t i = 0; i + 2 < polygon.size() && !turned; ++i)
        for (std::size_t j = i + 2; j < polygon.size() && !turned; ++j) {
          const std::size_t next = (j + 1) % polygon.size();
          if (next == i || !cross(polygon[i], polygon[i + 1], polygon[j], polygon[next])) continue;
          std::reverse(polygon.begin() + static_cast<std::ptrdiff_t>(i + 1),
                       polygon.begin() + static_cast<std::ptrdiff_t>(j + 1));
          turned = true;
        }
      if (!turned) break;
    }
    if (polygon.size() < 4 || !is_simple(polygon) || area(polygon) == 0) continue;
    if (area(polygon) < 0) std::reverse(polygon.begin(), polygon.end());
    ++tried;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      if (area(polygon[i], polygon[(i + 1) % polygon.size()], polygon[(i + 2) % polygon.size()]) >= 0) continue;
      ++concave;
      break;
    }
    expect_covers_once(polygon, random() % 3);
    if (testing::Test::HasFailure()) return;
  }
  EXPECT_GT(concave, 200U);
}

}  // namespace
}  // namespace chronormal::triangles_test
