/// Bounds the error of a straight line between two directions, as viewers draw it between two keys, over a piece of a
/// segment. Private: serves the certificates of analysis/certify.h for normals that no scheme made.
#ifndef CHRONORMAL_ANALYSIS_CERTIFICATES_LINE_BOUND_H_
#define CHRONORMAL_ANALYSIS_CERTIFICATES_LINE_BOUND_H_

#include "chronormal/core/vec3.h"
#include "chronormal/normals/control_normals.h"

namespace chronormal::inline internal {

/// The largest error that a viewer may add to a line of unit vectors in float32. It rounds two deltas of up to 2, their
/// weights, and a sum of three terms: less than 25 times 2^-24.
inline constexpr double kViewerRounding = 32 * 0x1p-24;

/// Returns an upper bound of the angle, in radians, between n(t) and the line from `from` (t = a) to `to` (t = b), for
/// all t in [a, b]. The lengths of `from` and `to` may be any. The bound is only as close as necessary to tell whether
/// the angle is at most `enough`. It is 0 if n is zero throughout. Pure.
/// 0 <= a < b <= 1
[[nodiscard]] double line_error(const ControlNormals& normals, double a, double b, const Vec3d& from, const Vec3d& to,
                                double enough) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_CERTIFICATES_LINE_BOUND_H_
