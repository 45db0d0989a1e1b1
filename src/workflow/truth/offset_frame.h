/// Measures the offset that an author added to a sum of normals, in a frame that moves with the surface. Private to
/// workflow.
///
/// At a point with the unit sum z of face normals and an edge that leaves the point, a stored normal s has
///
///     alpha      the angle from z to s
///     mean       the mean angle between z and the edges around the point
///     azimuth    the angle around z from the edge to s
///     offset     a point of a plane, alpha / mean from the origin, in the direction of the azimuth
///
/// Blender stores custom normals in this way, and scales alpha as the edges rise towards z or fall away from z.
#ifndef CHRONORMAL_WORKFLOW_TRUTH_OFFSET_FRAME_H_
#define CHRONORMAL_WORKFLOW_TRUTH_OFFSET_FRAME_H_

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "chronormal/core/vec3.h"
#include "core/portable_math.h"

namespace chronormal::inline internal {

struct PlaneOffset {
  double x = 0, y = 0;
};

/// An edge from a vertex to a neighbouring vertex.
struct OffsetEdge {
  std::uint32_t from = 0, to = 0;
};

/// Returns the mean angle, in radians, between z and the edges, where z is the unit sum of face normals at the point
/// that all edges leave. Returns 1 if there is no edge.
template <class PositionOf>
[[nodiscard]] double mean_edge_angle(std::span<const OffsetEdge> edges, const Vec3d& z, const PositionOf& position) {
  double sum = 0;
  std::size_t count = 0;
  for (const OffsetEdge& edge : edges) {
    const Vec3d along = position(edge.to) - position(edge.from);
    if (along == Vec3d{}) continue;
    sum += angle_between(along, z);
    ++count;
  }
  return count > 0 && sum > 0 ? sum / static_cast<double>(count) : 1;
}

/// Returns the direction of azimuth 0 for an edge: perpendicular to z, on the side of z to which the edge leads.
/// Returns zero if the edge is zero or parallel to z.
template <class PositionOf>
[[nodiscard]] Vec3d zero_azimuth(const OffsetEdge& edge, const Vec3d& z, const PositionOf& position) {
  const Vec3d along = unit(position(edge.to) - position(edge.from));
  return unit(along - dot(along, z) * z);
}

/// Returns true if azimuths can be measured from an edge. The edge must be longer than 1e-6 of the longest edge, and
/// its direction must differ from z and -z by more than a degree.
template <class PositionOf>
[[nodiscard]] bool gives_azimuth(std::span<const OffsetEdge> edges, const OffsetEdge& edge, const Vec3d& z,
                                 const PositionOf& position) {
  constexpr double kLeastSine = 0.0175, kLeastLength = 1e-6;
  double longest = 0;
  for (const OffsetEdge& other : edges) longest = std::fmax(longest, length(position(other.to) - position(other.from)));
  const Vec3d along = position(edge.to) - position(edge.from);
  return length(along) > kLeastLength * longest && length(cross(unit(along), z)) > kLeastSine;
}

/// Returns the offset of a normal from z, which is the unit sum of face normals. x is the direction of azimuth 0.
/// `mean` is the mean angle between z and the edges, in radians.
[[nodiscard]] inline PlaneOffset offset_of(const Vec3d& normal, const Vec3d& z, const Vec3d& x, double mean) {
  const Vec3d s = unit(normal), across = unit(s - dot(s, z) * z);
  if (s == Vec3d{} || x == Vec3d{} || across == Vec3d{}) return {};
  const double size = angle_between(s, z) / mean;
  return {size * dot(across, x), size * dot(across, cross(z, x))};
}

/// Returns the unit normal with the given offset from z. The angle between the normal and z is limited to a right
/// angle.
[[nodiscard]] inline Vec3d with_offset(const PlaneOffset& offset, const Vec3d& z, const Vec3d& x, double mean) {
  const double size = portable::hypot(offset.x, offset.y);
  if (size == 0 || x == Vec3d{}) return z;
  constexpr double kRightAngle = 1.5707963267948966;
  const double alpha = std::fmin(size * mean, kRightAngle);
  const Vec3d across = (offset.x / size) * x + (offset.y / size) * cross(z, x);
  return portable::cos(alpha) * z + portable::sin(alpha) * across;
}

/// Moves the offset of the base normal to a key (a target at weight 1), and returns the angle in radians between the
/// result and the stored normal at the key. Measures azimuths from each edge in turn, and returns the smallest angle.
/// In the base, base(vertex) returns positions, z0 is the unit sum, and s0 is the stored normal; at_key(vertex), z and
/// s are the same at the key.
template <class BaseOf, class KeyOf>
[[nodiscard]] double carried_error(std::span<const OffsetEdge> edges, const Vec3d& z0, const Vec3d& s0,
                                   const BaseOf& base, const Vec3d& z, const Vec3d& s, const KeyOf& at_key) {
  constexpr double kNoOffset = 1.7e-4;  // radians, a hundredth of a degree: a smaller angle is no offset
  double least = angle_between(z, s);
  if (angle_between(z0, s0) <= kNoOffset) return least;
  const double mean0 = mean_edge_angle(edges, z0, base), mean = mean_edge_angle(edges, z, at_key);
  bool any = false;
  for (const OffsetEdge& edge : edges) {
    if (!gives_azimuth(edges, edge, z0, base) || !gives_azimuth(edges, edge, z, at_key)) continue;
    const PlaneOffset offset = offset_of(s0, z0, zero_azimuth(edge, z0, base), mean0);
    const double error = angle_between(with_offset(offset, z, zero_azimuth(edge, z, at_key), mean), s);
    least = any ? std::fmin(least, error) : error;
    any = true;
  }
  return least;
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_TRUTH_OFFSET_FRAME_H_
