/// Welds the vertices that coincide in all keyframes, and separately the vertices that coincide in keyframe 0. Used by
/// normals and workflow.
#ifndef CHRONORMAL_NORMALS_GROUPS_WELD_H_
#define CHRONORMAL_NORMALS_GROUPS_WELD_H_

#include "chronormal/core/result.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"

namespace chronormal::inline internal {

struct WeldedPoints {
  Points always;    ///< points by weld_coincident(), where vertices that coincide in all keyframes are one point
  Points at_start;  ///< points where vertices that coincide in keyframe 0 are one point
};

/// Welds the vertices of a stream that coincide in all keyframes, and separately the vertices that coincide in keyframe
/// 0, in one pass. If sides are not kept apart (sides.h), all vertices that share a place become one point. Errors:
/// those of the stream.
[[nodiscard]] Result<WeldedPoints> weld_from_start(MotionStream& stream, bool keeps_sides_apart = true);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_GROUPS_WELD_H_
