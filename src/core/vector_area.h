/// Computes the normal of a polygon: twice its vector area, so that the length of a flat polygon's normal is twice its
/// area.
///
/// The edges from the first corner cut a polygon p0 ... pn into a fan of triangles, and the normal is the sum of the
/// normals of the triangles,
///
///     n = sum over c = 2 ... n of (p[c-1] - p0) x (p[c] - p0)
///
/// This sum does not depend on the way in which the polygon is cut, even if the polygon is concave or not flat. The
/// formula uses edges from one corner, since the products of positions in Newell's formula would lose the digits of a
/// small polygon far from the origin.
///
/// The edges need not be vectors. Intervals, pairs for both ends of a segment, and polynomials in t are summed by the
/// same function. A caller that bounds the error of n computes its bound in the same loop.
#ifndef CHRONORMAL_CORE_VECTOR_AREA_H_
#define CHRONORMAL_CORE_VECTOR_AREA_H_

#include <cstddef>
#include <utility>

#include "chronormal/core/vec3.h"

namespace chronormal::inline internal {

/// Calls body(e, f) for each triangle of the fan of a polygon, in the order of the corners. e and f are the edges of
/// the triangle from the first corner. edge_to(c) returns the edge to corner c, and is called once for each c = 1 ...
/// corners - 1.
template <class EdgeTo, class Body>
constexpr void for_fan(std::size_t corners, const EdgeTo& edge_to, const Body& body) {
  auto e = edge_to(std::size_t{1});
  for (std::size_t c = 2; c < corners; ++c) {
    auto f = edge_to(c);
    body(std::as_const(e), std::as_const(f));
    e = std::move(f);
  }
}

/// Returns the normal of a polygon with the positions vertex(0) ... vertex(corners - 1), which is twice its vector
/// area. The result may contain rounding errors.
template <class VertexAt>
[[nodiscard]] constexpr auto twice_vector_area(std::size_t corners, const VertexAt& vertex) {
  const auto origin = vertex(std::size_t{0});
  auto sum = decltype(origin - origin){};
  for_fan(
      corners, [&](std::size_t c) { return vertex(c) - origin; },
      [&sum](const auto& e, const auto& f) { sum = sum + cross(e, f); });
  return sum;
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_CORE_VECTOR_AREA_H_
