/// Finds the best delta for a viewer that can only add one delta per target and renders base + w delta, for w in [0,
/// 1].
///
/// A straight line between two normals of any lengths has the right direction at both ends: u0 + w (s u1 - u0) for any
/// s > 0. A search in one dimension for each element finds the s for which the largest angle to the exact normals is
/// smallest (docs/theory.md, section 4.8). If the normal has degree 0 or 1, the line with s = |n1| / |n0| is exact.
///
/// Threads    pure: no allocation, no throw.
#ifndef CHRONORMAL_ANALYSIS_FITS_END_DELTA_H_
#define CHRONORMAL_ANALYSIS_FITS_END_DELTA_H_

#include "chronormal/core/vec3.h"
#include "chronormal/normals/control_normals.h"

namespace chronormal::inline internal {

struct EndDelta {
  Vec3d delta;       ///< the delta s u1 - u0, where |u0| = 1
  double scale = 1;  ///< the factor s, in [2^-16, 2^16]
  /// The largest angle to the exact direction over [0, 1], in radians, with a relative error of 1e-3.
  double error = 0;
};

/// Finds the best delta s u1 - u0 of one element, with the unit normals u0 and u1 at the two ends. The error of this
/// delta is within 1e-3 of the smallest possible error, and is never larger than that of s = 1. If n0 or n1 is zero,
/// its limit direction is used (control_normals.h). If all control normals are zero, the delta is zero. If u1 = u0, the
/// direction of the line does not depend on s; if u1 = -u0, every s has large errors. In both cases the result is s = 1
/// with its error. Cost: about 5 microseconds.
[[nodiscard]] EndDelta best_end_delta(const ControlNormals& normals) noexcept;

/// Returns the largest angle over w in [0, 1] between from + w (to - from) and n(w), in radians, with a relative error
/// of 1e-3. If the line or n(w) jumps to the opposite direction (as the line does if `to` and `from` are opposite), the
/// directions on both sides of the jump count. Returns 0 if all control normals are zero. Precondition: `from` and `to`
/// are not zero.
[[nodiscard]] double largest_line_error(const ControlNormals& normals, const Vec3d& from, const Vec3d& to) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_FITS_END_DELTA_H_
