// Records the times of trials, and finds the prefetch distance with the shortest median time.
#include "normals/curves/kernels/prefetch.h"

#include <algorithm>
#include <cassert>

namespace chronormal::inline internal {

std::optional<std::size_t> PrefetchRule::next() noexcept {
  const std::size_t all = kTrials * distances_;
  // A thread for which the following comparison is false takes the number of the next trial. Several threads may take
  // numbers at the same time.
  if (trials_.load(std::memory_order_relaxed) >= all) {
    if (calls_.fetch_add(1, std::memory_order_relaxed) % kCallsBetween != kCallsBetween - 1) return std::nullopt;
    trials_.store(0, std::memory_order_relaxed);
  }
  const std::size_t trial = trials_.fetch_add(1, std::memory_order_relaxed);
  if (trial >= all) return std::nullopt;
  return trial % distances_;
}

// Records a trial. The distance with the shortest median time is the best. The median ignores trials that the system
// interrupted or that found cold caches, and also a trial that was fast by chance.
void PrefetchRule::take(std::size_t distance, float nanoseconds_per_byte) noexcept {
  assert(distance < kDistances.size() && nanoseconds_per_byte > 0);
  const std::size_t trial = counts_[distance].fetch_add(1, std::memory_order_relaxed);
  times_[distance][trial % kTrials].store(nanoseconds_per_byte, std::memory_order_relaxed);
  std::size_t best = 0;
  float least = 0;
  for (std::size_t i = 0; i < kDistances.size(); ++i) {
    std::array<float, kTrials> times;
    std::size_t count = 0;
    for (const std::atomic<float>& time : times_[i]) {
      times[count] = time.load(std::memory_order_relaxed);
      if (times[count] > 0) ++count;
    }
    if (count == 0) continue;
    const auto middle = times.begin() + static_cast<std::ptrdiff_t>(count / 2);
    std::nth_element(times.begin(), middle, times.begin() + static_cast<std::ptrdiff_t>(count));
    if (least == 0 || *middle < least) best = i, least = *middle;
  }
  best_.store(kDistances[best], std::memory_order_relaxed);
}

namespace {

class Rules {
 public:
  PrefetchRule& operator[](WorkingSet set) noexcept { return rules_[static_cast<std::size_t>(set)]; }

 private:
  // Small working sets try only short distances. Other data may evict their curves from the L1 or L2 cache during a
  // trial, and the trial would then favour too large a distance.
  std::array<PrefetchRule, kWorkingSets> rules_ = {PrefetchRule(1), PrefetchRule(2), PrefetchRule(), PrefetchRule()};
};

}  // namespace

PrefetchRule& prefetch_of_curves(WorkingSet set) noexcept {
  static Rules rules;
  return rules[set];
}

PrefetchRule& prefetch_of_paths(WorkingSet set) noexcept {
  static Rules rules;
  return rules[set];
}

}  // namespace chronormal::inline internal
