/// The norm that the bounds of rounding errors in analysis/signs use.
#ifndef CHRONORMAL_ANALYSIS_SIGNS_LENGTH_1_H_
#define CHRONORMAL_ANALYSIS_SIGNS_LENGTH_1_H_

#include <cmath>

#include "chronormal/core/vec3.h"

namespace chronormal::inline internal {

/// Returns |x| + |y| + |z|. A dot product is at most this norm times the largest absolute component of the other
/// vector.
[[nodiscard]] inline double length_1(const Vec3d& v) { return std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z); }

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_SIGNS_LENGTH_1_H_
