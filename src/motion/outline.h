/// The two parts of validate(). One checks a motion without its positions, the other the positions of one keyframe.
#ifndef CHRONORMAL_MOTION_OUTLINE_H_
#define CHRONORMAL_MOTION_OUTLINE_H_

#include <cstddef>
#include <span>

#include "chronormal/core/result.h"
#include "chronormal/motion/motion.h"

namespace chronormal::inline internal {

/// Checks everything in a motion that validate() checks, except positions.
[[nodiscard]] Status validate_outline(const Motion& motion);

/// Checks positions that are to become those of keyframe k.
[[nodiscard]] Status validate_positions(const Motion& motion, std::size_t k, std::span<const float> positions);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_MOTION_OUTLINE_H_
