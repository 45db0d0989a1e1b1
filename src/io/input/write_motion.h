/// Limits the size of the files that write_motion() of io/output.h writes. Private to io, workflow and the program.
#ifndef CHRONORMAL_IO_INPUT_WRITE_MOTION_H_
#define CHRONORMAL_IO_INPUT_WRITE_MOTION_H_

#include <string>

#include "chronormal/core/result.h"
#include "chronormal/motion/motion.h"
#include "io/bytes/expansion.h"

namespace chronormal::inline internal {

/// Writes a motion like write_motion() of io/output.h, but refuses output that is too large for the size of the input.
/// Such output is possible because a file for each keyframe repeats all faces. Errors: also those of expansion.check().
[[nodiscard]] Status write_motion(MotionStream& stream, const std::string& path, bool force, const Expansion& expansion,
                                  bool weld = true);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_INPUT_WRITE_MOTION_H_
