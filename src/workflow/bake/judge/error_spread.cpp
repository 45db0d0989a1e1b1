// Counts errors in bins that are an eighth of an octave wide.
#include "workflow/bake/judge/error_spread.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/bits.h"
#include "core/portable_math.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kBins = ErrorSpread::kBins;
constexpr float kBinsPerOctave = 8, kLeastBin = 1e-3F;

// The exponent of a float counts octaves, and its fraction is held against eighths of one.
std::size_t bin_of(float degrees) {
  constexpr std::array<float, 7> kEighths = {1.0905077F, 1.1892071F, 1.2968396F, 1.4142135F,
                                             1.5422108F, 1.6817929F, 1.8340081F};
  const auto bits = bit_cast<std::uint32_t>(std::max(degrees, kLeastBin) / kLeastBin);
  const float fraction = bit_cast<float>((bits & 0x007FFFFFU) | 0x3F800000U);
  std::size_t bin = std::size_t{8} * ((bits >> 23) - 127);
  for (const float eighth : kEighths) bin += fraction >= eighth ? 1 : 0;
  return std::min(kBins - 1, bin);
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
  const float upper = kLeastBin * static_cast<float>(portable::exp2(static_cast<double>(b + 1) / kBinsPerOctave));
  result.most = b == 0 ? 0 : std::fmin(static_cast<double>(upper), worst);
  return result;
}

void GatheredErrors::add(std::size_t vertex, std::span<const float> errors, std::span<const float> known) {
  // The errors of one vertex lie in few bins. Between calls all of these are empty.
  thread_local std::array<std::uint32_t, kBins> here{};
  std::size_t lowest = kBins, highest = 0;
  for (std::size_t p = 0; p < errors.size(); ++p) {
    if (known[p] < 0) continue;
    sum[vertex] += errors[p];
    worst[vertex] = std::fmax(worst[vertex], errors[p]);
    ++counts[vertex];
    const std::size_t bin = bin_of(errors[p]);
    ++here[bin];
    lowest = std::min(lowest, bin);
    highest = std::max(highest, bin);
  }
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
