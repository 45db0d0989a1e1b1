/// A file that lists the finished work of a run, so that a later run can go on where this run was interrupted. Private
/// to io, workflow and the program.
///
///     1a2b3c4d {"chronormal": "0.2.0", ...}       the run: what decides its result, as a text that the caller chooses
///     5e6f7081 {"segment": 0, ...}                a record for each piece of work that was done, in order
///
/// A line is the CRC-32 of a text in hexadecimal, a blank, the text, and a line feed. The checksum reveals a record
/// that was written only in part; the journal then drops this record and all records behind it. The first line, which
/// names the run, is written completely or not at all.
///
/// Threads    one journal belongs to one thread at a time, and to one process: its file is locked.
#ifndef CHRONORMAL_IO_BYTES_JOURNAL_H_
#define CHRONORMAL_IO_BYTES_JOURNAL_H_

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/core/result.h"
#include "io/system/files.h"

namespace chronormal::inline internal {

class Journal {
 public:
  /// Opens the journal at `path`. If the file does not exist, begins a journal with the text `run`, which must not
  /// contain line feeds. An existing journal may belong to another run; run() tells which. Errors: kFailed with the
  /// path as the place, if the file is not a journal, another process has locked it, or the system refuses to open the
  /// file.
  [[nodiscard]] static Result<Journal> open(const std::string& path, std::string_view run);

  /// Return the text of the run that began the journal, the texts of the records that the journal had when it was
  /// opened, and the path of the journal.
  [[nodiscard]] const std::string& run() const noexcept { return run_; }
  [[nodiscard]] const std::vector<std::string>& records() const noexcept { return records_; }
  [[nodiscard]] const std::string& path() const noexcept { return path_; }

  /// Returns true if the journal has no records, neither of an earlier run nor of this run.
  [[nodiscard]] bool is_empty() const noexcept { return count_ == 0; }

  /// Writes a record to the end of the file at once; records() does not list the new record. Errors: kFailed with the
  /// path as the place.
  [[nodiscard]] Status append(std::string_view record);
  /// Keeps the first `count` of the records that the journal had when it was opened, and drops all others. Errors:
  /// kFailed with the path as the place.
  [[nodiscard]] Status keep_first(std::size_t count);
  /// Removes the file of the journal. Errors: kFailed with the path as the place.
  [[nodiscard]] Status remove();

 private:
  Journal(std::string path, Descriptor file) : path_(std::move(path)), file_(std::move(file)) {}
  // Reads the lines of the journal up to the first damaged line. Returns false if the first line, which names the run,
  // is damaged.
  [[nodiscard]] bool read(std::string_view bytes);

  std::string path_;
  Descriptor file_;
  std::string run_;
  std::vector<std::string> records_;
  std::size_t count_ = 0;            // number of all records, including new ones
  std::vector<std::uint64_t> ends_;  // offsets in bytes at which the first line and then each record end
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_BYTES_JOURNAL_H_
