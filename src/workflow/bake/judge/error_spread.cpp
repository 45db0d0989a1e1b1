// Counts errors in bins that are a sixteenth of an octave wide.
#include "workflow/bake/judge/error_spread.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/bits.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kBins = ErrorSpread::kBins;
constexpr float kLeastBin = 1e-3F;

// The exponent of a float counts octaves, and the first four bits of its fraction sixteenths of one.
std::size_t bin_of(float degrees) {
  const auto bits = bit_cast<std::uint32_t>(std::max(degrees, kLeastBin) / kLeastBin);
  return std::min<std::size_t>(kBins - 1, (bits >> 19) - (127U << 4));
}

// Returns where such a bin ends.
double end_of(std::size_t bin) {
  const auto octave = static_cast<int>(bin / 16);
  const double part = 1 + static_cast<double>(bin % 16 + 1) / 16;
  return static_cast<double>(kLeastBin) * std::ldexp(part, octave);
}

}  // namespace

void ErrorSpread::add(const ErrorSpread& other) {
  count += other.count;
  sum += other.sum;
  worst = std::fmax(worst, other.worst);
  for (std::size_t b = 0; b < kBins; ++b) bins[b] += other.bins[b];
}

ShownErrors ErrorSpread::errors() const {
  ShownErrors result{count, count > 0 ? sum / static_cast<double>(count) : 0, 0, worst};
  std::size_t beyond = count / 1000, b = kBins - 1;
  while (b > 0 && bins[b] <= beyond) beyond -= bins[b--];
  result.most = b == 0 ? 0 : std::fmin(end_of(b), worst);
  return result;
}

void GatheredErrors::add(std::size_t vertex, std::span<const float> errors, std::span<const float> known) {
  // The errors of one vertex lie in few bins, so that they are counted here first. Between calls all of these are empty.
  thread_local std::array<std::uint32_t, kBins> of_thread{};
  std::uint32_t* const here = of_thread.data();
  std::size_t lowest = kBins, highest = 0;
  float all = 0, most = 0;
  std::uint32_t count = 0;
  for (std::size_t p = 0; p < errors.size(); ++p) {
    if (known[p] < 0) continue;
    all += errors[p];
    most = std::max(most, errors[p]);
    ++count;
    const std::size_t bin = bin_of(errors[p]);
    ++here[bin];
    lowest = std::min(lowest, bin);
    highest = std::max(highest, bin);
  }
  sum[vertex] += all;
  worst[vertex] = std::max(worst[vertex], most);
  counts[vertex] += count;
  for (std::size_t b = lowest; b <= highest; ++b)
    if (here[b] > 0) bins[b].fetch_add(std::exchange(here[b], 0), std::memory_order_relaxed);
}

ErrorSpread GatheredErrors::spread() const {
  ErrorSpread result;
  for (std::size_t n = 0; n < sum.size(); ++n) {
    result.count += counts[n];
    result.sum += static_cast<double>(sum[n]);
    result.worst = std::fmax(result.worst, static_cast<double>(worst[n]));
  }
  for (std::size_t b = 0; b < kBins; ++b) result.bins[b] = bins[b];
  return result;
}

}  // namespace chronormal::inline internal
