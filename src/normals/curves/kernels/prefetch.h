/// Measures, on the machine where the program runs, how many bytes in advance an evaluation should prefetch its curves,
/// and whether it should prefetch at all.
///
/// Cores differ. One core is fastest if it prefetches 8 KiB or more in advance, another if it prefetches 2 KiB in
/// advance. A third needs no help, and prefetches cost it a third of its speed. So the first passes over a working set
/// try several distances in turn, with 128 KiB of curves each time. After that, all threads use the distance with the
/// shortest median time. The trials are repeated now and then, because other work on the machine may have influenced
/// them, and that work changes. Normals do not depend on the distance.
///
///     a pass   [2 KiB][none][4 KiB][8 KiB][16 KiB] the rest at the best so far    until each has had its trials
#ifndef CHRONORMAL_NORMALS_CURVES_KERNELS_PREFETCH_H_
#define CHRONORMAL_NORMALS_CURVES_KERNELS_PREFETCH_H_

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <optional>

#include "normals/curves/kernels/curve_blocks.h"

namespace chronormal::inline internal {

/// The cache or memory that holds everything that a pass reads and writes. A small set has up to 1 MiB, a medium set up
/// to 8 MiB.
enum class WorkingSet { kSmall, kMedium, kSharedCache, kMemory };
inline constexpr std::size_t kWorkingSets = 4;

class PrefetchRule {
 public:
  // Distances in bytes; 0 means no prefetch.
  static constexpr std::array<std::size_t, 5> kDistances = {2048, 0, 4096, 8192, 16384};
  // Number of trials of each distance.
  static constexpr std::size_t kTrials = 16;
  // Bytes of curves that a trial reads.
  static constexpr std::size_t kTrialBytes = std::size_t{128} << 10;
  // The trials are repeated this many calls of next() after the last trial.
  static constexpr std::size_t kCallsBetween = 1024;

  /// Creates a rule that tries the first `distances` numbers of kDistances.
  explicit PrefetchRule(std::size_t distances = kDistances.size()) noexcept : distances_(distances) {}

  /// Returns the best distance so far in bytes, or the first distance if none was tried yet.
  [[nodiscard]] std::size_t best() const noexcept { return best_.load(std::memory_order_relaxed); }
  /// Returns the index in kDistances of the distance to try next, or no value if there are no trials for a while.
  [[nodiscard]] std::optional<std::size_t> next() noexcept;
  /// Records the time of a trial, in nanoseconds per byte. `distance` is an index in kDistances.
  void take(std::size_t distance, float nanoseconds_per_byte) noexcept;

  /// Calls evaluate(first, count, ahead) for all elements, in order. While there are trials left, the first calls get
  /// parts that consist of whole tiles, each with a distance to try. The last call gets the rest, with the best
  /// distance so far.
  template <class Evaluate>
  void over(std::size_t elements, std::size_t bytes_of_element, const Evaluate& evaluate);

 private:
  std::size_t distances_;
  std::atomic<std::size_t> trials_ = 0;  // number of trials of the present round that threads have taken
  std::atomic<std::size_t> calls_ = 0;   // number of calls that found no trial
  std::atomic<std::size_t> best_ = kDistances[0];
  // The times of the trials of each distance, in nanoseconds per byte. A time is 0 until its trial is finished.
  std::array<std::array<std::atomic<float>, kTrials>, kDistances.size()> times_ = {};
  std::array<std::atomic<std::size_t>, kDistances.size()> counts_ = {};
};

template <class Evaluate>
void PrefetchRule::over(std::size_t elements, std::size_t bytes_of_element, const Evaluate& evaluate) {
  using Clock = std::chrono::steady_clock;
  const std::size_t part = kTrialBytes / bytes_of_element / kTile * kTile;
  std::size_t first = 0;
  for (std::size_t i = 0; i < distances_ && elements - first >= part; ++i) {
    const std::optional<std::size_t> trial = next();
    if (!trial) break;
    const Clock::time_point start = Clock::now();
    evaluate(first, part, kDistances[*trial]);
    const std::chrono::duration<float, std::nano> taken = Clock::now() - start;
    take(*trial, std::max(taken.count(), 1.0f) / static_cast<float>(part * bytes_of_element));
    first += part;
  }
  if (first < elements) evaluate(first, elements - first, best());
}

/// Return a rule of this process. There is one rule for each working set, and separate rules for curves on straight
/// lines and for curves along paths. Small sets always prefetch 2 KiB in advance, and medium sets choose between 2 KiB
/// and no prefetch.
[[nodiscard]] PrefetchRule& prefetch_of_curves(WorkingSet set) noexcept;
[[nodiscard]] PrefetchRule& prefetch_of_paths(WorkingSet set) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CURVES_KERNELS_PREFETCH_H_
