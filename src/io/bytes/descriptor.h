/// A file descriptor that is closed when its time is over. Private to io.
#ifndef CHRONORMAL_IO_BYTES_DESCRIPTOR_H_
#define CHRONORMAL_IO_BYTES_DESCRIPTOR_H_

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <string>
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

  /// Closes now. False, with errno, where the system could not write what was left.
  [[nodiscard]] bool close() noexcept { return ::close(std::exchange(number_, -1)) == 0 || errno == EINTR; }

 private:
  int number_;
};

/// Opens a path, again where a signal came between; -1 with errno where it can not be opened.
[[nodiscard]] inline int open_descriptor(const std::string& path, int flags, mode_t mode = 0) {
  int descriptor = -1;
  do descriptor = ::open(path.c_str(), flags | O_CLOEXEC, mode);
  while (descriptor < 0 && errno == EINTR);
  return descriptor;
}

/// What the system says about a path. errno is not looked at.
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

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_BYTES_DESCRIPTOR_H_
