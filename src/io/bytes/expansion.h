/// Limits the memory and the output that a file may ask for. Without a limit, a small damaged or hostile file could
/// declare billions of elements, or unpack to many gigabytes.
///
///     Expansion expansion(100);                     // --max-expansion
///     expansion.add_read(file.size());              // whatever is read counts
///     if (Status s = expansion.check(wanted, place); !s) return s;      // before memory is taken
///
/// A file may ask for 32 MiB, or for `times` times as many bytes as were read, whichever is larger. Memory that the
/// user asks for, such as poses or moments to sample, does not count.
///
/// Threads    a plain value, without memory that other objects share.
#ifndef CHRONORMAL_IO_BYTES_EXPANSION_H_
#define CHRONORMAL_IO_BYTES_EXPANSION_H_

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>

#include "chronormal/core/result.h"
#include "chronormal/core/views.h"

namespace chronormal::inline internal {

class Expansion {
 public:
  static constexpr std::size_t kUsual = 100;
  static constexpr std::uint64_t kAlways = std::uint64_t{32} << 20;  ///< bytes that any file may ask for

  explicit Expansion(std::size_t times = kUsual, std::uint64_t bytes_read = 0) noexcept
      : times_(times), read_(bytes_read) {}
  /// Returns an Expansion that allows any size, for input that did not come from a file.
  [[nodiscard]] static Expansion unlimited() noexcept { return Expansion(static_cast<std::size_t>(-1), kAlways); }

  void add_read(std::uint64_t bytes) noexcept { read_ += bytes; }
  /// Returns the number of bytes that were read.
  [[nodiscard]] std::uint64_t bytes_read() const noexcept { return read_; }

  /// Returns the largest number of bytes of memory or output that a file may ask for.
  [[nodiscard]] std::uint64_t most() const noexcept;
  /// Checks that the file may ask for `bytes` bytes of memory or output. Pass 2^64 - 1 if the computation of this
  /// number overflowed. Errors: kInvalidInput; the message gives the number of bytes, and the value of --max-expansion
  /// that would allow this number.
  [[nodiscard]] Status check(std::uint64_t bytes, const std::string& place) const;

 private:
  std::size_t times_;
  std::uint64_t read_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_BYTES_EXPANSION_H_
