#include "io/bytes/file.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <span>
#include <system_error>
#include <utility>

#include "chronormal/io/output.h"
#include "core/charconv.h"
#include "io/bytes/descriptor.h"
#include "io/bytes/temporary_file.h"

namespace chronormal {
namespace {

Error failure(const std::string& path, int system_error) {
  return Error{ErrorCode::kFailed, path, std::generic_category().message(system_error)};
}

// Waits where the other side set a pipe to non-blocking. False for any other error in errno.
bool may_go_on(int descriptor, short events) {
  if (errno == EINTR) return true;
  if (errno != EAGAIN) return false;
  pollfd waiting{descriptor, events, 0};
  return ::poll(&waiting, 1, -1) >= 0 || errno == EINTR;
}

// Reads to the end, or until there are more than `most` bytes. False, with errno, on failure.
bool read_all(int descriptor, std::size_t most, std::string& bytes) {
  constexpr std::size_t kFirstBlock = std::size_t{1} << 16;
  std::size_t size = 0;
  while (size <= most) {
    if (size == bytes.size()) bytes.resize(std::min(size == 0 ? kFirstBlock : 2 * size, most + 1));
    const ssize_t count = ::read(descriptor, bytes.data() + size, bytes.size() - size);
    if (count == 0) break;
    if (count > 0) {
      size += static_cast<std::size_t>(count);
    } else if (!may_go_on(descriptor, POLLIN)) {
      return false;
    }
  }
  bytes.resize(size);
  bytes.shrink_to_fit();
  return true;
}

// Writes everything. False, with errno, on failure.
bool write_all(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(descriptor, bytes.data(), bytes.size());
    if (count >= 0) {
      bytes.remove_prefix(static_cast<std::size_t>(count));
    } else if (!may_go_on(descriptor, POLLOUT)) {
      return false;
    }
  }
  return true;
}

// Writes one piece after the other, little ones together. False, with errno, on failure.
bool write_all(int descriptor, std::span<const std::string_view> pieces) {
  constexpr std::size_t kBlock = std::size_t{1} << 16;
  std::string block;
  for (const std::string_view piece : pieces) {
    if (block.size() + piece.size() > kBlock) {
      if (!write_all(descriptor, block)) return false;
      block.clear();
    }
    if (piece.size() < kBlock)
      block += piece;
    else if (!write_all(descriptor, piece))
      return false;
  }
  return write_all(descriptor, block);
}

// The descriptor for which a path stands that names a stream of this process.
std::optional<int> stream_descriptor(std::string_view path) {
  if (path == "-" || path == "/dev/stdout") return STDOUT_FILENO;
  if (path == "/dev/stderr") return STDERR_FILENO;
  for (const std::string_view folder : {"/dev/fd/", "/proc/self/fd/"}) {
    if (!path.starts_with(folder)) continue;
    int number = -1;
    const char* const last = path.data() + path.size();
    const auto [end, code] = from_chars(path.data() + folder.size(), last, number);
    if (code == std::errc{} && end == last && number >= 0) return number;
  }
  return std::nullopt;
}

// The file that is written when somebody writes to path: the end of a chain of symbolic links, which need not exist.
std::string follow_links(const std::string& path) {
  constexpr int kLongestChain = 40;
  std::filesystem::path target = path;
  for (int i = 0; i < kLongestChain; ++i) {
    std::error_code error;
    const std::filesystem::path next = std::filesystem::read_symlink(target, error);
    if (error) break;
    target = next.is_absolute() ? next : target.parent_path() / next;
  }
  return target.string();
}

// Makes the rename last through a power cut. File systems that can not do it are none of our business.
void flush_folder_of(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  const Descriptor descriptor(open_descriptor(folder.empty() ? "." : folder.string(), O_RDONLY | O_DIRECTORY));
  if (descriptor.is_open()) (void)::fsync(descriptor.number());
}

Error exists_already(const std::string& path) {
  return Error{ErrorCode::kFailed, path, "the file exists already; pass --force to overwrite it"};
}

// Writes target by way of a temporary sibling. old is what target is now, or null where it does not exist.
Status replace_file(const std::string& path, const std::string& target, std::span<const std::string_view> pieces,
                    const struct stat* old, bool force) {
  // Until it has the permissions of the file that it replaces, nobody else may read it.
  TemporaryFile file(target, old != nullptr ? 0600 : 0666);
  if (!file.is_open()) {
    Error error = failure(path, errno);
    error.message = "can not write in its folder: " + error.message;
    return error;
  }
  const auto write = [&] {
    if (!write_all(file.descriptor(), pieces)) return false;
    if (old != nullptr) {
      if (::fchown(file.descriptor(), old->st_uid, old->st_gid) != 0) errno = 0;  // only the owner or root may
      if (::fchmod(file.descriptor(), old->st_mode & 07777) != 0) return false;
    }
    if (::fsync(file.descriptor()) != 0 && errno != EINVAL && errno != EROFS) return false;
    return file.close() && file.rename_to(target, force);
  };
  if (!write()) {
    const int system_error = errno;
    if (system_error == EEXIST && !force) return exists_already(path);
    return failure(path, system_error);
  }
  flush_folder_of(target);
  return Success{};
}

// Whether reading would come to an end: not that of devices, of which /dev/zero is one; terminals end with a key.
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
  if (S_ISDIR(status.st_mode)) return Error{ErrorCode::kFailed, place, "this is a folder, not a file"};
  if (may_have_no_end(descriptor, status))
    return Error{ErrorCode::kFailed, place, "this is a device, not a file, and may have no end"};

