// Reads a journal once, when the journal is opened, and afterwards only writes at the end of the file.
#include "io/bytes/journal.h"

#include <algorithm>
#include <cerrno>
#include <optional>
#include <utility>

#include "chronormal/io/output.h"
#include "io/bytes/checksum.h"
#include "io/bytes/file.h"

namespace chronormal::inline internal {

bool Journal::read(std::string_view bytes) {
  for (std::size_t begin = 0, end = 0; (end = bytes.find('\n', begin)) != std::string_view::npos; begin = end + 1) {
    const std::optional<std::string_view> text = text_of_checked(bytes.substr(begin, end - begin));
    if (!text) break;
    if (ends_.empty())
      run_ = *text;
    else
      records_.emplace_back(*text);
    ends_.push_back(end + 1);
  }
  return !ends_.empty();
}

Result<Journal> Journal::open(const std::string& path, std::string_view run) {
  if (!status_of(path) && errno == ENOENT) {
    if (const Status begun = write_output(path, checked_line(run), false); !begun) return begun.error();
  }
  Journal journal(path, open_file(path, {.reads = true, .writes = true, .follows_links = false, .waits = false}));
  const int file = journal.file_.number();
  std::optional<FileStatus> status = journal.file_.is_open() ? status_of(file) : std::nullopt;
  if (!status) return failure(path, errno);
  const Error foreign{ErrorCode::kFailed, path,
                      "--resume keeps its progress in a file of this name, but another file has this name; remove this "
                      "file, or choose another output"};
  if (!status->is_file()) return foreign;
  // On a file system without locks, lock_file() always succeeds, so two runs that write the same output do not notice
  // each other.
  if (!lock_file(file) || !(status = status_of(file)) || status->is_removed)
    return Error{ErrorCode::kFailed, path,
                 "another run is writing to the same output; wait until that run has ended, or choose another output"};
  {
    // Windows cannot change a file while it is mapped, so this block ends the mapping before the journal is written.
    const Result<FileBytes> bytes = FileBytes::open(path);
    if (!bytes) return bytes.error();
    if (!journal.read(bytes.value().bytes())) return foreign;
  }
  if (const Status whole = journal.keep_first(journal.records_.size()); !whole) return whole.error();
  return journal;
}

Status Journal::append(std::string_view record) {
  const std::string line = checked_line(record);
  if (!write_bytes(file_.number(), line)) return failure(path_, errno);
  ++count_;
  return Success{};
}

Status Journal::keep_first(std::size_t count) {
  count = std::min(count, records_.size());
  records_.resize(count);
  ends_.resize(count + 1);
  count_ = count;
  if (!set_end(file_.number(), ends_.back())) return failure(path_, errno);
  return Success{};
}

Status Journal::remove() {
  if (!remove_file(path_.c_str()) && errno != ENOENT) return failure(path_, errno);
  return Success{};
}

}  // namespace chronormal::inline internal
