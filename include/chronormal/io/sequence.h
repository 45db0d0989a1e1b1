/// Sequences: several mesh files of one topology, the keyframes of one motion.
///
/// An input is one of
///     walk_0.obj     a file; files that are listed one by one keep their order
///     -              the standard input, at most once
///     'walk_*.obj'   a pattern with * ? [..], where no file of that very name exists
///     walk/          a folder: all its .obj files, or all its .ply files
/// Patterns and folders are sorted by number, so that walk_2 stands before walk_10.
///
/// Units      times: seconds; keyframe k is at k / frames_per_second.
#ifndef CHRONORMAL_IO_SEQUENCE_H_
#define CHRONORMAL_IO_SEQUENCE_H_

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/motion/motion.h"

namespace chronormal {

struct SequenceOptions {
  double frames_per_second = 1;  ///< from 1e-9 to 1e9
};

/// The files that the inputs stand for, in order. Does not open them.
/// Errors: kFailed where nothing of that name exists or nothing matches a pattern; kInvalidInput for a folder without
/// mesh files, or with files of two formats; kUsage for "-" twice. The place is the input.
[[nodiscard]] Result<std::vector<std::string>> find_frames(std::span<const std::string> inputs);

/// Reads the files that the inputs stand for as keyframes; each takes the name of its file. The result is valid
/// (validate() in motion/motion.h).
///
/// progress(done, total), if given, is called after each file. Only one file is open at a time, and one topology is
/// kept.
///
/// Errors: those of find_frames(), of opening and of the readers, with the frame in the place ("frame 3 (walk_3.obj),
/// line 17"); kInvalidInput for fewer than two frames, and where vertex count or faces differ from those of frame 0;
/// kUsage for a frame rate out of range.
[[nodiscard]] Result<Motion> read_sequence(
    std::span<const std::string> inputs, const SequenceOptions& options,
    const std::function<void(std::size_t done, std::size_t total)>& progress = {});

/// The names of `count` numbered files. In the file name of pattern, one %d or %0Nd stands for the number, from 0; it
/// may be missing where count is at most 1. Errors: kUsage for a pattern of another form.
[[nodiscard]] Result<std::vector<std::string>> numbered_names(const std::string& pattern, std::size_t count);

/// Writes every keyframe to a file of its own. The files have numbered_names(). The extension chooses the format: .obj,
/// or .ply (binary, little endian). Precondition: every keyframe has 3 x vertex_count coordinates.
///
/// Errors: kUsage for a pattern of another form; else those of write_output(). Where a file exists and force is not
/// given, nothing is written.
[[nodiscard]] Status write_sequence(const Motion& motion, const std::string& pattern, bool force);

}  // namespace chronormal

#endif  // CHRONORMAL_IO_SEQUENCE_H_
