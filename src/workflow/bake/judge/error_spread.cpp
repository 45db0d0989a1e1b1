// Counts errors in bins. Each factor of two in the error has sixteen bins.
#include "workflow/bake/judge/error_spread.h"

#include <algorithm>
#include <cmath>

#include "core/bits.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kBins = ErrorSpread::kBins;
constexpr float kLeastBin = 1e-3F;

// Returns the bin of an error in degrees. An octave is a factor of two. In the bits of a float, the exponent counts
// octaves, and the first four bits of the fraction count sixteenths of an octave.
std::size_t bin_of(float degrees) {
  const auto bits = bit_cast<std::uint32_t>(std::max(degrees * (1 / kLeastBin), 1.0F));
  return std::min<std::size_t>(kBins - 1, (bits >> 19) - (127U << 4));
}

// Returns the upper end of a bin in degrees.
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

void ErrorSpread::add(std::span<const float> errors) {
  float of_these = 0, most = 0;
  for (const float error : errors) {
    if (error < 0) continue;
    of_these += error;
    most = std::max(most, error);
    ++bins[bin_of(error)];
    ++count;
  }
  sum += static_cast<double>(of_these);
  worst = std::fmax(worst, static_cast<double>(most));
}

ShownErrors ErrorSpread::errors() const {
  ShownErrors result{count, count > 0 ? sum / static_cast<double>(count) : 0, 0, worst};
  std::size_t beyond = count / 1000, b = kBins - 1;
  while (b > 0 && bins[b] <= beyond) beyond -= bins[b--];
  result.most = b == 0 ? 0 : std::fmin(end_of(b), worst);
  return result;
}

}  // namespace chronormal::inline internal
