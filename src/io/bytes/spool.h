/// Bytes that are put aside in memory, or in a file without a name, until their place in an output is known.
///
///     Result<Spool> spool = Spool::beside(path, path);
///     const std::uint64_t at = spool.value().size();
///     spool.value().add(bytes);                                       // they lie at `at` now
///     if (Status status = spool.value().status(); !status) ...        // once, after many of these
///     spool.value().hand_over(at, size, take);                        // take(bytes) gets them, in parts
///
/// Memory     the bytes themselves, or none if a file holds them. The system removes the file when the object is
///            destroyed or the process ends, even if the process crashes.
/// Threads    one spool belongs to one thread at a time.
///
/// Private to io and workflow.
#ifndef CHRONORMAL_IO_BYTES_SPOOL_H_
#define CHRONORMAL_IO_BYTES_SPOOL_H_

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "chronormal/core/result.h"
#include "io/system/files.h"

namespace chronormal::inline internal {

class Spool {
 public:
  /// The function that gets bytes from the spool. Each call gets the bytes that follow the bytes of the previous call.
  using Take = std::function<Status(std::string_view bytes)>;

  /// Makes a spool that keeps bytes in memory.
  Spool() = default;
  /// Makes a spool that keeps bytes in a file in the folder of `target`. Errors, here and in all later calls: kFailed
  /// with `place` as the place.
  [[nodiscard]] static Result<Spool> beside(const std::string& target, const std::string& place);

  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }

  /// Adds bytes behind all others. If the file cannot be written, status() returns the error from then on, and later
  /// calls add nothing.
  void add(std::string bytes);
  /// Adds bytes that the caller continues to own. The bytes are copied only if the spool is in memory.
  void append(std::string_view bytes);
  /// Forgets all bytes in the spool.
  void clear();
  [[nodiscard]] const Status& status() const noexcept { return status_; }

  /// Passes `size` bytes from byte `at` on to `take`, in parts, until `take` returns an error. at + size must not
  /// exceed size(). If the spool is in memory, the bytes stay valid as long as the spool. Errors: status(), and those
  /// of `take`.
  [[nodiscard]] Status hand_over(std::uint64_t at, std::uint64_t size, const Take& take) const;

  /// Passes bytes to `take` like hand_over(), and forgets each part afterwards. If the system supports it, the disk
  /// space of that part becomes free again. The caller must not read these bytes again.
  [[nodiscard]] Status give_away(std::uint64_t at, std::uint64_t size, const Take& take);

  /// Returns true if the bytes in the spool from `at` on equal `bytes`. If the spool cannot be read, status() has the
  /// error from then on.
  [[nodiscard]] bool has(std::uint64_t at, std::string_view bytes);

 private:
  struct Block {
    std::uint64_t at;
    std::string bytes;
  };

  std::uint64_t size_ = 0;
  Status status_ = Success{};
  std::deque<Block> blocks_ = {};        // the bytes, if the spool is in memory; no block is empty
  std::optional<Descriptor> file_ = {};  // holds the bytes instead of blocks_
  std::string place_ = {};
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_BYTES_SPOOL_H_
