/// A file that is written piece by piece, and that nobody sees before it is whole, as chronormal/io/output.h describes.
/// Private to io and workflow.
///
///     Result<OutputFile> file = OutputFile::create(path, force);
///     ... file.value().append(header); file.value().append(row);      // each a Status
///     ... file.value().finish();                                      // now the file is there
///
/// An object that is destroyed before finish() leaves nothing behind, except on streams, which have received all that
/// was appended.
///
/// Threads    one file belongs to one thread at a time.
#ifndef CHRONORMAL_IO_BYTES_OUTPUT_FILE_H_
#define CHRONORMAL_IO_BYTES_OUTPUT_FILE_H_

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "chronormal/core/result.h"
#include "io/bytes/spool.h"

namespace chronormal::inline internal {

class OutputFile {
 public:
  /// Begins a file. Errors: those of write_output() in chronormal/io/output.h that are known before a byte is written.
  [[nodiscard]] static Result<OutputFile> create(const std::string& path, bool force);

  /// Goes on with a file of which an interrupted run wrote the first `kept` bytes; 0 begins it. The bytes stand in the
  /// file partial_name(path) until finish(), and stay there if the object or the process ends before. Errors: those of
  /// create(); kUsage for a path that is no file.
  [[nodiscard]] static Result<OutputFile> go_on(const std::string& path, bool force, std::uint64_t kept);
  [[nodiscard]] static std::string partial_name(const std::string& path);
  /// Opens a file that another process has begun and whose temporary_name() is the name, to write other parts of it by
  /// put(). That process must call finish() after the others have called seal(), and the others call finish() after it;
  /// or they destroy the object, which removes the file. Both need the same file system. Errors: kFailed with path as
  /// the place.
  [[nodiscard]] static Result<OutputFile> join(const std::string& path, const std::string& name);
  /// Returns the name that the file has until it is whole; empty for a stream or a device.
  [[nodiscard]] std::string temporary_name() const;

  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&& other) noexcept;
  ~OutputFile();

  /// Begins a spool for bytes whose place in this file is not yet known: in the folder of the file, or in memory if
  /// this is a stream or a device. Errors: those of Spool::beside().
  [[nodiscard]] Result<Spool> spool() const;

  /// Writes bytes behind everything that was appended.
  [[nodiscard]] Status append(std::string_view bytes) { return append(std::span(&bytes, 1)); }
  /// Writes several pieces, one after the other, likewise.
  [[nodiscard]] Status append(std::span<const std::string_view> pieces);

  /// Writes bytes from byte `at` on. A stream gets them when it is finished, and they are all held in memory until
  /// then. A file must be written either by append() or by this function alone.
  [[nodiscard]] Status put(std::uint64_t at, std::string_view bytes);

  /// Ends the file and closes its descriptor; finish() gives it its name later. By that, many files can be made
  /// together, so that nobody reads one before all are whole. Nothing may be appended any more.
  [[nodiscard]] Status seal();

  /// Ends the file and gives it its name.
  [[nodiscard]] Status finish();

 private:
  struct State;
  explicit OutputFile(std::unique_ptr<State> state) noexcept;

  std::unique_ptr<State> state_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_BYTES_OUTPUT_FILE_H_
