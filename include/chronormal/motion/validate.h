/// The one check between data from outside and everything that computes.
#ifndef CHRONORMAL_MOTION_VALIDATE_H_
#define CHRONORMAL_MOTION_VALIDATE_H_

#include "chronormal/core/result.h"
#include "chronormal/motion/motion.h"

namespace chronormal {

/// Checks what the rest of the library takes for granted: at least one face and one segment, every keyframe with
/// 3 x vertex_count finite coordinates, a body for each vertex or none, segments between keyframes that exist, and
/// finite times that ascend along every segment. (A Topology checks its own indices when it is built.)
///
/// Errors: the place names the keyframe (and its file, where known), and the vertex or segment. O(positions).
[[nodiscard]] Status validate(const Motion& motion);

}  // namespace chronormal

#endif  // CHRONORMAL_MOTION_VALIDATE_H_
