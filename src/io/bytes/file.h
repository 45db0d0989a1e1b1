/// Files as bytes: mapped into memory, taken from the caller's memory, or read part by part. Private to io and the
/// program; chronormal/io/output.h writes files.
///
/// Threads    functions on different paths may run at the same time.
#ifndef CHRONORMAL_IO_BYTES_FILE_H_
#define CHRONORMAL_IO_BYTES_FILE_H_

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "chronormal/core/result.h"
#include "io/system/files.h"

namespace chronormal::inline internal {

/// The largest number of bytes that may be read from a pipe, a terminal, or a file without a size. All of these bytes
/// are held in memory.
inline constexpr std::size_t kMostOfStream = std::size_t{1} << 30;

/// The bytes of a file, which are valid as long as the object lives. A regular file is mapped: if another program
/// shortens it meanwhile, or its disk fails, reading the lost part raises SIGBUS, and the program ends
/// (cli/terminal/process.h). Pipes and terminals are read to their end.
class FileBytes {
 public:
  /// Opens a file; "-" is the standard input.
  /// Errors: kFailed with the path as the place: not found, not readable, a folder, a device other than a terminal, a
  /// stream of more than most_of_stream bytes.
  [[nodiscard]] static Result<FileBytes> open(const std::string& path, std::size_t most_of_stream = kMostOfStream);

  /// Returns the bytes that the function `resolve` finds for the path, without a copy. If `resolve` is empty, opens the
  /// file as open() without `resolve` does.
  [[nodiscard]] static Result<FileBytes> open(
      const std::string& path, const std::function<Result<std::string_view>(const std::string& name)>& resolve);

  FileBytes(FileBytes&& other) noexcept;
  FileBytes& operator=(FileBytes&& other) noexcept;
  FileBytes(const FileBytes&) = delete;
  FileBytes& operator=(const FileBytes&) = delete;
  ~FileBytes();

  /// Releases the memory that holds pages of a mapped file. bytes() stays valid: the system reads a page again when
  /// somebody accesses it.
  void release() const noexcept;

  /// Returns all bytes of the file; the bytes are valid until the object is destroyed or moved from.
  [[nodiscard]] std::string_view bytes() const noexcept { return view_.data() != nullptr ? view_ : owned_; }

 private:
  FileBytes() = default;

  std::string_view view_;   // the mapped file, or the bytes that `resolve` returned
  bool is_mapped_ = false;  // true if view_ is a mapping that the destructor must end
  std::string owned_;       // the bytes, if they were read and not mapped
};

/// A file whose parts are read in any order. Nothing is mapped, so the file may be larger than memory, and another
/// program may shorten the file during reading.
///
/// Threads    several threads may call read() at the same time.
class PositionedFile {
 public:
  /// Opens a regular file. Returns nothing if the path is not a regular file or cannot be opened.
  [[nodiscard]] static std::optional<PositionedFile> open(const std::string& path);

  /// Returns the size in bytes that the file had when open() was called.
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }

  /// Fills `bytes` with the bytes of the file from `at` on. Errors: kFailed with the path as the place, if the file has
  /// become shorter or the system refuses to read.
  [[nodiscard]] Status read(std::uint64_t at, std::span<char> bytes) const;

 private:
  PositionedFile(std::string path, Descriptor descriptor, std::uint64_t size)
      : path_(std::move(path)), descriptor_(std::move(descriptor)), size_(size) {}

  std::string path_;
  Descriptor descriptor_;
  std::uint64_t size_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_BYTES_FILE_H_
