/// Bounds the error of a straight line between two directions, as viewers draw it between two keys, over a piece of a
/// segment. Callers inside the library use this header to certify, as in analysis/certify.h, normals that no scheme
/// made.
#ifndef CHRONORMAL_ANALYSIS_CERTIFICATES_LINE_BOUND_H_
#define CHRONORMAL_ANALYSIS_CERTIFICATES_LINE_BOUND_H_

#include "chronormal/core/vec3.h"
#include "chronormal/normals/control_normals.h"

namespace chronormal::inline internal {

/// The largest error that a viewer adds to a line of unit vectors by computing in float32. The viewer rounds two deltas
/// with lengths of up to 2, their weights, and a sum of three terms. Together these errors are less than 25 times
/// 2^-24.
inline constexpr double kViewerRounding = 32 * 0x1p-24;

/// Returns an upper bound of the angle, in radians, between n(t) and the line from `from` (at t = a) to `to` (at t =
/// b), for all t in [a, b]. `from` and `to` may have any lengths. The bound is only made close enough to tell whether
/// the angle is at most `enough` radians. The bound is 0 if n is zero throughout. Pure. Precondition: 0 <= a < b <= 1.
[[nodiscard]] double line_error(const ControlNormals& normals, double a, double b, const Vec3d& from, const Vec3d& to,
                                double enough) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_CERTIFICATES_LINE_BOUND_H_
