/// Reads sequences: several mesh files with the same topology as the keyframes of a motion. Private to io.
#ifndef CHRONORMAL_IO_INPUT_SEQUENCE_H_
#define CHRONORMAL_IO_INPUT_SEQUENCE_H_

#include <string>
#include <vector>

#include "chronormal/core/result.h"
#include "io/input/input_files.h"

namespace chronormal::inline internal {

/// Returns the paths of the files that the options name, and of all meshes in a folder that the options name. Opens no
/// file. `notes` gets a sentence if the files that the user listed were put into another order. Errors: those of
/// find_input_files() and sort_as_sequence() (io/input/numbering.h); kInvalidInput for a folder without meshes, or with
/// files of two formats.
[[nodiscard]] Result<std::vector<std::string>> find_frames(const InputOptions& options,
                                                           std::vector<std::string>* notes = nullptr);

/// Reads the files that the options select as keyframes, which get the names of their files. Besides the first file, at
/// most one file for each thread is open at a time, and only one topology is kept. The result is valid
/// (motion/motion.h).
///
/// The names of the files give the times (times_of_files() of io/input/numbering.h). Errors: kUsage for a frame rate if
/// the names give times in seconds; the errors of opening files and of the readers, with the frame in the place ("frame
/// 3 (walk_3.obj), line 17"); kInvalidInput for fewer than two files, and if the number of vertices or the faces differ
/// from frame 0.
[[nodiscard]] Result<ReadMotion> read_sequence(const std::vector<std::string>& files, const InputOptions& options);

/// Reads a sequence like read_sequence(), but as a stream. The files of keyframes after the first are read when they
/// are needed, and their errors are reported then. All files are read immediately if they are small
/// (InputOptions::kept_bytes), if one of them is not a regular file, or if the options keep the normals of all
/// keyframes and the first file has normals.
[[nodiscard]] Result<ReadMotion> stream_sequence(const std::vector<std::string>& files, const InputOptions& options);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_INPUT_SEQUENCE_H_