  FileBytes file;
  if (!is_stdin && S_ISREG(status.st_mode) && status.st_size > 0) {
    const auto size = static_cast<std::size_t>(status.st_size);
    void* const mapping = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0);
    if (mapping != MAP_FAILED) {
      (void)::madvise(mapping, size, MADV_SEQUENTIAL);
      file.view_ = {static_cast<const char*>(mapping), size};
      file.is_mapped_ = true;
      return file;
    }
  }
  if (!read_all(descriptor, most_of_stream, file.owned_)) return failure(place, errno);
  if (file.owned_.size() > most_of_stream)
    return Error{ErrorCode::kFailed, place,
                 "there is no end within " + std::to_string(most_of_stream) +
                     " bytes, and no more are read of a stream: write them to a file, and give that"};
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

// What is mapped is mapped by us, so that it may be written to as far as the system calls want it.
void FileBytes::release() const noexcept {
  if (is_mapped_) (void)::madvise(const_cast<char*>(view_.data()), view_.size(), MADV_DONTNEED);
}

FileBytes::~FileBytes() {
  if (is_mapped_) ::munmap(const_cast<char*>(view_.data()), view_.size());
}

Status check_output(const std::string& path, bool force) {
  if (path.empty()) return Error{ErrorCode::kUsage, "", "the name of the output is empty"};
  if (stream_descriptor(path)) return Success{};
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return Success{};
  if (S_ISDIR(status.st_mode)) return Error{ErrorCode::kFailed, path, "this is a folder, not a file"};
  if (S_ISREG(status.st_mode) && !force) return exists_already(path);
  return Success{};
}

bool is_stream(const std::string& path) {
  if (stream_descriptor(path)) return true;
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode);
}

Status write_output(const std::string& path, std::string_view bytes, bool force) {
  return write_output(path, std::span(&bytes, 1), force);
}

Status write_output(const std::string& path, std::span<const std::string_view> pieces, bool force) {
  if (const std::optional<int> stream = stream_descriptor(path)) {
    // What was printed before comes first.
    (void)std::fflush(*stream == STDERR_FILENO ? stderr : stdout);
    if (!write_all(*stream, pieces)) return failure(path == "-" ? "<stdout>" : path, errno);
    return Success{};
  }
  if (Status status = check_output(path, force); !status) return status;

  struct stat old {};
  const bool exists = ::stat(path.c_str(), &old) == 0;
  if (!exists && errno != ENOENT) return failure(path, errno);
  if (exists && !S_ISREG(old.st_mode)) {
    Descriptor device(open_descriptor(path, O_WRONLY));
    if (!device.is_open() || !write_all(device.number(), pieces) || !device.close()) return failure(path, errno);
    return Success{};
  }
  return replace_file(path, follow_links(path), pieces, exists ? &old : nullptr, force);
}

}  // namespace chronormal
