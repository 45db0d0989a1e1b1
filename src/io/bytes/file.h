/// Whole files as bytes: in by memory mapping, or from memory where a caller has them there. Private to io and the
/// program; the way out is chronormal/io/output.h.
///
/// Threads    functions on different paths may run at the same time.
#ifndef CHRONORMAL_IO_BYTES_FILE_H_
#define CHRONORMAL_IO_BYTES_FILE_H_

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

#include "chronormal/core/result.h"

namespace chronormal::inline internal {

/// The most bytes that are read of a pipe or a terminal, or of a file that says no size: they are held in memory.
inline constexpr std::size_t kMostOfStream = std::size_t{1} << 30;

/// The bytes of a file, as long as the object lives. Regular files are mapped: where another program shortens one
/// meanwhile, or its disk fails, looking at what is gone raises SIGBUS, and the program ends (cli/terminal/process.h).
/// Pipes and terminals are read to their end.
class FileBytes {
 public:
  /// Opens a file; "-" is the standard input.
  /// Errors: kFailed with the path as the place: not found, not readable, a folder, a device other than a terminal, a
  /// stream of more than most_of_stream bytes.
  [[nodiscard]] static Result<FileBytes> open(const std::string& path, std::size_t most_of_stream = kMostOfStream);

  /// The same of bytes that a resolver finds by the path, which are not copied; without a resolver as above.
  [[nodiscard]] static Result<FileBytes> open(
      const std::string& path, const std::function<Result<std::string_view>(const std::string& name)>& resolve);

  FileBytes(FileBytes&& other) noexcept;
  FileBytes& operator=(FileBytes&& other) noexcept;
  FileBytes(const FileBytes&) = delete;
  FileBytes& operator=(const FileBytes&) = delete;
  ~FileBytes();

  /// Gives memory back that holds what was read of a mapped file. Its bytes stay valid: who looks at them again makes
  /// the system read them again.
  void release() const noexcept;

  /// All bytes; valid until the object is destroyed or moved from.
  [[nodiscard]] std::string_view bytes() const noexcept { return view_.data() != nullptr ? view_ : owned_; }

 private:
  FileBytes() = default;

  std::string_view view_;   // of what is mapped, or somebody else's
  bool is_mapped_ = false;  // else view_ is somebody else's
  std::string owned_;       // where there is no view
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_BYTES_FILE_H_
