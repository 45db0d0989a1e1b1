/// Makes motions for tests from a seed. The motions have the same bits with every compiler and standard library.
///
/// Random numbers come directly from std::mt19937_64, whose output the C++ standard prescribes. Distributions of the
/// standard library are not used, since the standard does not prescribe their algorithms. Coordinates that are computed
/// with sin or cos are rounded to a grid that is far coarser than the differences between mathematics libraries.
#ifndef CHRONORMAL_TESTS_SUPPORT_FIXTURES_H_
#define CHRONORMAL_TESTS_SUPPORT_FIXTURES_H_

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

#include "chronormal/motion/motion.h"

namespace chronormal::fixtures {

using Point = std::array<double, 3>;

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  /// Draws a number in [low, high).
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_() >> 11U) * 0x1p-53);
  }

  Point in_cube(double half_size) {
    const double x = uniform(-half_size, half_size);
    const double y = uniform(-half_size, half_size);
    return {x, y, uniform(-half_size, half_size)};
  }

  /// Draws an integer below `bound`. The distribution is almost uniform, which is enough for tests.
  std::size_t below(std::size_t bound) { return static_cast<std::size_t>(engine_() % bound); }

 private:
  std::mt19937_64 engine_;
};

/// Makes a motion of one segment between two keyframes. Throws if the topology is invalid.
[[nodiscard]] inline Motion make_motion(Topology topology, const std::vector<Point>& from,
                                        const std::vector<Point>& to) {
  Motion motion;
  motion.topology = std::move(topology);
  double time = 0;
  for (const auto* points : {&from, &to}) {
    Motion::Keyframe keyframe;
    keyframe.time = time++;
    for (const Point& point : *points) {
      for (const double coordinate : point) keyframe.positions.push_back(static_cast<float>(coordinate));
    }
    motion.keyframes.push_back(std::move(keyframe));
  }
  motion.segments.push_back({0, 1});
  return motion;
}

[[nodiscard]] inline Topology make_triangles(std::size_t vertex_count, std::vector<std::uint32_t> corners) {
  auto topology = Topology::triangles(vertex_count, std::move(corners));
  if (!topology) throw std::logic_error(topology.error().text());
  return std::move(topology).value();
}

[[nodiscard]] inline Topology make_polygons(std::size_t vertex_count, std::vector<std::uint32_t> offsets,
                                            std::vector<std::uint32_t> corners) {
  auto topology = Topology::polygons(vertex_count, std::move(offsets), std::move(corners));
  if (!topology) throw std::logic_error(topology.error().text());
  return std::move(topology).value();
}

/// Makes the topology of triangles that share no vertices. Face f has the corners 3 f, 3 f + 1 and 3 f + 2.
[[nodiscard]] inline Topology make_soup(std::size_t face_count) {
  std::vector<std::uint32_t> corners(3 * face_count);
  for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = static_cast<std::uint32_t>(i);
  return make_triangles(3 * face_count, std::move(corners));
}

