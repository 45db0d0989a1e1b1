/// Whole files as bytes: in by memory mapping, out so that nobody ever sees half of one.
///
/// Threads    functions on different paths may run at the same time.
#ifndef CHRONORMAL_IO_FILE_H_
#define CHRONORMAL_IO_FILE_H_

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "chronormal/core/result.h"

namespace chronormal {

/// The bytes of a file, as long as the object lives. Regular files are mapped (another program must not shorten the
/// file meanwhile), pipes and devices are read to their end.
class FileBytes {
 public:
  /// Opens a file; "-" is the standard input.
  /// Errors: kFailed with the path as the place: not found, not readable, a folder.
  [[nodiscard]] static Result<FileBytes> open(const std::string& path);

  FileBytes(FileBytes&& other) noexcept;
  FileBytes& operator=(FileBytes&& other) noexcept;
  FileBytes(const FileBytes&) = delete;
  FileBytes& operator=(const FileBytes&) = delete;
  ~FileBytes();

  /// Gives memory back that holds what was read of a mapped file. Its bytes stay valid: who looks at them again makes
  /// the system read them again.
  void release() const noexcept;

  /// All bytes; valid until the object is destroyed or moved from.
  [[nodiscard]] std::string_view bytes() const noexcept {
    return mapping_ != nullptr ? std::string_view(static_cast<const char*>(mapping_), mapping_size_) : owned_;
  }

 private:
  FileBytes() = default;

  void* mapping_ = nullptr;
  std::size_t mapping_size_ = 0;
  std::string owned_;  // where nothing is mapped
};

/// Refuses now what write_output() would refuse later: a folder, or an existing file without force. Asks before a long
/// computation, and before the first of many files.
[[nodiscard]] Status check_output(const std::string& path, bool force);

/// Whether write_output() would write to a pipe, a device or a stream of this process, rather than make a file.
[[nodiscard]] bool is_stream(const std::string& path);

/// Writes a whole file; "-" is the standard output.
///
/// The bytes go to a temporary file in the same folder, which is flushed to disk (fsync) and then renamed: a reader
/// sees the old file or the new one, and after an error the old one and no temporary. A symbolic link is followed: its
/// target is replaced. An existing file keeps its permissions, and its owner where that is allowed; a new one gets what
/// the umask allows. Pipes, devices and /dev/stdout, /dev/stderr, /dev/fd/N are written directly, never renamed over.
///
/// Errors: kFailed with the path as the place: an existing file without force (the message says: --force), a folder,
/// and whatever the system refuses (no space left on device).
[[nodiscard]] Status write_output(const std::string& path, std::string_view bytes, bool force);
/// The same of a file in pieces, which come one after the other: what lies elsewhere already needs no copy.
[[nodiscard]] Status write_output(const std::string& path, std::span<const std::string_view> pieces, bool force);

}  // namespace chronormal

#endif  // CHRONORMAL_IO_FILE_H_
