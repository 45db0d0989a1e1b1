/// Files that are written so that nobody ever sees half of one: any bytes, and motions in the formats that hold them.
///
/// The bytes go to a temporary file in the same folder, which is flushed to disk (fsync) and then renamed: a reader
/// sees the old file or the new one, and after an error the old one and no temporary. A symbolic link is followed: its
/// target is replaced. An existing file keeps its permissions, and its owner where that is allowed; a new one gets what
/// the umask allows. Pipes, devices and /dev/stdout, /dev/stderr, /dev/fd/N are written directly, never renamed over;
/// "-" is the standard output.
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

/// Refuses now what write_output() would refuse later: a folder, or an existing file without force. Meant to be called
/// before a long computation, and before the first of many files.
[[nodiscard]] Status check_output(const std::string& path, bool force);

/// Returns true if write_output() would write to a pipe, a device or a stream of this process, rather than make a file.
[[nodiscard]] bool is_stream(const std::string& path);

/// Writes a whole file.
/// Errors: kFailed with the path as the place: an existing file without force (the message says: --force), a folder,
/// and whatever the system refuses (no space left on device).
[[nodiscard]] Status write_output(const std::string& path, std::string_view bytes, bool force);
/// Writes a file in pieces, which come one after the other, so that bytes in different places need no copy.
[[nodiscard]] Status write_output(const std::string& path, std::span<const std::string_view> pieces, bool force);

/// Removes all temporary files that write_output() is writing now, in any thread: for the handler of a signal that ends
/// the process, which must end it then. It is safe to call from a handler.
void remove_temporaries() noexcept;

/// Returns the names of `count` numbered files. In the file name of pattern, one %d or %0Nd stands for the number, from
/// 0; it may be missing if count is at most 1. Errors: kUsage for a pattern of another form.
[[nodiscard]] Result<std::vector<std::string>> numbered_names(const std::string& pattern, std::size_t count);

/// Returns true if the extension of path names a format that write_motion() writes.
[[nodiscard]] bool is_motion_file(const std::string& path) noexcept;

/// Writes a motion in the format that the extension of path names:
///
///     .npz          whole, with its kind
///     .pc2, .mdd    positions of a sequence without its faces; PC2 gets one frame a second, as open_input() reads it
///     .obj, .ply    every keyframe into a file of its own, of numbered_names(); .ply is binary, little endian
///
/// Precondition: every keyframe has 3 x vertex_count coordinates, or the format is one of the first three.
/// Targets in a .glb get base normals, to which vertices at one point throughout add alike unless `weld` is false.
/// A stream is written as its keyframes are read; errors of the stream are returned, too.
/// Errors: kUsage with path as the place for another extension, a pattern of another form,
/// and a motion that the format does not hold: targets in a point cache, faces of different numbers of corners in .npz.
/// Otherwise those of write_output(); if a file exists and force is not given, nothing is written.
[[nodiscard]] Status write_motion(const Motion& motion, const std::string& path, bool force, bool weld = true);
[[nodiscard]] Status write_motion(MotionStream& stream, const std::string& path, bool force, bool weld = true);

}  // namespace chronormal

#endif  // CHRONORMAL_IO_OUTPUT_H_