/// Makes a sheet of 2 x cells x cells triangles that twists, bends and waves. Normals turn by up to about 90 degrees,
/// and every face moves. The default, cells = 32, gives 2,048 faces.
[[nodiscard]] inline Motion smooth_morph(std::size_t cells = 32) {
  const auto snapped = [](Point p) {
    for (double& c : p) c = std::nearbyint(c * 0x1p20) * 0x1p-20;
    return p;
  };
  std::vector<Point> from, to;
  for (std::size_t j = 0; j <= cells; ++j) {
    for (std::size_t i = 0; i <= cells; ++i) {
      const double x = 2 * static_cast<double>(i) / static_cast<double>(cells) - 1;
      const double y = 2 * static_cast<double>(j) / static_cast<double>(cells) - 1;
      from.push_back(snapped({x, y, 0.15 * std::sin(4 * x + 1) * std::cos(3 * y)}));
      const double wave = 0.2 * std::cos(3 * x - 0.5) * std::sin(5 * y + 2);
      const double twist = 0.3 + 0.9 * x;     // angle about the x axis, in radians
      const double bend = 0.8 * x + 0.2 * y;  // angle about the y axis, in radians, as on a cylinder
      const double ty = y * std::cos(twist) - wave * std::sin(twist);
      const double tz = y * std::sin(twist) + wave * std::cos(twist);
      to.push_back(snapped({1.25 * std::sin(bend) + 0.3 * tz * std::sin(bend), 1.1 * ty + 0.4,
                            1.25 * (1 - std::cos(bend)) + tz * std::cos(bend)}));
    }
  }
  std::vector<std::uint32_t> corners;
  const auto vertex = [cells](std::size_t i, std::size_t j) { return static_cast<std::uint32_t>(j * (cells + 1) + i); };
  for (std::size_t j = 0; j < cells; ++j) {
    for (std::size_t i = 0; i < cells; ++i) {
      corners.insert(corners.end(), {vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)});
      corners.insert(corners.end(), {vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
    }
  }
  const std::size_t vertex_count = from.size();
  return make_motion(make_triangles(vertex_count, std::move(corners)), from, to);
}

/// The properties of random triangles that share no vertices (a soup).
struct SoupOptions {
  std::size_t face_count = 1000;
  std::uint64_t seed = 1;
  double size = 1;  ///< corners are in a cube with this edge length
  /// Each coordinate of a corner moves by up to motion x size. If `motion` is negative, the positions at both ends are
  /// independent.
  double motion = -1;
  double offset = 0;  ///< added to x, y and z at both ends
  double needle = 0;  ///< distance of c from the line through a and b; if 0, c is anywhere
};

/// Makes random triangles that share no vertices.
[[nodiscard]] inline Motion soup(const SoupOptions& options) {
  Random random(options.seed);
  const auto triangle = [&] {
    std::array<Point, 3> corners{};
    for (Point& corner : corners) corner = random.in_cube(0.5);
    if (options.needle > 0) {
      const double along = random.uniform(0.1, 0.9);
      const Point beside = random.in_cube(options.needle);
      for (std::size_t k = 0; k < 3; ++k) {
        corners[2][k] = corners[0][k] + along * (corners[1][k] - corners[0][k]) + beside[k];
      }
    }
    return corners;
  };
  std::vector<Point> from, to;
  for (std::size_t f = 0; f < options.face_count; ++f) {
    std::array<Point, 3> start = triangle(), end = start;
    if (options.motion < 0) {
      end = triangle();
    } else {
      for (Point& corner : end) {
        const Point step = random.in_cube(options.motion);
        for (std::size_t k = 0; k < 3; ++k) corner[k] += step[k];
      }
    }
    for (std::size_t corner = 0; corner < 3; ++corner) {
      for (auto [points, source] : {std::pair{&from, &start[corner]}, std::pair{&to, &end[corner]}}) {
        Point placed = *source;
        for (double& c : placed) c = options.offset + options.size * c;
        points->push_back(placed);
      }
    }
  }
  return make_motion(make_soup(options.face_count), from, to);
}

/// Makes triangles whose positions at both ends are independent, which is the largest possible motion.
[[nodiscard]] inline Motion large_soup(std::size_t face_count = 1000, std::uint64_t seed = 1) {
  return soup({.face_count = face_count, .seed = seed});
}

/// Makes triangles whose corners move by up to a fifth of the size of a triangle.
[[nodiscard]] inline Motion moderate_soup(std::size_t face_count = 1000, std::uint64_t seed = 2) {
  return soup({.face_count = face_count, .seed = seed, .motion = 0.2});
}

/// Makes triangles whose width is 1e-4 of their length, at both ends.
[[nodiscard]] inline Motion needle_soup(std::size_t face_count = 1000, std::uint64_t seed = 3) {
  return soup({.face_count = face_count, .seed = seed, .needle = 1e-4});
}

[[nodiscard]] inline Motion tiny_soup(std::size_t face_count = 1000, std::uint64_t seed = 4) {
  return soup({.face_count = face_count, .seed = seed, .size = 1e-6});
}

[[nodiscard]] inline Motion huge_soup(std::size_t face_count = 1000, std::uint64_t seed = 5) {
  return soup({.face_count = face_count, .seed = seed, .size = 1e6});
}

/// Makes triangles with edges of length about 1 and coordinates around 10,000, where neighbouring floats differ by a
/// thousandth.
[[nodiscard]] inline Motion far_soup(std::size_t face_count = 1000, std::uint64_t seed = 6) {
  return soup({.face_count = face_count, .seed = seed, .offset = 1e4});
}

/// Makes triangles whose normals nearly vanish at some time. Corner c passes the line through corners a and b at a
/// distance of `gap` times the size, at a different time for each face.
[[nodiscard]] inline Motion collapsing_soup(double gap, std::size_t face_count = 1000, std::uint64_t seed = 7) {
  Random random(seed);
  std::vector<Point> from, to;
  for (std::size_t f = 0; f < face_count; ++f) {
    std::array<Point, 3> start{}, step{};
    for (Point& corner : start) corner = random.in_cube(0.5);
    for (Point& corner : step) corner = random.in_cube(0.5);
    const double when = random.uniform(0.05, 0.95), along = random.uniform(-0.5, 1.5);
    const Point beside = random.in_cube(gap);
    for (std::size_t k = 0; k < 3; ++k) {
      const double a = start[0][k] + when * step[0][k], b = start[1][k] + when * step[1][k];
      start[2][k] = a + along * (b - a) + beside[k] - when * step[2][k];
    }
    for (std::size_t corner = 0; corner < 3; ++corner) {
      Point end = start[corner];
      for (std::size_t k = 0; k < 3; ++k) end[k] += step[corner][k];
      from.push_back(start[corner]);
      to.push_back(end);
    }
  }
  return make_motion(make_soup(face_count), from, to);
}

/// Makes triangles whose motions are 1e-9 to 1 times their size, with all orders of magnitude in between. Their n(t)
/// therefore have all degrees, and coefficients of all magnitudes.
[[nodiscard]] inline Motion graded_soup(std::size_t face_count = 1000, std::uint64_t seed = 10) {
  Random random(seed);
  std::vector<Point> from, to;
  for (std::size_t f = 0; f < face_count; ++f) {
    const auto place = static_cast<double>(f) / static_cast<double>(face_count);
    const double step = std::ldexp(1.0, -static_cast<int>(30 * place));
    for (int corner = 0; corner < 3; ++corner) {
      // Begins near the origin, where neighbouring floats are close enough to represent small steps.
      const Point start = random.in_cube(0.5), by = random.in_cube(0.5);
      from.push_back(start);
      to.push_back({start[0] + step * by[0], start[1] + step * by[1], start[2] + step * by[2]});
    }
  }
  return make_motion(make_soup(face_count), from, to);
}

/// Makes needles that are as thin as integer coordinates of 20 bits allow. Two edges have a length of about 2^20. In
/// one of the coordinate planes, the coordinates of the edges are integers, and the edges span an area of 1. If
/// in_plane, the triangles are in this plane; otherwise they are tilted out of the plane.
[[nodiscard]] inline Motion thinnest_soup(bool in_plane, std::size_t face_count = 1000, std::uint64_t seed = 13) {
  Random random(seed);
  const auto some = [&random] { return static_cast<std::int64_t>((1U << 19U) + random.below(1U << 19U)); };
  const auto append = [&](std::vector<Point>& points, std::size_t axis) {
    std::int64_t p = 0, q = 0, r = 0, s = 0;
    for (std::int64_t divisor = 0; divisor != 1;) {  // Euclid's algorithm finds r and s with p s - q r = 1
      p = some();
      q = some();
      std::int64_t a = p, b = q, ar = 1, as = 0, br = 0, bs = 1;  // a = ar p + as q, b = br p + bs q
      while (b != 0) {
        const std::int64_t times = a / b;
        a = std::exchange(b, a - times * b);
        ar = std::exchange(br, ar - times * br);
        as = std::exchange(bs, as - times * bs);
      }
      divisor = a;
      s = ar;
      r = -as;
    }
    std::array<Point, 3> corners{};
    corners[1][axis] = static_cast<double>(p);
    corners[1][(axis + 1) % 3] = static_cast<double>(q);
    corners[2][axis] = static_cast<double>(r);
    corners[2][(axis + 1) % 3] = static_cast<double>(s);
    for (Point& corner : corners) corner[(axis + 2) % 3] = in_plane ? 0 : static_cast<double>(some());
    points.insert(points.end(), corners.begin(), corners.end());
  };
  std::vector<Point> from, to;
  for (std::size_t f = 0; f < face_count; ++f) {
    append(from, f % 3);
    append(to, f % 3);
  }
  return make_motion(make_soup(face_count), from, to);
}

/// Makes triangles that end with corners b and c swapped. The normals at the two ends are opposite, and at t = 1/2
/// there is no normal.
[[nodiscard]] inline Motion inside_out_soup(std::size_t face_count = 1000, std::uint64_t seed = 8) {
  Motion motion = soup({.face_count = face_count, .seed = seed, .motion = 0});
  auto& to = motion.keyframes[1].positions;
  for (std::size_t f = 0; f < face_count; ++f) {
    for (std::size_t k = 0; k < 3; ++k) std::swap(to[9 * f + 3 + k], to[9 * f + 6 + k]);
  }
  return motion;
}

/// Makes triangles that shrink to a point and then grow again as their reflection in this point, so n(t) = (1 - 2 t)^2
/// n0.
[[nodiscard]] inline Motion point_reflected_soup(std::size_t face_count = 1000, std::uint64_t seed = 14) {
  Motion motion = soup({.face_count = face_count, .seed = seed, .motion = 0});
  for (float& c : motion.keyframes[1].positions) c = -c;
  return motion;
}

/// The shape of the triangles of degenerate_soup() at one end of the segment.
enum class Shape { kTriangle, kLine, kPoint };

/// Makes triangles that have the shape `start` at t = 0 and the shape `end` at t = 1. The coordinates are small
/// integers, so the normal of a line is exactly zero. If a triangle moves from one line to another, it has a normal at
/// the times between.
[[nodiscard]] inline Motion degenerate_soup(Shape start, Shape end, std::size_t face_count = 200,
                                            std::uint64_t seed = 9) {
  Random random(seed);
  const auto coordinate = [&random] { return static_cast<double>(random.below(2001)) - 1000; };
  // If the shape is a line, corner c divides the edge from a to b in the ratio `along`. If the ratio were the same at
  // both ends, the corners would be on a line at all times.
  const auto append = [&](std::vector<Point>& points, Shape shape, double along) {
    std::array<Point, 3> corners{};
    for (Point& corner : corners) {
      for (double& c : corner) c = coordinate();
    }
    for (std::size_t k = 0; k < 3; ++k) {
      if (shape == Shape::kLine) corners[2][k] = corners[0][k] + along * (corners[1][k] - corners[0][k]);
      if (shape == Shape::kPoint) corners[1][k] = corners[2][k] = corners[0][k];
    }
    points.insert(points.end(), corners.begin(), corners.end());
  };
  std::vector<Point> from, to;
  for (std::size_t f = 0; f < face_count; ++f) {
    append(from, start, static_cast<double>(random.below(3)));
    append(to, end, -1 - static_cast<double>(random.below(3)));
  }
  return make_motion(make_soup(face_count), from, to);
}

/// A closed mesh: its points, and its faces as a topology.
struct ClosedMesh {
  std::vector<Point> points;
  Topology topology;
};

/// Makes a sphere of 20 x 4^subdivisions triangles. Its points are on the unit sphere, except for rounding.
[[nodiscard]] inline ClosedMesh icosphere(int subdivisions = 2) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  std::vector<Point> points{{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                            {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  std::vector<std::uint32_t> corners{0, 11, 5,  0, 5,  1, 0, 1, 7, 0, 7,  10, 0, 10, 11, 1, 5, 9, 5, 11,
                                     4, 11, 10, 2, 10, 7, 6, 7, 1, 8, 3,  9,  4, 3,  4,  2, 3, 2, 6, 3,
                                     6, 8,  3,  8, 9,  4, 9, 5, 2, 4, 11, 6,  2, 10, 8,  6, 7, 9, 8, 1};
  for (int round = 0; round < subdivisions; ++round) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [found, is_new] = middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(points.size()));
      if (is_new) {
        Point sum{};
        for (std::size_t k = 0; k < 3; ++k) sum[k] = (points[a][k] + points[b][k]) / 2;
        points.push_back(sum);
      }
      return found->second;
    };
    std::vector<std::uint32_t> finer;
    for (std::size_t f = 0; f < corners.size(); f += 3) {
      const std::uint32_t a = corners[f], b = corners[f + 1], c = corners[f + 2];
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca});
    }
    corners = std::move(finer);
  }
  for (Point& p : points) {
    const double r = std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    for (double& c : p) c /= r;
  }
  const std::size_t vertex_count = points.size();
  return {std::move(points), make_triangles(vertex_count, std::move(corners))};
}

