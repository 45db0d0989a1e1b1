/// One end of a segment in full precision: float32 positions, and the residuals of their rounding if the motion was
/// computed (motion/motion.h). All code that computes normals in double or in integers reads positions here. Code that
/// loads float32 positions directly must call fits_lanes() first.
#ifndef CHRONORMAL_MOTION_SEGMENT_END_H_
#define CHRONORMAL_MOTION_SEGMENT_END_H_

#include <cstddef>

#include "chronormal/core/vec3.h"
#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"
#include "core/twofold.h"

namespace chronormal::inline internal {

class SegmentEnd {
 public:
  [[nodiscard]] static SegmentEnd from(const Segment& segment) noexcept {
    return {segment.from, segment.from_residuals};
  }
  [[nodiscard]] static SegmentEnd to(const Segment& segment) noexcept { return {segment.to, segment.to_residuals}; }

  /// Returns the position of a vertex, rounded to double.
  [[nodiscard]] Vec3d operator[](std::size_t vertex) const noexcept {
    const Vec3d position = to_double(positions_[vertex]);
    return has_residuals() ? position + residuals_[vertex] : position;
  }

  /// Returns the position of a vertex without its residual.
  [[nodiscard]] Vec3f position(std::size_t vertex) const noexcept { return positions_[vertex]; }

  /// Return the vector from vertex a to vertex b, and the vector from a vertex to a point. Each component is rounded
  /// once, also far from the origin. With residuals, the error is slightly larger than one rounding (core/twofold.h).
  [[nodiscard]] Vec3d edge(std::size_t a, std::size_t b) const noexcept {
    const Vec3d p = to_double(positions_[a]), q = to_double(positions_[b]);
    return has_residuals() ? difference(q, residuals_[b], p, residuals_[a]) : q - p;
  }
  [[nodiscard]] Vec3d way_to(const Vec3d& point, std::size_t vertex) const noexcept {
    const Vec3d p = to_double(positions_[vertex]);
    return has_residuals() ? difference(point, {}, p, residuals_[vertex]) : point - p;
  }
  /// Returns the vector from vertex a at the other end of the segment to vertex b at this end.
  [[nodiscard]] Vec3d way_from(const SegmentEnd& other, std::size_t a, std::size_t b) const noexcept {
    const Vec3d p = to_double(other.positions_[a]), q = to_double(positions_[b]);
    if (!has_residuals() && !other.has_residuals()) return q - p;
    return difference(q, residual(b), p, other.residual(a));
  }

  /// Calls body(part) for vectors of floats whose sum is the exact position of a vertex.
  template <class Body>
  void for_parts(std::size_t vertex, const Body& body) const {
    body(positions_[vertex]);
    if (!has_residuals()) return;
    Vec3d left = residuals_[vertex];
    for (Vec3f part = to_float(left); part != Vec3f{}; part = to_float(left)) {
      body(part);
      left = left - to_double(part);
    }
  }
  // A position takes one float, and a residual of 53 bits takes up to three floats of 24 bits.
  static constexpr std::size_t kMostParts = 4;

  [[nodiscard]] Vec3d residual(std::size_t vertex) const noexcept {
    return has_residuals() ? residuals_[vertex] : Vec3d{};
  }

 private:
  SegmentEnd(const VectorView<const float>& positions, const VectorView<const double>& residuals) noexcept
      : positions_(positions), residuals_(residuals) {}

  [[nodiscard]] bool has_residuals() const noexcept { return residuals_.count > 0; }

  static Vec3d difference(const Vec3d& a, const Vec3d& a_low, const Vec3d& b, const Vec3d& b_low) noexcept {
    return {chronormal::difference(a.x, a_low.x, b.x, b_low.x), chronormal::difference(a.y, a_low.y, b.y, b_low.y),
            chronormal::difference(a.z, a_low.z, b.z, b_low.z)};
  }

  VectorView<const float> positions_;
  VectorView<const double> residuals_;
};

[[nodiscard]] inline bool has_residuals(const Segment& segment) noexcept {
  return segment.from_residuals.count > 0 || segment.to_residuals.count > 0;
}

/// Returns true if SIMD lanes can process the faces of a segment, which they can if all faces are triangles and all
/// positions are float32 without residuals.
[[nodiscard]] inline bool fits_lanes(const Segment& segment) noexcept {
  return segment.topology->all_triangles() && !has_residuals(segment);
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_MOTION_SEGMENT_END_H_
