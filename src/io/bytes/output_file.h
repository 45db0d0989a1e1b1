/// A file that is written piece by piece, and that nobody sees before it is whole, as chronormal/io/output.h describes.
/// Private to io and workflow.
///
///     Result<OutputFile> file = OutputFile::create(path, force);
///     ... file.value().append(header); file.value().append(row);      // each a Status
///     ... file.value().finish();                                      // now the file is there
///
/// An object that is destroyed before finish() leaves no file behind. Bytes that were appended to a stream have already
/// been sent.
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
  /// Begins a file. Errors: the errors of write_output() (chronormal/io/output.h) that can be found before the first
  /// byte is written.
  [[nodiscard]] static Result<OutputFile> create(const std::string& path, bool force);

  /// Continues a file of which an interrupted run wrote the first `kept` bytes. If `kept` is 0, begins the file. Until
  /// finish(), the bytes are in the file partial_name(path), and the bytes stay there if the object or the process ends
  /// early. Errors: those of create(); kUsage for a path that is not a file.
  [[nodiscard]] static Result<OutputFile> go_on(const std::string& path, bool force, std::uint64_t kept);
  [[nodiscard]] static std::string partial_name(const std::string& path);
  /// Opens a file that another process (the owner) has begun, so that this process can write other parts of the file by
  /// put(). `name` is what temporary_name() returned to the owner. The calls must come in this order: first seal() in
  /// all other processes, then finish() in the owner, then finish() in the others. A process that destroys its object
  /// without finish() removes the file. All processes must see the same file system. Errors: kFailed with path as the
  /// place.
  [[nodiscard]] static Result<OutputFile> join(const std::string& path, const std::string& name);
  /// Returns the name that the file has before finish(), or an empty text for a stream or a device.
  [[nodiscard]] std::string temporary_name() const;

  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&& other) noexcept;
  ~OutputFile();

  /// Begins a spool for bytes whose place in this file is not yet known. The spool is a file in the same folder, or
  /// lies in memory if the output is a stream or a device. Errors: those of Spool::beside().
  [[nodiscard]] Result<Spool> spool() const;

  /// Append bytes to the file, or several pieces one behind the other.
  [[nodiscard]] Status append(std::string_view bytes) { return append(std::span(&bytes, 1)); }
  [[nodiscard]] Status append(std::span<const std::string_view> pieces);

  /// Writes bytes from byte `at` of the file on. If the output is a stream, all such bytes are held in memory until
  /// finish() writes them. A file must be written either by append() alone or by put() alone.
  [[nodiscard]] Status put(std::uint64_t at, std::string_view bytes);

  /// Ends the file and closes its descriptor, but leaves the temporary name; finish() renames the file later. A caller
  /// can thus complete several files before the first of them appears under its name. Nothing may be appended after
  /// this call.
  [[nodiscard]] Status seal();

  /// Ends the file and renames it to its path.
  [[nodiscard]] Status finish();

 private:
  struct State;
  explicit OutputFile(std::unique_ptr<State> state) noexcept;

  std::unique_ptr<State> state_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_BYTES_OUTPUT_FILE_H_
