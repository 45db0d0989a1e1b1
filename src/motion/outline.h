/// The two parts of validate(): one checks a motion without its positions, the other the positions of one keyframe.
/// Private.
#ifndef CHRONORMAL_MOTION_OUTLINE_H_
#define CHRONORMAL_MOTION_OUTLINE_H_

#include <cstddef>
#include <span>

#include "chronormal/core/result.h"
#include "chronormal/motion/motion.h"

namespace chronormal::inline internal {

/// Checks everything that validate() checks, except positions.
[[nodiscard]] Status validate_outline(const Motion& motion);

/// Checks positions that keyframe k is to get.
[[nodiscard]] Status validate_positions(const Motion& motion, std::size_t k, std::span<const float> positions);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_MOTION_OUTLINE_H_