/// Makes the surface of the cube [-1, 1]^3 as a closed mesh of 6 x cells x cells quads.
[[nodiscard]] inline ClosedMesh box_grid(std::size_t cells = 4) {
  std::map<std::array<std::size_t, 3>, std::uint32_t> numbers;
  std::vector<Point> points;
  const auto vertex = [&](const std::array<std::size_t, 3>& at) {
    const auto [found, is_new] = numbers.try_emplace(at, static_cast<std::uint32_t>(points.size()));
    if (is_new) {
      Point p{};
      for (std::size_t k = 0; k < 3; ++k) p[k] = 2 * static_cast<double>(at[k]) / static_cast<double>(cells) - 1;
      points.push_back(p);
    }
    return found->second;
  };
  std::vector<std::uint32_t> corners, offsets{0};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (const std::size_t side : {std::size_t{0}, cells}) {
      for (std::size_t i = 0; i < cells; ++i) {
        for (std::size_t j = 0; j < cells; ++j) {
          std::array<std::array<std::size_t, 3>, 4> quad{};
          for (std::size_t c = 0; c < 4; ++c) {
            quad[c][axis] = side;
            quad[c][u] = i + (c == 1 || c == 2 ? 1 : 0);
            quad[c][v] = j + (c >= 2 ? 1 : 0);
          }
          if (side == 0) std::swap(quad[1], quad[3]);  // makes the faces on both of the opposite sides point outwards
          for (const auto& corner : quad) corners.push_back(vertex(corner));
          offsets.push_back(static_cast<std::uint32_t>(corners.size()));
        }
      }
    }
  }
  const std::size_t vertex_count = points.size();
  return {std::move(points), make_polygons(vertex_count, std::move(offsets), std::move(corners))};
}

/// Moves every vertex of a closed mesh in a random direction, by up to `distance` in each coordinate.
[[nodiscard]] inline Motion shaken(const ClosedMesh& mesh, double distance, std::uint64_t seed) {
  Random random(seed);
  std::vector<Point> to = mesh.points;
  for (Point& p : to) {
    const Point step = random.in_cube(distance);
    for (std::size_t k = 0; k < 3; ++k) p[k] += step[k];
  }
  return make_motion(mesh.topology, mesh.points, to);
}

}  // namespace chronormal::fixtures

#endif  // CHRONORMAL_TESTS_SUPPORT_FIXTURES_H_
