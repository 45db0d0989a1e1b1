/// The two parts of validate(): one function checks a motion without its positions, and one checks the positions of a
/// keyframe.
#ifndef CHRONORMAL_MOTION_OUTLINE_H_
#define CHRONORMAL_MOTION_OUTLINE_H_

#include <cstddef>
#include <span>

#include "chronormal/core/result.h"
#include "chronormal/motion/motion.h"

namespace chronormal::inline internal {

/// Checks everything in a motion that validate() checks, except positions.
[[nodiscard]] Status validate_outline(const Motion& motion);

/// Checks positions before they become the positions of keyframe k.
[[nodiscard]] Status validate_positions(const Motion& motion, std::size_t k, std::span<const float> positions);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_MOTION_OUTLINE_H_
