#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "memory/bandwidth.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace chronormal::bench::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kAhead = 2048;  // bytes between the data in use and the data that are prefetched

// Adds up 64-bit words. `bytes` must be a multiple of 512, here and in the functions below.
template <bool kPrefetch>
std::uint64_t Read(const std::byte* from, std::size_t bytes) {
  const hn::ScalableTag<std::uint64_t> tag;
  const std::size_t lanes = hn::Lanes(tag);
  const auto* words = reinterpret_cast<const std::uint64_t*>(from);
  auto sum0 = hn::Zero(tag), sum1 = sum0, sum2 = sum0, sum3 = sum0;
  for (std::size_t i = 0; i < bytes / 8; i += 4 * lanes) {
    if constexpr (kPrefetch) {
      for (std::size_t line = 0; line < 32 * lanes; line += 64) hwy::Prefetch(words + i + (kAhead + line) / 8);
    }
    sum0 = hn::Add(sum0, hn::Load(tag, words + i));
    sum1 = hn::Add(sum1, hn::Load(tag, words + i + lanes));
    sum2 = hn::Add(sum2, hn::Load(tag, words + i + 2 * lanes));
    sum3 = hn::Add(sum3, hn::Load(tag, words + i + 3 * lanes));
  }
  return hn::GetLane(hn::SumOfLanes(tag, hn::Add(hn::Add(sum0, sum1), hn::Add(sum2, sum3))));
}

// Sets to = from, or to = from + 3 * third if kTriad is true. If kStream is true, stores bypass the caches.
template <bool kTriad, bool kStream, bool kPrefetch>
void Stream(const std::byte* from, const std::byte* third, std::byte* to, std::size_t bytes) {
  const hn::ScalableTag<float> tag;
  const std::size_t lanes = hn::Lanes(tag);
  const auto* a = reinterpret_cast<const float*>(from);
  const auto* b = reinterpret_cast<const float*>(third);
  auto* result = reinterpret_cast<float*>(to);
  const auto three = hn::Set(tag, 3.0f);
  for (std::size_t i = 0; i < bytes / 4; i += 4 * lanes) {
    if constexpr (kPrefetch) {
      for (std::size_t line = 0; line < 16 * lanes; line += 64) {
        hwy::Prefetch(a + i + (kAhead + line) / 4);
        if constexpr (kTriad) hwy::Prefetch(b + i + (kAhead + line) / 4);
      }
    }
    for (std::size_t k = 0; k < 4 * lanes; k += lanes) {
      auto value = hn::Load(tag, a + i + k);
      if constexpr (kTriad) value = hn::Add(value, hn::Mul(three, hn::Load(tag, b + i + k)));
      if constexpr (kStream) {
        hn::Stream(value, tag, result + i + k);
      } else {
        hn::Store(value, tag, result + i + k);
      }
    }
  }
  if constexpr (kStream) hwy::FlushStream();
}

std::uint64_t ReadPlain(const std::byte* from, std::size_t bytes) { return Read<false>(from, bytes); }
std::uint64_t ReadAhead(const std::byte* from, std::size_t bytes) { return Read<true>(from, bytes); }

// Copies in one of four ways. Ways 0 and 3 use ordinary stores, and ways 1 and 2 use stores that bypass the caches.
// Ways 2 and 3 also prefetch.
void Copy(int way, const std::byte* from, std::byte* to, std::size_t bytes) {
  if (way == 0) Stream<false, false, false>(from, nullptr, to, bytes);
  if (way == 1) Stream<false, true, false>(from, nullptr, to, bytes);
  if (way == 2) Stream<false, true, true>(from, nullptr, to, bytes);
  if (way == 3) Stream<false, false, true>(from, nullptr, to, bytes);
}
void Triad(int way, const std::byte* from, const std::byte* third, std::byte* to, std::size_t bytes) {
  if (way == 0) Stream<true, false, false>(from, third, to, bytes);
  if (way == 1) Stream<true, true, false>(from, third, to, bytes);
  if (way == 2) Stream<true, true, true>(from, third, to, bytes);
  if (way == 3) Stream<true, false, true>(from, third, to, bytes);
}

}  // namespace chronormal::bench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "memory/bandwidth.h"

