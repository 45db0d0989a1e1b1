// Maps a regular file into memory, and reads any other to its end.
#include "io/bytes/file.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

#include "io/bytes/descriptor.h"
#include "io/bytes/expansion.h"

namespace chronormal {
namespace {

// Selects what to do while there is nothing to read yet.
enum class OnWait { kWait, kFail };

// Reads to the end, or until there are more than `most` bytes. Returns false, with errno, on failure.
bool read_all(int descriptor, OnWait on_wait, std::size_t most, std::string& bytes) {
  constexpr std::size_t kFirstBlock = std::size_t{1} << 16;
  std::size_t size = 0;
  while (size <= most) {
    if (size == bytes.size()) bytes.resize(std::min(size == 0 ? kFirstBlock : 2 * size, most + 1));
    const ssize_t count = ::read(descriptor, bytes.data() + size, bytes.size() - size);
    if (count == 0) break;
    if (count > 0) {
      size += static_cast<std::size_t>(count);
    } else if ((on_wait == OnWait::kFail && errno == EAGAIN) || !may_go_on(descriptor, POLLIN)) {
      return false;
    }
  }
  bytes.resize(size);
  bytes.shrink_to_fit();
  return true;
}

// Counts the bytes of a file that were ever written, and stops at `enough`; the others are holes. If the system does
// not tell holes, every byte counts.
std::uint64_t written_bytes(int descriptor, std::uint64_t size, std::uint64_t enough) {
#if defined(SEEK_DATA) && defined(SEEK_HOLE)
  std::uint64_t written = 0;
  off_t hole = 0;
  while (written < enough) {
    const off_t data = ::lseek(descriptor, hole, SEEK_DATA);
    if (data < 0 && errno == ENXIO) break;  // there is a hole to the end
    hole = data < 0 ? -1 : ::lseek(descriptor, data, SEEK_HOLE);
    if (hole <= data) {
      written = size;
      break;
    }
    written += static_cast<std::uint64_t>(hole - data);
  }
  (void)::lseek(descriptor, 0, SEEK_SET);
  return written;
#else
  (void)descriptor;
  (void)enough;
  return size;
#endif
}

// Refuses a large file that is nearly all holes: it would make us hold far more than there is of it.
Status check_holes(int descriptor, std::uint64_t size, const std::string& place) {
  constexpr std::uint64_t kLarge = std::uint64_t{1} << 30;
  if (size <= kLarge) return Success{};
  const std::uint64_t enough = size / Expansion::kUsual, written = written_bytes(descriptor, size, enough);
  if (written >= enough) return Success{};
  return invalid_input(place, "the file is almost empty, since only " + std::to_string(written) + " of its " +
                                  std::to_string(size) + " bytes were ever written; copy or download the file again");
}

// Returns true for devices that reading may never end on, such as /dev/zero. Terminals are not among them: a key ends
// their input.
bool may_have_no_end(int descriptor, const struct stat& status) {
  return S_ISBLK(status.st_mode) || (S_ISCHR(status.st_mode) && ::isatty(descriptor) == 0);
}

}  // namespace

Result<FileBytes> FileBytes::open(const std::string& path, std::size_t most_of_stream) {
  const bool is_stdin = path == "-";
  const Descriptor opened(is_stdin ? -1 : open_descriptor(path, O_RDONLY | O_NOCTTY));
  if (!is_stdin && !opened.is_open()) return failure(path, errno);
  const int descriptor = is_stdin ? STDIN_FILENO : opened.number();
  const std::string place = is_stdin ? "<stdin>" : path;

  struct stat status {};
  if (::fstat(descriptor, &status) != 0) return failure(place, errno);
  if (S_ISDIR(status.st_mode)) return Error{ErrorCode::kFailed, place, "this is a folder; name a file"};
  if (may_have_no_end(descriptor, status))
    return Error{ErrorCode::kFailed, place, "this is a device, whose data may never end; name a file"};

  FileBytes file;
  // Files of the kernel have no size. Most have an end, but /proc/kmsg waits for more.
  if (!is_stdin && S_ISREG(status.st_mode) && status.st_size == 0) (void)::fcntl(descriptor, F_SETFL, O_NONBLOCK);
  if (!is_stdin && S_ISREG(status.st_mode) && status.st_size > 0) {
    const auto size = static_cast<std::size_t>(status.st_size);
    if (Status status_of_holes = check_holes(descriptor, size, place); !status_of_holes) return status_of_holes.error();
    void* const mapping = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0);
    if (mapping != MAP_FAILED) {
      (void)::madvise(mapping, size, MADV_SEQUENTIAL);
      file.view_ = {static_cast<const char*>(mapping), size};
      file.is_mapped_ = true;
      return file;
    }
  }
  const bool has_no_size = !is_stdin && S_ISREG(status.st_mode) && status.st_size == 0;
  if (!read_all(descriptor, has_no_size ? OnWait::kFail : OnWait::kWait, most_of_stream, file.owned_)) {
    if (has_no_size && errno == EAGAIN)
      return Error{ErrorCode::kFailed, place,
                   "this is a file of the system whose data may never end; name another file"};
    return failure(place, errno);
  }
  if (file.owned_.size() > most_of_stream)
    return Error{ErrorCode::kFailed, place,
                 "the stream is longer than " + std::to_string(most_of_stream) +
                     " bytes; save its data to a file, and name that file"};
  return file;
}

Result<FileBytes> FileBytes::open(const std::string& path,
                                  const std::function<Result<std::string_view>(const std::string& name)>& resolve) {
  if (!resolve) return open(path);
  const Result<std::string_view> bytes = resolve(path);
  if (!bytes) return bytes.error();
  FileBytes file;
  file.view_ = bytes.value();
  return file;
}

FileBytes::FileBytes(FileBytes&& other) noexcept
    : view_(std::exchange(other.view_, {})),
      is_mapped_(std::exchange(other.is_mapped_, false)),
      owned_(std::exchange(other.owned_, {})) {}

FileBytes& FileBytes::operator=(FileBytes&& other) noexcept {
  std::swap(view_, other.view_);
  std::swap(is_mapped_, other.is_mapped_);
  std::swap(owned_, other.owned_);
  return *this;
}

// A mapping is ours alone (MAP_PRIVATE, read only), so the const_cast that madvise() needs does no harm.
void FileBytes::release() const noexcept {
  if (is_mapped_) (void)::madvise(const_cast<char*>(view_.data()), view_.size(), MADV_DONTNEED);
}

FileBytes::~FileBytes() {
  if (is_mapped_) ::munmap(const_cast<char*>(view_.data()), view_.size());
}

}  // namespace chronormal
