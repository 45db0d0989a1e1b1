/// Reads morph targets over a base mesh as a motion, with a segment from the base to each target. Private to io.
///
///     base.obj  +  smile.obj, blink.target.gz, 'mouth_*.target', targets/
///
///     keyframes   0 base   1 smile   2 blink   3 mouth_1 ...
///     segments    0 -> 1   0 -> 2   0 -> 3 ...
///
/// A target is a mesh with the faces of the base (.obj, .ply), or deltas that are added to the base
/// (io/mesh/make_human_target.h). Inputs are files and patterns as in io/input.h, and folders. A folder stands for all
/// targets in it and its subfolders, sorted by path, where digits are compared as numbers. Names that begin with a dot
/// and links to folders are skipped. The file of the base itself is skipped wherever it comes among the inputs, so that
/// it may be in the folder of its targets.
#ifndef CHRONORMAL_IO_INPUT_TARGETS_H_
#define CHRONORMAL_IO_INPUT_TARGETS_H_

#include "chronormal/core/result.h"
#include "io/input/input_files.h"

namespace chronormal::inline internal {

/// Reads the base and the targets of the options. A keyframe gets the name of its file without the extensions
/// ("blink"). The result is valid (motion/motion.h). Only one file is open at a time. Each target takes 12 bytes of
/// memory per vertex, even if it moves few vertices.
///
/// The place of an error is the input, or begins with the path of the file ("targets/blink.target, line 17"). Errors:
/// kFailed for files that are missing or cannot be read; kInvalidInput of the readers, for a mesh whose number of
/// vertices or whose faces differ from the base, for a folder without targets or with targets of several formats, and
/// if there is no target besides the base; kUsage for "-" twice.
[[nodiscard]] Result<ReadMotion> read_targets(const InputOptions& options);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_INPUT_TARGETS_H_
