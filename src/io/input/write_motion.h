/// Adds a limit of expansion to write_motion() of io/output.h. Private to io, workflow and the program.
#ifndef CHRONORMAL_IO_INPUT_WRITE_MOTION_H_
#define CHRONORMAL_IO_INPUT_WRITE_MOTION_H_

#include <string>

#include "chronormal/core/result.h"
#include "chronormal/motion/motion.h"
#include "io/bytes/expansion.h"

namespace chronormal::inline internal {

/// Writes a motion like write_motion() of io/output.h, but refuses output that exceeds the expansion of the input:
/// files for each keyframe repeat all faces. Errors: also those of expansion.check().
[[nodiscard]] Status write_motion(MotionStream& stream, const std::string& path, bool force, const Expansion& expansion,
                                  bool weld = true);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_INPUT_WRITE_MOTION_H_
