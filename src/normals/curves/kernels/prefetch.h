/// Finds out, on the machine where it runs, how far ahead an evaluation should prefetch its curves.
///
/// Cores differ: one works best when it prefetches 8 KiB or more ahead, another 2 KiB, and the wrong distance costs up
/// to a third of the time. So the first passes over a large working set try several distances in turn, with 128 KiB of
/// curves each time. From then on, all threads use the distance of the shortest trial. Results do not depend on it.
///
///     a span   [2 KiB][4 KiB][8 KiB][16 KiB] the rest at the best so far    until each has had its trials
#ifndef CHRONORMAL_NORMALS_CURVES_KERNELS_PREFETCH_H_
#define CHRONORMAL_NORMALS_CURVES_KERNELS_PREFETCH_H_

#include <array>
#include <atomic>
#include <cstddef>
#include <optional>

namespace chronormal::inline internal {

class PrefetchRule {
 public:
  static constexpr std::array<std::size_t, 4> kDistances = {2048, 4096, 8192, 16384};
  static constexpr std::size_t kTrials = 16;                          // for each distance
  static constexpr std::size_t kTrialBytes = std::size_t{128} << 10;  // of curves

  /// The best distance so far, or the smallest one where none was tried.
  [[nodiscard]] std::size_t best() const noexcept;
  /// The number of the distance to try next; nothing when the trials are over.
  [[nodiscard]] std::optional<std::size_t> next() noexcept;
  /// Takes the time per byte of a trial with the distance of this number.
  void take(std::size_t distance, float nanoseconds_per_byte) noexcept;

 private:
  std::atomic<std::size_t> trials_ = 0;
  std::array<std::atomic<float>, kDistances.size()> least_ = {};  // nanoseconds per byte; 0: not tried
};

/// The rules of this process, one for curves in the cache that cores share, and one for curves in memory.
[[nodiscard]] PrefetchRule& prefetch_in_shared_cache() noexcept;
[[nodiscard]] PrefetchRule& prefetch_in_memory() noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CURVES_KERNELS_PREFETCH_H_
