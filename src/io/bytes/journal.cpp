// Reads a journal once, when it is opened, and then only writes behind its end.
#include "io/bytes/journal.h"

#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

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
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0 && errno == ENOENT) {
    if (const Status begun = write_output(path, checked_line(run), false); !begun) return begun.error();
  }
  Journal journal(path, Descriptor(open_descriptor(path, O_RDWR | O_NOFOLLOW | O_NONBLOCK)));
  const int file = journal.file_.number();
  if (file < 0 || ::fstat(file, &status) != 0) return failure(path, errno);
  const Error foreign{
      ErrorCode::kFailed, path,
      "this file is in the way of the journal, but is not one; remove the file, or choose another output"};
  if (!S_ISREG(status.st_mode)) return foreign;
  // If the file system has no locks, two runs that write the same output are not noticed.
  const bool is_taken = ::flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  if (is_taken || ::fstat(file, &status) != 0 || status.st_nlink == 0)
    return Error{ErrorCode::kFailed, path,
                 "another run is writing to the same output; wait until that run has ended, or choose another output"};
  const Result<FileBytes> bytes = FileBytes::open(path);
  if (!bytes) return bytes.error();
  if (!journal.read(bytes.value().bytes())) return foreign;
  if (const Status whole = journal.keep_first(journal.records_.size()); !whole) return whole.error();
  return journal;
}

Status Journal::append(std::string_view record) {
  const std::string line = checked_line(record);
  std::string_view rest = line;
  while (!rest.empty()) {
    const ssize_t count = ::write(file_.number(), rest.data(), rest.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return failure(path_, errno);
    rest.remove_prefix(static_cast<std::size_t>(count));
  }
  ++count_;
  return Success{};
}

Status Journal::keep_first(std::size_t count) {
  count = std::min(count, records_.size());
  records_.resize(count);
  ends_.resize(count + 1);
  count_ = count;
  const auto end = static_cast<off_t>(ends_.back());
  if (::ftruncate(file_.number(), end) != 0 || ::lseek(file_.number(), end, SEEK_SET) != end)
    return failure(path_, errno);
  return Success{};
}

Status Journal::remove() {
  if (::unlink(path_.c_str()) != 0 && errno != ENOENT) return failure(path_, errno);
  return Success{};
}

}  // namespace chronormal::inline internal
