/// Makes small motions whose normals are hard to compute in double, and some ordinary motions.
///
/// The motions depend only on random numbers, and are the same with every compiler, except for the last bits of
/// std::pow.
#ifndef CHRONORMAL_TESTS_SUPPORT_HARD_MOTIONS_H_
#define CHRONORMAL_TESTS_SUPPORT_HARD_MOTIONS_H_

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "chronormal/motion/motion.h"
#include "tests/support/fixtures.h"

namespace chronormal::test {

using fixtures::Point;
using fixtures::Random;

/// The corners of a triangle at both ends of a segment.
struct MovingTriangle {
  std::array<Point, 3> from{}, to{};
};

/// Returns 10^k for a random k between low and high.
[[nodiscard]] inline double random_decade(Random& random, double low, double high) {
  return std::pow(10, random.uniform(low, high));
}

[[nodiscard]] inline Point scaled_point(double s, const Point& p) { return {s * p[0], s * p[1], s * p[2]}; }

/// Draws a point with integer coordinates of up to 2^10, so that sums of a few coordinates are exact in float32.
[[nodiscard]] inline Point whole_point(Random& random) {
  const auto one = [&random] { return static_cast<double>(random.below(2049)) - 1024; };
  const double x = one(), y = one();
  return {x, y, one()};
}

/// Makes a triangle in which each corner has its own random magnitude between 1e-10 and 1e10 at each end. In a quarter
/// of the triangles, each coordinate is also scaled separately. A third of the triangles stand still.
[[nodiscard]] inline MovingTriangle mixed_scales(Random& random) {
  MovingTriangle triangle;
  const bool stands_still = random.below(3) == 0, each_coordinate = random.below(4) == 0;
  for (std::size_t c = 0; c < 3; ++c) {
    for (Point* p : {&triangle.from[c], &triangle.to[c]}) {
      *p = scaled_point(random_decade(random, -10, 10), random.in_cube(1));
      if (each_coordinate) {
        for (double& x : *p) x *= random_decade(random, -10, 10);
      }
    }
    if (stands_still) triangle.to[c] = triangle.from[c];
  }
  return triangle;
}

/// Makes a triangle with one corner very close to the origin. The other two corners are on a line through the origin,
/// except for rounding to float32.
[[nodiscard]] inline MovingTriangle sliver_at_origin(Random& random) {
  MovingTriangle triangle;
  const double ratio = random.below(2) == 0 ? 2 : random.uniform(0.3, 3);
  for (auto* corners : {&triangle.from, &triangle.to}) {
    (*corners)[0] = scaled_point(random_decade(random, -14, -4), random.in_cube(1));
    (*corners)[1] = random.in_cube(2);
    for (std::size_t k = 0; k < 3; ++k) {
      // Rounds the coordinate to the nearest float or, sometimes, to the next float above or below that.
      const auto b = static_cast<float>((*corners)[1][k]);
      const auto product = static_cast<float>(ratio * static_cast<double>(b));
      const std::array<float, 3> near{product, std::nextafter(product, 10.0F), std::nextafter(product, -10.0F)};
      (*corners)[2][k] = static_cast<double>(near[random.below(5) < 3 ? 0 : 1 + random.below(2)]);
    }
  }
  if (random.below(2) == 0) triangle.to = triangle.from;
  return triangle;
}

/// Makes a triangle whose corner c passes the line through corners a and b at t = 1/2, at a distance of exactly `gap`.
/// Apart from the gap, all coordinates are integers in a plane.
[[nodiscard]] inline MovingTriangle passing_collapse(Random& random, double gap) {
  const Point a = whole_point(random), step = whole_point(random), by = whole_point(random);
  const double along = static_cast<double>(random.below(5)) - 2;
  const std::size_t across = random.below(3);
  MovingTriangle triangle;
  for (std::size_t k = 0; k < 3; ++k) {
    const bool in_plane = k != across;
    const double b = a[k] + step[k], c = a[k] + along * step[k];
    triangle.from[0][k] = triangle.to[0][k] = in_plane ? a[k] : 0;
    triangle.from[1][k] = triangle.to[1][k] = in_plane ? b : 0;
    triangle.from[2][k] = in_plane ? c - by[k] : gap;
    triangle.to[2][k] = in_plane ? c + by[k] : gap;
  }
  return triangle;
}

/// Makes a triangle that shrinks to a point at t = 1 / (1 + r) and grows again, so n(t) has a double zero. Half of the
/// triangles only come close to the point.
[[nodiscard]] inline MovingTriangle double_zero(Random& random) {
  constexpr std::array<double, 5> kRatios{1, 3, 7, 1.0 / 4, 1.5};  // if r is 1.5 or 1/4, 1 / (1 + r) is not a double
  const double r = kRatios[random.below(kRatios.size())];
  const Point center = whole_point(random);
  MovingTriangle triangle;
  for (std::size_t c = 0; c < 3; ++c) {
    const Point offset = whole_point(random);
    for (std::size_t k = 0; k < 3; ++k) {
      triangle.from[c][k] = center[k] + 4 * offset[k];
      triangle.to[c][k] = center[k] - 4 * r * offset[k];
    }
  }
  if (random.below(2) == 0) {
    const double nudge = random_decade(random, -12, 0);
    triangle.to[random.below(3)][random.below(3)] += nudge;
  }
  return triangle;
}

/// Makes a triangle that moves at random in a plane. If the triangle turns over, its normal is zero at some time, and
/// has opposite directions before and after that time.
[[nodiscard]] inline MovingTriangle turning_over(Random& random) {
  MovingTriangle triangle;
  // The triangle moves in a slanted plane, such as z = 7 + slope x - y with an integer slope, or in a plane that is
  // perpendicular to an axis.
  const bool is_whole = random.below(2) == 0;
  const std::size_t across = random.below(3);
  const double slope = static_cast<double>(random.below(4)), height = random.uniform(-1, 1);
  for (auto* corners : {&triangle.from, &triangle.to}) {
    for (Point& p : *corners) {
      p = is_whole ? whole_point(random) : random.in_cube(1);
      p[across] = is_whole ? 7 + slope * p[(across + 1) % 3] - p[(across + 2) % 3] : height;
    }
  }
  return triangle;
}

/// Makes a triangle that has no normal at one or both ends, in most cases. There, the triangle is a line or a point,
/// either exactly or as nearly as float32 allows.
[[nodiscard]] inline MovingTriangle collapsed_at_ends(Random& random) {
  MovingTriangle triangle;
  for (auto* corners : {&triangle.from, &triangle.to}) {
    const bool is_whole = random.below(2) == 0;
    for (Point& p : *corners) p = is_whole ? whole_point(random) : random.in_cube(1);
    const double along = is_whole ? static_cast<double>(random.below(4)) : random.uniform(-1, 2);
    switch (random.below(4)) {
      case 0:
        break;
      case 1:
        (*corners)[1] = (*corners)[2] = (*corners)[0];
        break;
      default:
        for (std::size_t k = 0; k < 3; ++k)
          (*corners)[2][k] = (*corners)[0][k] + along * ((*corners)[1][k] - (*corners)[0][k]);
    }
  }
  if (random.below(6) == 0) triangle.to = triangle.from;
  return triangle;
}

/// Makes an ordinary triangle of any scale and at any distance from the origin, which moves by up to twice its size.
[[nodiscard]] inline MovingTriangle ordinary(Random& random) {
  MovingTriangle triangle;
  const double size = random.below(3) == 0 ? random_decade(random, -44, 38) : 1;
  const double motion = random.below(2) == 0 ? 0.2 : 2;
  const Point offset = scaled_point(random.below(3) == 0 ? random_decade(random, 0, 4) : 0, random.in_cube(1));
  for (std::size_t c = 0; c < 3; ++c) {
    const Point start = random.in_cube(0.5), by = random.in_cube(0.5 * motion);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto in_range = [size](double x) { return std::clamp(size * x, -3e38, 3e38); };
      triangle.from[c][k] = in_range(start[k] + offset[k]);
      triangle.to[c][k] = in_range(start[k] + by[k] + offset[k]);
    }
  }
  return triangle;
}

