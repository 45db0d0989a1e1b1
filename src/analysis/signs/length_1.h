/// The norm that bounds of rounding errors use. Private to analysis/signs.
#ifndef CHRONORMAL_ANALYSIS_SIGNS_LENGTH_1_H_
#define CHRONORMAL_ANALYSIS_SIGNS_LENGTH_1_H_

#include <cmath>

#include "chronormal/core/vec3.h"

namespace chronormal::inline internal {

/// Returns |x| + |y| + |z|: a dot product is at most this times the largest component of the other vector.
[[nodiscard]] inline double length_1(const Vec3d& v) { return std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z); }

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_SIGNS_LENGTH_1_H_
