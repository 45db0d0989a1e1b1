/// Rounds a double to the float32 that a file stores. Private.
///
/// Casting to float and back is not enough: the vectorizer of GCC 12 takes a narrowing and a widening of two values
/// side by side for no operation, so that a vector would stay as precise as it was.
#ifndef CHRONORMAL_CORE_FLOAT32_H_
#define CHRONORMAL_CORE_FLOAT32_H_

#include "chronormal/core/vec3.h"

namespace chronormal::inline internal {

[[nodiscard]] double rounded_to_float(double value) noexcept;
[[nodiscard]] Vec3d rounded_to_float(const Vec3d& vector) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_CORE_FLOAT32_H_