/// Makes a triangle that comes as close to a collapse as float32 can represent.
[[nodiscard]] inline MovingTriangle grazing(Random& random) {
  MovingTriangle triangle;
  const double when = random.uniform(0.05, 0.95), along = random.uniform(-0.5, 1.5);
  std::array<Point, 3> step{};
  for (std::size_t c = 0; c < 3; ++c) {
    triangle.from[c] = random.in_cube(0.5);
    step[c] = random.in_cube(0.5);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const double a = triangle.from[0][k] + when * step[0][k], b = triangle.from[1][k] + when * step[1][k];
    triangle.from[2][k] = a + along * (b - a) - when * step[2][k];
  }
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t k = 0; k < 3; ++k) triangle.to[c][k] = triangle.from[c][k] + step[c][k];
  }
  return triangle;
}

/// Makes a motion of triangles that share no vertices.
[[nodiscard]] inline Motion soup_of(const std::vector<MovingTriangle>& triangles) {
  std::vector<Point> from, to;
  for (const MovingTriangle& triangle : triangles) {
    from.insert(from.end(), triangle.from.begin(), triangle.from.end());
    to.insert(to.end(), triangle.to.begin(), triangle.to.end());
  }
  return fixtures::make_motion(fixtures::make_soup(triangles.size()), from, to);
}

