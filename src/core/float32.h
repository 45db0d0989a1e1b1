/// A double as a float32 keeps it: what a file holds of it. Private.
///
/// Casting to float and back is not enough: GCC 12 makes nothing of two such casts side by side (the vectorizer of
/// straight code takes a narrowing and a widening of a pair for no operation), so that a vector stays as precise as it
/// was.
#ifndef CHRONORMAL_CORE_FLOAT32_H_
#define CHRONORMAL_CORE_FLOAT32_H_

#include "chronormal/core/vec3.h"

namespace chronormal::inline internal {

[[nodiscard]] double rounded_to_float(double value) noexcept;
[[nodiscard]] Vec3d rounded_to_float(const Vec3d& vector) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_CORE_FLOAT32_H_
