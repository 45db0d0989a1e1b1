/// Welds the vertices that coincide in all keyframes, and also those that coincide in keyframe 0. Private to normals
/// and workflow.
#ifndef CHRONORMAL_NORMALS_GROUPS_WELD_H_
#define CHRONORMAL_NORMALS_GROUPS_WELD_H_

#include "chronormal/core/result.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"

namespace chronormal::inline internal {

struct WeldedPoints {
  Points always;    ///< vertices that coincide in all keyframes are one point, as in weld_coincident()
  Points at_start;  ///< vertices that coincide in keyframe 0 are one point
};

/// Welds the vertices of a stream in both ways at once. If sides are not kept apart (sides.h), vertices are one point
/// wherever they share a place. Errors: from the stream.
[[nodiscard]] Result<WeldedPoints> weld_from_start(MotionStream& stream, bool keeps_sides_apart = true);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_GROUPS_WELD_H_