template <class Make>
[[nodiscard]] Motion soup_of(Random& random, Make make) {
  constexpr std::array<std::size_t, 6> kCounts{1, 1, 2, 5, 17, 33};
  std::vector<MovingTriangle> triangles(kCounts[random.below(kCounts.size())]);
  for (MovingTriangle& triangle : triangles) triangle = make(random);
  return soup_of(triangles);
}

/// Makes two huge faces around vertex 0 whose normals cancel, exactly or nearly, and a small face beside them.
[[nodiscard]] inline Motion cancelling_fan(Random& random) {
  const double huge = random_decade(random, 2, 9), small = random_decade(random, -7, 0);
  std::vector<Point> from{{0, 0, 0}}, to{{0, 0, 0}};
  for (int i = 0; i < 2; ++i) from.push_back(scaled_point(huge, random.in_cube(1)));
  for (int i = 0; i < 2; ++i) from.push_back(scaled_point(small, random.in_cube(1)));
  for (std::size_t v = 1; v < from.size(); ++v) {
    to.push_back(from[v]);
    const double step = (v < 3 ? huge : small) * (random.below(2) == 0 ? 0 : random.uniform(0, 1));
    const Point by = random.in_cube(step);
    for (std::size_t k = 0; k < 3; ++k) to[v][k] += by[k];
  }
  std::vector<std::uint32_t> corners{0, 1, 2, 0, 2, 1, 0, 3, 4};
  if (random.below(2) == 0) {  // replaces the second huge face by a slightly different copy of the first
    for (const std::size_t v : {1U, 2U}) {
      for (auto* points : {&from, &to}) {
        Point copy = (*points)[v];
        for (double& x : copy) x += random.uniform(-1, 1) * huge * 1e-7;
        points->push_back(copy);
      }
    }
    corners[4] = 6;
    corners[5] = 5;
  }
  if (random.below(2) == 0) std::rotate(corners.begin(), corners.begin() + 6, corners.end());
  return fixtures::make_motion(fixtures::make_triangles(from.size(), corners), from, to);
}

/// Makes 4 to 15 faces with only 4 to 8 vertices, so the normals of the faces at a vertex partly cancel. In half of the
/// meshes, some faces are polygons of four to six corners.
[[nodiscard]] inline Motion tangle_of_faces(Random& random) {
  const std::size_t vertices = 4 + random.below(5), faces = 4 + random.below(12);
  std::vector<Point> from, to;
  const bool is_whole = random.below(2) == 0, is_flat = random.below(3) == 0;
  for (std::size_t v = 0; v < vertices; ++v) {
    for (auto* points : {&from, &to}) {
      points->push_back(is_whole ? whole_point(random) : random.in_cube(1));
      if (is_flat) points->back()[2] = 0.7;
    }
  }
  const bool has_quads = random.below(2) == 0;
  std::vector<std::uint32_t> offsets{0}, corners;
  for (std::size_t f = 0; f < faces; ++f) {
    const std::size_t count = has_quads && random.below(2) == 0 ? 4 + random.below(3) : 3;
    for (std::size_t c = 0; c < count; ++c) corners.push_back(static_cast<std::uint32_t>(random.below(vertices)));
    offsets.push_back(static_cast<std::uint32_t>(corners.size()));
  }
  return fixtures::make_motion(fixtures::make_polygons(vertices, std::move(offsets), std::move(corners)), from, to);
}

