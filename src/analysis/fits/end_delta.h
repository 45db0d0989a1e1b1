/// Finds the best delta for a viewer that can only add one per target: base + w delta, for w in [0, 1].
///
/// A straight line between normals has the right direction at both ends, whatever their lengths: u0 + w (s u1 - u0) for
/// any s > 0. The s that keeps the largest angle to the exact normals smallest is found by a search in one dimension
/// for each element (docs/theory.md, section 4.8). If the normal is of degree 0 or 1 the line is exact: s = |n1| /
/// |n0|.
///
/// Threads    pure: no allocation, no throw.
#ifndef CHRONORMAL_ANALYSIS_FITS_END_DELTA_H_
#define CHRONORMAL_ANALYSIS_FITS_END_DELTA_H_

#include "chronormal/core/vec3.h"
#include "chronormal/normals/control_normals.h"

namespace chronormal::inline internal {

struct EndDelta {
  Vec3d delta;       ///< s u1 - u0, with |u0| = 1
  double scale = 1;  ///< s, in [2^-16, 2^16]
  double error = 0;  ///< the largest angle to the exact direction over [0, 1], radians, to 1e-3 of itself
};

/// Finds the best delta of one element, within 1e-3 of the smallest possible error, and never worse than s = 1. If n0
/// or n1 is zero its limit direction is used (control_normals.h); if all control normals are zero, the delta is zero.
/// If u1 = u0 the direction of the line does not depend on s, and if u1 = -u0 every s has large errors: the result is s
/// = 1 with its error. Cost: about 5 microseconds.
[[nodiscard]] EndDelta best_end_delta(const ControlNormals& normals) noexcept;

/// Returns the largest angle over w in [0, 1] between from + w (to - from) and n(w), in radians, with a relative error
/// of 1e-3. If one of the two jumps to its antipode (as the line does if `to` and `from` are opposite), both sides
/// count. Returns 0 if all control normals are zero. `from` and `to` must not be zero
[[nodiscard]] double largest_line_error(const ControlNormals& normals, const Vec3d& from, const Vec3d& to) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_FITS_END_DELTA_H_
