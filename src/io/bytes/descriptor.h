/// A file descriptor that its destructor closes. Private to io.
#ifndef CHRONORMAL_IO_BYTES_DESCRIPTOR_H_
#define CHRONORMAL_IO_BYTES_DESCRIPTOR_H_

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "chronormal/core/result.h"

namespace chronormal::inline internal {

class Descriptor {
 public:
  explicit Descriptor(int number) noexcept : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }

  [[nodiscard]] int number() const noexcept { return number_; }
  [[nodiscard]] bool is_open() const noexcept { return number_ >= 0; }

  /// Closes now. Returns false, with errno, where the system could not write what was left.
  [[nodiscard]] bool close() noexcept { return ::close(std::exchange(number_, -1)) == 0 || errno == EINTR; }

 private:
  int number_;
};

/// Opens a path, and tries again after a signal; returns -1 with errno where it can not be opened.
[[nodiscard]] inline int open_descriptor(const std::string& path, int flags, mode_t mode = 0) {
  int descriptor = -1;
  do descriptor = ::open(path.c_str(), flags | O_CLOEXEC, mode);
  while (descriptor < 0 && errno == EINTR);
  return descriptor;
}

/// Builds the error for a path from the system's own number for it; errno is not looked at.
[[nodiscard]] inline Error failure(const std::string& path, int system_error) {
  return Error{ErrorCode::kFailed, path, std::generic_category().message(system_error)};
}

/// Waits until a pipe that the other side made non-blocking is ready. Returns false for any other error in errno.
[[nodiscard]] inline bool may_go_on(int descriptor, short events) {
  if (errno == EINTR) return true;
  if (errno != EAGAIN) return false;
  pollfd waiting{descriptor, events, 0};
  return ::poll(&waiting, 1, -1) >= 0 || errno == EINTR;
}

/// Writes all bytes. Returns false, with errno, on failure.
[[nodiscard]] inline bool write_bytes(int descriptor, std::string_view bytes) {
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

/// Reads a file from byte `at` on, until `bytes` is full or the file ends. Returns the part that was not filled, or
/// nothing, with errno, on failure.
[[nodiscard]] inline std::optional<std::span<char>> read_at(int descriptor, std::uint64_t at, std::span<char> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::pread(descriptor, bytes.data(), bytes.size(), static_cast<off_t>(at));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return std::nullopt;
    if (count == 0) break;
    at += static_cast<std::uint64_t>(count);
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return bytes;
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_BYTES_DESCRIPTOR_H_
