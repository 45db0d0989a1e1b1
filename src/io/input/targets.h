/// Morph targets over a base mesh: a star of segments, one from the base to each target.
///
///     base.obj  +  smile.obj, blink.target.gz, 'mouth_*.target', targets/
///
///     keyframes   0 base (time 0)   1 smile   2 blink   3 mouth_1 ...   (time 1)
///     segments    0 -> 1   0 -> 2   0 -> 3 ...
///
/// A target is a mesh with the faces of the base (.obj, .ply), or what is added to it (io/mesh/make_human_target.h). Inputs
/// are files and patterns as in io/sequence.h, and folders: all targets in a folder and in the folders in it, sorted by
/// path with numbers as numbers; names that begin with a dot and links to folders are passed over. The file of the base
/// itself is passed over wherever it comes among the inputs, so that it may lie in the folder of its targets.
#ifndef CHRONORMAL_IO_INPUT_TARGETS_H_
#define CHRONORMAL_IO_INPUT_TARGETS_H_

#include <cstddef>
#include <functional>
#include <span>
#include <string>

#include "chronormal/core/result.h"
#include "chronormal/motion/motion.h"

namespace chronormal {

/// Reads a base and its targets. A keyframe takes the name of its file without the extensions ("blink"). The result is
/// valid (validate() in motion/motion.h).
///
/// progress(done, total), if given, is called after each file. Only one file is open at a time; memory is 12 bytes per
/// vertex for each target, however few vertices it moves.
///
/// Errors: kFailed for files that are not there or can not be read; kInvalidInput of the readers, for a mesh whose
/// vertex count or faces differ from the base's, for a folder without targets, or with targets of several formats, and
/// where there is no target besides the base; kUsage for "-" twice. The place is the input, or begins with the path of
/// the file ("targets/blink.target, line 17").
[[nodiscard]] Result<Motion> read_targets(
    const std::string& base, std::span<const std::string> inputs,
    const std::function<void(std::size_t done, std::size_t total)>& progress = {});

}  // namespace chronormal

#endif  // CHRONORMAL_IO_INPUT_TARGETS_H_
