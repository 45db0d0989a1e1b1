#include "io/bytes/file.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <span>
#include <system_error>
#include <utility>

#include "chronormal/io/output.h"

namespace chronormal {
namespace {

Error failure(const std::string& path, int system_error) {
  return Error{ErrorCode::kFailed, path, std::generic_category().message(system_error)};
}

// A file descriptor that is closed when its time is over.
class Descriptor {
 public:
  explicit Descriptor(int number) noexcept : number_(number) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }

  [[nodiscard]] int number() const noexcept { return number_; }
  [[nodiscard]] bool is_open() const noexcept { return number_ >= 0; }

  /// Closes now. False, with errno, where the system could not write what was left.
  [[nodiscard]] bool close() noexcept { return ::close(std::exchange(number_, -1)) == 0 || errno == EINTR; }

 private:
  int number_;
};

int open_descriptor(const std::string& path, int flags, mode_t mode = 0) {
  int descriptor = -1;
  do descriptor = ::open(path.c_str(), flags | O_CLOEXEC, mode);
  while (descriptor < 0 && errno == EINTR);
  return descriptor;
}

// Waits where the other side set a pipe to non-blocking. False for any other error in errno.
bool may_go_on(int descriptor, short events) {
  if (errno == EINTR) return true;
  if (errno != EAGAIN) return false;
  pollfd waiting{descriptor, events, 0};
  return ::poll(&waiting, 1, -1) >= 0 || errno == EINTR;
}

// Reads to the end. False, with errno, on failure.
bool read_all(int descriptor, std::string& bytes) {
  constexpr std::size_t kFirstBlock = std::size_t{1} << 16;
  std::size_t size = 0;
  while (true) {
    if (size == bytes.size()) bytes.resize(size == 0 ? kFirstBlock : 2 * size);
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
    const auto [end, code] = std::from_chars(path.data() + folder.size(), last, number);
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

// Opens a new file beside target. The name is free of anything that target has, so that it is never too long.
int open_temporary(const std::string& target, mode_t mode, std::string& name) {
  const std::filesystem::path folder = std::filesystem::path(target).parent_path();
  for (int attempt = 0; attempt < 1000; ++attempt) {
    name = (folder / (".chronormal-" + std::to_string(::getpid()) + "-" + std::to_string(attempt) + ".tmp")).string();
    const int descriptor = open_descriptor(name, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW, mode);
    if (descriptor >= 0 || errno != EEXIST) return descriptor;
  }
  return -1;
}

// Renames without replacing a file that somebody else made meanwhile, where system and file system can do that.
bool rename_to_new(const std::string& from, const std::string& to) {
#ifdef RENAME_NOREPLACE
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return true;
  if (errno != EINVAL && errno != ENOSYS) return false;
#endif
  return std::rename(from.c_str(), to.c_str()) == 0;
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
  std::string temporary;
  // Until it has the permissions of the file that it replaces, nobody else may read it.
  Descriptor file(open_temporary(target, old != nullptr ? 0600 : 0666, temporary));
  if (!file.is_open()) {
    Error error = failure(path, errno);
    error.message = "can not write in its folder: " + error.message;
    return error;
  }
  const auto prepare = [&] {
    if (!write_all(file.number(), pieces)) return false;
    if (old != nullptr) {
      if (::fchown(file.number(), old->st_uid, old->st_gid) != 0) errno = 0;  // only the owner or root may
      if (::fchmod(file.number(), old->st_mode & 07777) != 0) return false;
    }
    if (::fsync(file.number()) != 0 && errno != EINVAL && errno != EROFS) return false;
    if (!file.close()) return false;
    return force ? std::rename(temporary.c_str(), target.c_str()) == 0 : rename_to_new(temporary, target);
  };
  if (!prepare()) {
    const int system_error = errno;
    (void)::unlink(temporary.c_str());
    if (system_error == EEXIST && !force) return exists_already(path);
    return failure(path, system_error);
  }
  flush_folder_of(target);
  return Success{};
}

}  // namespace

Result<FileBytes> FileBytes::open(const std::string& path) {
  const bool is_stdin = path == "-";
  const Descriptor opened(is_stdin ? -1 : open_descriptor(path, O_RDONLY));
  if (!is_stdin && !opened.is_open()) return failure(path, errno);
  const int descriptor = is_stdin ? STDIN_FILENO : opened.number();
  const std::string place = is_stdin ? "<stdin>" : path;

  struct stat status {};
  if (::fstat(descriptor, &status) != 0) return failure(place, errno);
  if (S_ISDIR(status.st_mode)) return Error{ErrorCode::kFailed, place, "this is a folder, not a file"};

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
  if (!read_all(descriptor, file.owned_)) return failure(place, errno);
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