/// Makes a vertex with many faces, some of which have opposite normals. The sum of these normals has larger rounding
/// errors than a sum over few faces.
[[nodiscard]] inline Motion many_faces(Random& random) {
  const std::size_t rim = 90 + random.below(400);
  const double height = random_decade(random, -9, 0);
  std::vector<Point> from{{0, 0, 0}}, to{{0, 0, height}};
  for (std::size_t v = 0; v < rim; ++v) {
    for (auto* points : {&from, &to}) {
      points->push_back(random.in_cube(1));
      points->back()[2] *= height;
    }
  }
  std::vector<std::uint32_t> corners;
  for (std::uint32_t v = 1; v < rim; ++v) {
    const bool turned = v % 2 == 0;
    for (const std::uint32_t corner : {0U, turned ? v + 1 : v, turned ? v : v + 1}) corners.push_back(corner);
  }
  return fixtures::make_motion(fixtures::make_triangles(rim + 1, std::move(corners)), from, to);
}

/// Makes a fan of faces around vertex 0 whose normals nearly cancel and which hardly move. The rim has integer
/// coordinates in a plane, and returns along the same points, so the rim encloses no area. The height of the rim above
/// the plane is a small integer times a power of two. This height is so small that double loses it in a sum with the
/// height of vertex 0.
[[nodiscard]] inline Motion cancelling_star(Random& random) {
  const std::size_t half = 2 + random.below(6), across = random.below(3);
  const auto small = [&random] { return static_cast<double>(random.below(15)) - 7; };
  const int low = -static_cast<int>(30 + random.below(60)), shift = static_cast<int>(random.below(40)) - 20;
  const bool moves = random.below(3) == 0;  // the fan moves within its plane, by integers
  std::vector<Point> way(half);
  for (Point& p : way)
    for (double& x : p) x = small();
  const Point by = moves ? Point{small(), small(), small()} : Point{};
  std::vector<Point> from, to;
  const auto add = [&](const Point& p, double height0, double height1) {
    Point a = p, b = p;
    for (std::size_t k = 0; k < 3; ++k) b[k] += by[k];
    a[across] = height0;
    b[across] = height1;
    from.push_back(scaled_point(std::ldexp(1.0, shift), a));
    to.push_back(scaled_point(std::ldexp(1.0, shift), b));
  };
  const double height = std::ldexp(1 + static_cast<double>(random.below(7)), -static_cast<int>(random.below(4)));
  add({small(), small(), small()}, height, height);
  const auto next_to_nothing = [&] { return std::ldexp(small(), low); };
  for (std::size_t i = 0; i < 2 * half; ++i) {
    const double height0 = next_to_nothing();
    add(way[i < half ? i : 2 * half - 1 - i], height0, random.below(4) == 0 ? height0 : next_to_nothing());
  }
  std::vector<std::uint32_t> corners;
  const auto rim = static_cast<std::uint32_t>(2 * half);
  for (std::uint32_t v = 0; v < rim; ++v) corners.insert(corners.end(), {0, 1 + v, 1 + (v + 1) % rim});
  return fixtures::make_motion(fixtures::make_triangles(1 + rim, std::move(corners)), from, to);
}

struct HardMotions {
  const char* name;
  Motion (*make)(Random&);
};

[[nodiscard]] inline const std::vector<HardMotions>& hard_motions() {
  static const std::vector<HardMotions> families{
      {"sizes from 1e-10 to 1e10 in one triangle", [](Random& r) { return soup_of(r, mixed_scales); }},
      {"slivers near the origin", [](Random& r) { return soup_of(r, sliver_at_origin); }},
      {"passing a collapse by 1e-9",
       [](Random& r) { return soup_of(r, [](Random& q) { return passing_collapse(q, 1e-9); }); }},
      {"passing a collapse by 1e-12",
       [](Random& r) { return soup_of(r, [](Random& q) { return passing_collapse(q, 1e-12); }); }},
      {"passing a collapse by 1e-20 to 1",
       [](Random& r) { return soup_of(r, [](Random& q) { return passing_collapse(q, random_decade(q, -20, 0)); }); }},
      {"passing a collapse as near as float32 can", [](Random& r) { return soup_of(r, grazing); }},
      {"two huge faces that cancel beside a small one", cancelling_fan},
      {"near a double zero", [](Random& r) { return soup_of(r, double_zero); }},
      {"turning over in a plane", [](Random& r) { return soup_of(r, turning_over); }},
      {"collapsed at the ends", [](Random& r) { return soup_of(r, collapsed_at_ends); }},
      {"hundreds of faces around a vertex", many_faces},
      {"tangles of faces", tangle_of_faces},
      {"ordinary, at any scale", [](Random& r) { return soup_of(r, ordinary); }},
      {"stars whose faces almost cancel", cancelling_star},
  };
  return families;
}

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_HARD_MOTIONS_H_
