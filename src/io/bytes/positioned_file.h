/// A file whose parts are read wherever they lie, by a descriptor and without a mapping: it may be larger than memory,
/// and may be shortened while it is read. Private to io.
///
/// Threads    several may call read() at the same time.
#ifndef CHRONORMAL_IO_BYTES_POSITIONED_FILE_H_
#define CHRONORMAL_IO_BYTES_POSITIONED_FILE_H_

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "chronormal/core/result.h"
#include "io/bytes/descriptor.h"

namespace chronormal::inline internal {

class PositionedFile {
 public:
  /// Opens a regular file; returns nothing for any other, and for one that cannot be opened.
  [[nodiscard]] static std::optional<PositionedFile> open(const std::string& path);

  /// Returns the size of the file in bytes when it was opened.
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }

  /// Fills `bytes` with the bytes of the file from `at` on. Errors: kFailed with the path as the place, where the file
  /// has become shorter or the system refuses to read.
  [[nodiscard]] Status read(std::uint64_t at, std::span<char> bytes) const;

 private:
  PositionedFile(std::string path, Descriptor descriptor, std::uint64_t size)
      : path_(std::move(path)), descriptor_(std::move(descriptor)), size_(size) {}

  std::string path_;
  Descriptor descriptor_;
  std::uint64_t size_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_BYTES_POSITIONED_FILE_H_
