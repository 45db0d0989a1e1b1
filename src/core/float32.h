/// Rounds a double to the float32 that a file stores.
///
/// A cast to float and back is not enough. The vectorizer of GCC 12 removes the narrowing and widening of two adjacent
/// values, so a vector would not be rounded.
#ifndef CHRONORMAL_CORE_FLOAT32_H_
#define CHRONORMAL_CORE_FLOAT32_H_

#include "chronormal/core/vec3.h"

namespace chronormal::inline internal {

[[nodiscard]] double rounded_to_float(double value) noexcept;
[[nodiscard]] Vec3d rounded_to_float(const Vec3d& vector) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_CORE_FLOAT32_H_
