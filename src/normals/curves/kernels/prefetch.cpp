// Takes the times of trials, and keeps the shortest one for each distance.
#include "normals/curves/kernels/prefetch.h"

#include <cassert>

namespace chronormal::inline internal {

std::size_t PrefetchRule::best() const noexcept {
  std::size_t best = 0;
  float least = 0;
  for (std::size_t i = 0; i < kDistances.size(); ++i) {
    const float time = least_[i].load(std::memory_order_relaxed);
    if (time > 0 && (least == 0 || time < least)) best = i, least = time;
  }
  return kDistances[best];
}

std::optional<std::size_t> PrefetchRule::next() noexcept {
  constexpr std::size_t kAll = kTrials * kDistances.size();
  // Several threads may get as far as the second line at once, each with a number of its own; later ones do not count on.
  if (trials_.load(std::memory_order_relaxed) >= kAll) return std::nullopt;
  const std::size_t trial = trials_.fetch_add(1, std::memory_order_relaxed);
  if (trial >= kAll) return std::nullopt;
  return trial % kDistances.size();
}

void PrefetchRule::take(std::size_t distance, float nanoseconds_per_byte) noexcept {
  assert(distance < kDistances.size() && nanoseconds_per_byte > 0);
  float before = least_[distance].load(std::memory_order_relaxed);
  while ((before == 0 || nanoseconds_per_byte < before) &&
         !least_[distance].compare_exchange_weak(before, nanoseconds_per_byte, std::memory_order_relaxed)) {
  }
}

PrefetchRule& prefetch_in_shared_cache() noexcept {
  static PrefetchRule rule;
  return rule;
}

PrefetchRule& prefetch_in_memory() noexcept {
  static PrefetchRule rule;
  return rule;
}

}  // namespace chronormal::inline internal