namespace chronormal::bench {
namespace {

HWY_EXPORT(ReadPlain);
HWY_EXPORT(ReadAhead);
HWY_EXPORT(Copy);
HWY_EXPORT(Triad);

constexpr std::size_t kPiece = 512, kLargest = std::size_t{256} << 20, kBeyond = 4096;  // sizes in bytes
constexpr int kWays = 4;
constexpr std::size_t kFunctions = 2 + 2 * kWays;  // number of functions for each working set

std::size_t rounded(std::size_t working_set) {
  const double step = std::log(1.2);
  const double exponent = std::round(std::log(static_cast<double>(std::max<std::size_t>(working_set, 1))) / step);
  const double bytes = std::min(std::exp(exponent * step), static_cast<double>(kLargest));
  return std::max<std::size_t>(6 * kPiece, static_cast<std::size_t>(bytes) / (6 * kPiece) * (6 * kPiece));
}

double best(const Timed& timed) { return *std::min_element(timed.nanoseconds.begin(), timed.nanoseconds.end()); }

}  // namespace

void BandwidthMeter::want(std::size_t working_set) { measured_.try_emplace(rounded(working_set)); }

void BandwidthMeter::append(std::vector<Timed>& functions) {
  std::size_t largest = 0;
  for (const auto& [bytes, bandwidth] : measured_) largest = std::max(largest, bytes);
  if (arena_.size() < largest + kBeyond) {
    arena_ = {};
    arena_ = AlignedBytes(largest + kBeyond);
    std::memset(arena_.data(), 0, arena_.size());
  }
  std::byte* const memory = arena_.data();
  for (const auto& [bytes, bandwidth] : measured_) {
    if (bandwidth.bytes != 0) continue;
    const std::size_t all = bytes, half = all / 2, third = all / 3;
    functions.push_back({[=] { benchmark::DoNotOptimize(HWY_DYNAMIC_DISPATCH(ReadPlain)(memory, all)); }});
    functions.push_back({[=] { benchmark::DoNotOptimize(HWY_DYNAMIC_DISPATCH(ReadAhead)(memory, all)); }});
    for (int way = 0; way < kWays; ++way) {
      functions.push_back({[=] { HWY_DYNAMIC_DISPATCH(Copy)(way, memory, memory + half, half); }});
      functions.push_back({[=] {
        HWY_DYNAMIC_DISPATCH(Triad)(way, memory, memory + third, memory + 2 * third, third);
      }});
    }
  }
}

void BandwidthMeter::take(const std::vector<Timed>& functions, std::size_t first) {
  for (auto& [bytes, bandwidth] : measured_) {
    if (bandwidth.bytes != 0 || first + kFunctions > functions.size()) continue;
    const double size = static_cast<double>(bytes);
    bandwidth.bytes = bytes;
    bandwidth.read = size / std::min(best(functions[first]), best(functions[first + 1]));
    for (std::size_t way = 0; way < kWays; ++way) {
      bandwidth.copy = std::max(bandwidth.copy, size / best(functions[first + 2 + 2 * way]));
      bandwidth.stream = std::max(bandwidth.stream, size / best(functions[first + 3 + 2 * way]));
    }
    bandwidth.stream = std::max(bandwidth.stream, bandwidth.copy);
    first += kFunctions;
  }
}

Bandwidth BandwidthMeter::at(std::size_t working_set) const {
  const auto found = measured_.find(rounded(working_set));
  return found == measured_.end() ? Bandwidth{} : found->second;
}

std::vector<Bandwidth> BandwidthMeter::all() const {
  std::vector<Bandwidth> result;
  for (const auto& [bytes, bandwidth] : measured_) result.push_back(bandwidth);
  return result;
}

}  // namespace chronormal::bench

#endif  // HWY_ONCE
