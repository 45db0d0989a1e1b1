/// How far a straight line between two directions, as viewers draw it between two keys, is from the normal over a piece
/// of a segment. Private: certificates of analysis/certify.h for what is no scheme.
#ifndef CHRONORMAL_ANALYSIS_CERTIFICATES_LINE_BOUND_H_
#define CHRONORMAL_ANALYSIS_CERTIFICATES_LINE_BOUND_H_

#include "chronormal/core/vec3.h"
#include "chronormal/normals/control_normals.h"

namespace chronormal::inline internal {

/// What a viewer may add to a line of unit vectors, in float32: two deltas of up to 2 are rounded, their weights, and a
/// sum of three terms, whose rounding is below 25 of 2^-24.
inline constexpr double kViewerRounding = 32 * 0x1p-24;

/// An upper bound of the angle, in radians, between n(t) and the line from `from` (t = a) to `to` (t = b), for all t in
/// [a, b] and at any length of the two. It is as close as it has to be: at most `enough`, or above it for sure. 0 where
/// n is zero throughout. Pure.
/// 0 <= a < b <= 1
[[nodiscard]] double line_error(const ControlNormals& normals, double a, double b, const Vec3d& from, const Vec3d& to,
                                double enough) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_CERTIFICATES_LINE_BOUND_H_
