/// An independent oracle for the normals of vertices and corners, in long double.
///
/// Like reference.h, this file includes no chronormal header and shares no line with src/. If there are several
/// methods, this file uses a slow one. Vector areas are computed from the vertices at t relative to their centre, not
/// by a fan of triangles or by a polynomial. Groups of corners are found by a flood fill over all pairs of corners, not
/// by sorting.
#ifndef CHRONORMAL_TESTS_SUPPORT_REFERENCE_ELEMENTS_H_
#define CHRONORMAL_TESTS_SUPPORT_REFERENCE_ELEMENTS_H_

#include <cmath>
#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/reference.h"

namespace chronormal::reference {

/// A mesh of polygons whose vertices move on straight lines.
struct Mesh {
  std::vector<std::vector<std::size_t>> faces;  ///< vertices of each face
  std::vector<Vector> from, to;                 ///< positions of each vertex
};

/// A corner of a face: `place` is its index in the face.
struct Corner {
  std::size_t face = 0, place = 0;
};

[[nodiscard]] inline std::vector<Corner> corners_of(const Mesh& mesh) {
  std::vector<Corner> corners;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    for (std::size_t i = 0; i < mesh.faces[f].size(); ++i) corners.push_back({f, i});
  }
  return corners;
}

[[nodiscard]] inline std::size_t vertex_of(const Mesh& mesh, const Corner& corner, std::size_t steps = 0) {
  const auto& face = mesh.faces[corner.face];
  return face[(corner.place + steps) % face.size()];
}

[[nodiscard]] inline Vector position(const Mesh& mesh, std::size_t vertex, Real t) {
  return add(scaled(1 - t, mesh.from[vertex]), scaled(t, mesh.to[vertex]));
}

/// Returns twice the vector area of a polygon at t. Returns zero if the vector is not longer than its rounding error.
[[nodiscard]] inline Vector vector_area(const Mesh& mesh, std::size_t face, Real t) {
  const auto& vertices = mesh.faces[face];
  std::vector<Vector> points;
  Vector centre{};
  for (const std::size_t v : vertices) {
    points.push_back(position(mesh, v, t));
    centre = add(centre, scaled(1 / static_cast<Real>(vertices.size()), points.back()));
  }
  Vector sum{};
  Real size = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vector p = subtract(points[i], centre), q = subtract(points[(i + 1) % points.size()], centre);
    sum = add(sum, cross(p, q));
    size += length(p) * length(q);
  }
  return length(sum) > 1e-15L * size ? sum : Vector{};
}

/// Returns what one corner adds to the normal of its element. `weighting` is a name that the command line accepts.
[[nodiscard]] inline Vector contribution(const Mesh& mesh, const Corner& corner, const std::string& weighting, Real t) {
  const Vector area = vector_area(mesh, corner.face, t);
  const Vector here = position(mesh, vertex_of(mesh, corner), t);
  const std::size_t corners = mesh.faces[corner.face].size();
  const Vector next = subtract(position(mesh, vertex_of(mesh, corner, 1), t), here);
  const Vector previous = subtract(position(mesh, vertex_of(mesh, corner, corners - 1), t), here);
  if (weighting == "area" || !(length(area) > 0)) return area;
  if (weighting == "max") {
    const Real squares = dot(next, next) * dot(previous, previous);
    return squares > 0 ? scaled(1 / squares, cross(next, previous)) : Vector{};
  }
  if (weighting == "uniform") return normalised(area);
  if (weighting == "inverse-edges" || weighting == "inverse-roots") {
    const Real edges = length(next) * length(previous);
    if (!(edges > 0)) return {};
    return scaled(std::pow(edges, weighting == "inverse-edges" ? Real(-1) : Real(-0.5L)), normalised(area));
  }
  // Computes the angle by Kahan's formula for half the angle, without a cross product.
  Real corner_angle = 0;
  if (length(next) > 0 && length(previous) > 0) {
    const Vector a = normalised(next), b = normalised(previous);
    corner_angle = 2 * std::atan2(length(subtract(a, b)), length(add(a, b)));
  }
  return scaled(corner_angle, weighting == "angle" ? normalised(area) : area);
}

/// Returns the normal at t of an element with these corners: the sum of the contributions of the corners.
[[nodiscard]] inline Vector element_normal(const Mesh& mesh, const std::vector<Corner>& corners,
                                           const std::string& weighting, Real t) {
  Vector sum{};
  for (const Corner& corner : corners) sum = add(sum, contribution(mesh, corner, weighting, t));
  return sum;
}

/// The corners of an element, in a type that the schemes of reference.h accept in place of a triangle.
struct MovingElement {
  const Mesh& mesh;
  const std::vector<Corner>& corners;
  std::string weighting = "area";
};

[[nodiscard]] inline std::optional<Vector> exact_unit_normal(const MovingElement& element, Real t) {
  const Vector normal = element_normal(element.mesh, element.corners, element.weighting, t);
  if (!(length(normal) > 0)) return std::nullopt;
  return normalised(normal);
}

/// Returns the class of each number from 0 to count - 1, where all numbers that are `related`, directly or through
/// others, are in one class. Classes are numbered in the order of their first members.
[[nodiscard]] inline std::vector<std::size_t> flood(std::size_t count,
                                                    const std::function<bool(std::size_t, std::size_t)>& related) {
  std::vector<std::size_t> class_of(count, count);
  std::size_t classes = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (class_of[i] != count) continue;
    std::vector<std::size_t> wave = {i};
    class_of[i] = classes;
    while (!wave.empty()) {
      const std::size_t reached = wave.back();
      wave.pop_back();
      for (std::size_t k = 0; k < count; ++k) {
        if (class_of[k] == count && related(reached, k)) {
          class_of[k] = classes;
          wave.push_back(k);
        }
      }
    }
    ++classes;
  }
  return class_of;
}

/// Returns the class of each corner. Corners of one class share a normal at a crease angle of `degrees`. point[v] is
/// the number of the point at which vertex v lies, so vertices at one position have the same number. All faces must
/// have normals at t = 0, and no angle may be so close to the crease angle that rounding decides.
[[nodiscard]] inline std::vector<std::size_t> crease_classes(const Mesh& mesh, const std::vector<std::size_t>& point,
                                                             Real degrees) {
  const std::vector<Corner> corners = corners_of(mesh);
  const Real crease = degrees * kPi / 180 + 1e-6L;  // includes the documented tolerance for rounding of positions
  const auto neighbours = [&](const Corner& c) {
    return std::pair{point[vertex_of(mesh, c, 1)], point[vertex_of(mesh, c, mesh.faces[c.face].size() - 1)]};
  };
  return flood(corners.size(), [&](std::size_t i, std::size_t k) {
    const Corner &a = corners[i], &b = corners[k];
    const std::size_t here = point[vertex_of(mesh, a)];
    if (here != point[vertex_of(mesh, b)]) return false;
    const auto [a1, a2] = neighbours(a);
    const auto [b1, b2] = neighbours(b);
    const bool edge = (a1 != here && (a1 == b1 || a1 == b2)) || (a2 != here && (a2 == b1 || a2 == b2));
    if (!edge) return false;
    return a.face == b.face || angle(vector_area(mesh, a.face, 0), vector_area(mesh, b.face, 0)) <= crease;
  });
}

}  // namespace chronormal::reference

#endif  // CHRONORMAL_TESTS_SUPPORT_REFERENCE_ELEMENTS_H_
