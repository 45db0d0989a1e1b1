// Clips ears in the coordinate plane in which the polygon has the largest area. A product of two float32 is exact in
// double, so the area of a triangle is a sum of six doubles, whose sign can be determined exactly.
#include "motion/triangles.h"

#include <algorithm>
#include <cmath>

namespace chronormal::inline internal {
namespace {

struct Point {
  float x = 0, y = 0;
  friend bool operator==(const Point&, const Point&) = default;
};

// Returns the sign of a sum of doubles. The sum must not overflow. Adds the terms to a list of numbers whose bits do
// not overlap (Shewchuk 1997, Grow-Expansion). The largest number of this list has the sign of the sum.
int sign_of_sum(const std::array<double, 6>& terms) {
  std::array<double, 6> parts{};
  std::size_t count = 0;
  for (const double term : terms) {
    double carried = term;
    for (std::size_t i = 0; i < count; ++i) {
      const double sum = carried + parts[i], of_part = sum - carried;
      parts[i] = (carried - (sum - of_part)) + (parts[i] - of_part);
      carried = sum;
    }
    parts[count++] = carried;
  }
  for (std::size_t i = count; i-- > 0;)
    if (parts[i] != 0) return parts[i] > 0 ? 1 : -1;
  return 0;
}

// Returns 1 if the path a, b, c turns left, -1 if it turns right, and 0 if the three points are on a line.
int turn(const Point& a, const Point& b, const Point& c) {
  const auto product = [](float x, float y) { return double{x} * double{y}; };
  const std::array<double, 6> terms = {product(a.x, b.y),  -product(a.y, b.x), product(b.x, c.y),
                                       -product(b.y, c.x), product(c.x, a.y),  -product(c.y, a.x)};
  double sum = 0, size = 0;
  for (const double term : terms) {
    sum += term;
    size += std::fabs(term);
  }
  if (std::fabs(sum) > 0x1p-50 * size) return sum > 0 ? 1 : -1;
  return sign_of_sum(terms);
}

// Returns the polygon projected to a coordinate plane, with its corners in counter-clockwise order.
std::vector<Point> flattened(std::span<const std::uint32_t> face, std::span<const float> positions) {
  std::array<double, 3> area = {};
  const auto at = [&](std::size_t c, std::size_t axis) { return positions[3 * std::size_t{face[c]} + axis]; };
  for (std::size_t c = 2; c < face.size(); ++c) {
    std::array<double, 3> e{}, f{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      e[axis] = double{at(c - 1, axis)} - double{at(0, axis)};
      f[axis] = double{at(c, axis)} - double{at(0, axis)};
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
      area[axis] += e[u] * f[v] - e[v] * f[u];
    }
  }
  std::size_t axis = 0;
  for (std::size_t other = 1; other < 3; ++other)
    if (std::fabs(area[other]) > std::fabs(area[axis])) axis = other;
  std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
  if (area[axis] < 0) std::swap(u, v);
  std::vector<Point> points;
  points.reserve(face.size());
  for (std::size_t c = 0; c < face.size(); ++c) points.push_back({at(c, u), at(c, v)});
  return points;
}

// Returns true if no triangle of the fan turns right. If the polygon does not cross itself, the fan then covers it
// exactly once.
bool is_fan_of(const std::vector<Point>& points) {
  for (std::size_t c = 2; c < points.size(); ++c)
    if (turn(points[0], points[c - 1], points[c]) < 0) return false;
  return true;
}

std::vector<std::array<std::uint32_t, 3>> fan(std::size_t corners) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  triangles.reserve(corners);
  for (std::uint32_t c = 2; c < corners; ++c) triangles.push_back({0, c - 1, c});
  return triangles;
}

bool is_in_triangle(const Point& p, const Point& a, const Point& b, const Point& c) {
  return turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
}

std::vector<std::array<std::uint32_t, 3>> clipped(const std::vector<Point>& points) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> rest(points.size());
  for (std::uint32_t c = 0; c < rest.size(); ++c) rest[c] = c;
  const auto corner = [&](std::size_t i) { return rest[i % rest.size()]; };
  // Returns true if corner i can be cut off: the polygon turns left there, and no other point is in the triangle of the
  // corner.
  const auto is_ear = [&](std::size_t i) {
    const Point &a = points[corner(i + rest.size() - 1)], &b = points[corner(i)], &c = points[corner(i + 1)];
    if (turn(a, b, c) <= 0) return false;
    return std::none_of(rest.begin(), rest.end(), [&](std::uint32_t other) {
      const Point& p = points[other];
      return p != a && p != b && p != c && is_in_triangle(p, a, b, c);
    });
  };
  const auto is_straight = [&](std::size_t i) {
    return turn(points[corner(i + rest.size() - 1)], points[corner(i)], points[corner(i + 1)]) == 0;
  };
  std::size_t at = 1;
  while (rest.size() > 3) {
    // Ears are cut in turn, so that triangles do not all meet in one corner. If there is no ear, a corner between two
    // edges on one line is cut, whose triangle has no area. A polygon that crosses itself may have neither an ear nor
    // such a corner; then the next corner is cut.
    std::size_t found = rest.size();
    for (std::size_t i = 0; i < rest.size() && found == rest.size(); ++i)
      if (is_ear((at + i) % rest.size())) found = (at + i) % rest.size();
    for (std::size_t i = 0; i < rest.size() && found == rest.size(); ++i)
      if (is_straight((at + i) % rest.size())) found = (at + i) % rest.size();
    if (found == rest.size()) found = at % rest.size();
    triangles.push_back({corner(found + rest.size() - 1), corner(found), corner(found + 1)});
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(found));
    at = found + 1;
  }
  triangles.push_back({rest[0], rest[1], rest[2]});
  return triangles;
}

}  // namespace

bool is_fan(std::span<const std::uint32_t> face, std::span<const float> positions) {
  return face.size() < 4 || is_fan_of(flattened(face, positions));
}

std::vector<std::array<std::uint32_t, 3>> triangles_of_face(std::span<const std::uint32_t> face,
                                                            std::span<const float> positions) {
  if (face.size() < 4 || face.size() > kMostClipped) return fan(face.size());
  const std::vector<Point> points = flattened(face, positions);
  return is_fan_of(points) ? fan(face.size()) : clipped(points);
}

std::vector<std::uint32_t> cut_polygons(const Topology& topology, std::span<const float> positions,
                                        std::span<const std::uint32_t> vertex_of_corner) {
  if (topology.all_triangles()) return {vertex_of_corner.begin(), vertex_of_corner.end()};
  std::vector<std::uint32_t> triangles;
  std::size_t first = 0;
  for (std::size_t f = 0; f < topology.face_count(); ++f) {
    const auto face = topology.face(f);
    for (const auto& triangle : triangles_of_face(face, positions))
      for (const std::uint32_t corner : triangle) triangles.push_back(vertex_of_corner[first + corner]);
    first += face.size();
  }
  return triangles;
}

}  // namespace chronormal::inline internal
