/// The term that one corner adds to the normal of its element, at one t in double.
#ifndef CHRONORMAL_NORMALS_WEIGHTING_CORNER_TERMS_H_
#define CHRONORMAL_NORMALS_WEIGHTING_CORNER_TERMS_H_

#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "chronormal/core/vec3.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/weighting.h"
#include "core/rounding.h"
#include "motion/segment_end.h"
#include "normals/groups/corner_sets.h"

namespace chronormal::inline internal {

/// The vertices of one corner: its own vertex, and the other ends of its two edges.
struct CornerVertices {
  std::uint32_t here, next, previous;
};

[[nodiscard]] inline CornerVertices corner_vertices(const Topology& topology, std::uint32_t corner,
                                                    std::uint32_t f) noexcept {
  const auto face = topology.face(f);
  const std::size_t i = corner - first_corner(topology, f);
  return {face[i], face[i + 1 == face.size() ? 0 : i + 1], face[i == 0 ? face.size() - 1 : i - 1]};
}

/// An edge between two vertices at t, and the size of the terms from which it is computed. The error of the edge is a
/// few times kUnitRoundoff of that size.
struct MovingEdge {
  Vec3d vector;
  double size;

  [[nodiscard]] static MovingEdge at(const Segment& segment, std::uint32_t from, std::uint32_t to,
                                     const LocalTime& t) noexcept {
    const Vec3d e0 = SegmentEnd::from(segment).edge(from, to), e1 = SegmentEnd::to(segment).edge(from, to);
    return {t.rest * e0 + t.t * e1, t.rest * max_abs(e0) + t.t * max_abs(e1)};
  }
};

/// The error of a cross product of two MovingEdges, relative to the product of their sizes, with a margin.
inline constexpr double kCrossError = 32 * kUnitRoundoff;

/// Returns the term that a corner adds to the normal of its element. n is the normal of the face, which must not be
/// zero. If an edge of the corner has length 0, the term is zero for all weightings except area and uniform.
[[nodiscard]] inline Vec3d corner_term(const Segment& segment, const CornerVertices& corner, const Vec3d& n,
                                       Weighting weighting, const LocalTime& t) noexcept {
  if (weighting == Weighting::kArea) return n;
  if (weighting == Weighting::kUniform) return unit(n);
  const MovingEdge e = MovingEdge::at(segment, corner.here, corner.next, t);
  const MovingEdge f = MovingEdge::at(segment, corner.here, corner.previous, t);
  const auto is_rounding = [](const MovingEdge& edge) {
    return without_rounding(edge.vector, kCrossError * edge.size) == Vec3d{};
  };
  if (is_rounding(e) || is_rounding(f)) return {};
  if (weighting == Weighting::kMax) {
    const Vec3d product = without_rounding(cross(e.vector, f.vector), kCrossError * (e.size * f.size));
    return (1 / (dot(e.vector, e.vector) * dot(f.vector, f.vector))) * product;
  }
  if (weighting == Weighting::kInverseEdges || weighting == Weighting::kInverseRoots) {
    const double product = length(e.vector) * length(f.vector);
    return (1 / (weighting == Weighting::kInverseEdges ? product : std::sqrt(product))) * unit(n);
  }
  const double angle = angle_between(e.vector, f.vector);
  return angle * (weighting == Weighting::kAngle ? unit(n) : n);
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_WEIGHTING_CORNER_TERMS_H_
