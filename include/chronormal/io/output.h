/// Writes files atomically, so that no reader ever sees an incomplete file. There are functions for any bytes, and for
/// motions in several formats.
///
/// The bytes go to a temporary file in the same folder, which is flushed to disk (fsync) and then renamed. So a reader
/// sees either the old file or the new one. After an error the old file is still there, and no temporary file remains.
/// A symbolic link is followed: its target is replaced. An existing file keeps its permissions, and its owner if the
/// system allows that; a new file gets the permissions that the umask allows. Pipes, devices and /dev/stdout,
/// /dev/stderr, /dev/fd/N are written directly, and no file is renamed over them; "-" is the standard output.
///
/// Threads    functions on different paths may run at the same time.
#ifndef CHRONORMAL_IO_OUTPUT_H_
#define CHRONORMAL_IO_OUTPUT_H_

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/motion/motion.h"

namespace chronormal {

/// Returns the errors that write_output() would return later for a path: for a folder, or for an existing file without
/// `force`. Call it before a long computation, and before the first of many files.
[[nodiscard]] Status check_output(const std::string& path, bool force);

/// Returns true if write_output() would write to a pipe, a device or a stream of this process, rather than make a file.
[[nodiscard]] bool is_stream(const std::string& path);

/// Writes a whole file. Errors: kFailed with the path as the place, for an existing file without `force` (the message
/// names the option --force), for a folder, and for errors of the system, such as a full disk.
[[nodiscard]] Status write_output(const std::string& path, std::string_view bytes, bool force);
/// Writes a file from several pieces, one after the other, so that the caller need not copy them into one piece.
[[nodiscard]] Status write_output(const std::string& path, std::span<const std::string_view> pieces, bool force);

/// Removes the temporary files that write_output() is writing at the moment in all threads. A signal handler may call
/// this function, and must then end the process.
void remove_temporaries() noexcept;

/// Returns the names of `count` numbered files. One %d or %0Nd in the file name is replaced by the number, counted from
/// 0. A pattern without %d is valid if `count` is at most 1. Errors: kUsage for any other pattern.
[[nodiscard]] Result<std::vector<std::string>> numbered_names(const std::string& pattern, std::size_t count);

/// Returns true if the extension of the path names a format that write_motion() can write.
[[nodiscard]] bool is_motion_file(const std::string& path) noexcept;

/// Writes a motion in the format that the extension of path names:
///
///     .npz          the whole motion, and whether it is a sequence or a set of targets
///     .pc2, .mdd    positions of a sequence without its faces; PC2 gets one frame per second, as open_input() reads it
///     .obj, .ply    every keyframe in its own file, named by numbered_names(); .ply is binary, little endian
///     .glb          a set of targets over a base
///
/// Precondition: every keyframe has 3 x vertex_count coordinates, or the format is .npz, .pc2 or .mdd. A .glb gets base
/// normals, which vertices at the same point in all keyframes share unless `weld` is false. A stream is written as its
/// keyframes are read; errors of the stream are returned, too.
/// Errors: kUsage, with the path as the place, for another extension, for an invalid pattern, and for a motion that the
/// format cannot represent: targets in a point cache, a sequence in .glb, or faces with different numbers of corners in
/// .npz. Otherwise those of write_output(); if a file exists and `force` is false, nothing is written.
[[nodiscard]] Status write_motion(const Motion& motion, const std::string& path, bool force, bool weld = true);
[[nodiscard]] Status write_motion(MotionStream& stream, const std::string& path, bool force, bool weld = true);

}  // namespace chronormal

#endif  // CHRONORMAL_IO_OUTPUT_H_
