#include "normals/curves/kernels/curve_blocks.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace chronormal::inline internal {
namespace {

constexpr double kLargestWeight = 32767;
// The largest sum of integer weights. Up to this sum, weighted sums of control normals of up to 32767 stay in the range
// of int32.
constexpr double kLargestSum = 65532;

std::int32_t pair_of(std::int32_t low, std::int32_t high) { return (low & 0xFFFF) | (high * 65536); }

// Returns integers whose ratios are nearly those of the weights. A direction depends only on ratios, so the function
// tries several scales and takes the one with the smallest rounding errors.
template <std::size_t kCount>
std::array<std::int32_t, kCount> integer_weights(const std::array<double, kCount>& weights) {
  constexpr int kTrials = 16, kStep = 256;
  const double largest_scale =
      std::min(kLargestWeight / *std::max_element(weights.begin(), weights.end()), kLargestSum);
  std::array<std::int32_t, kCount> best{};
  double smallest_error = 2, its_scale = 1;  // errors are in units of 1 / scale
  for (int trial = 0; trial < kTrials && smallest_error > 0; ++trial) {
    const double scale = largest_scale - trial * kStep;
    std::array<std::int32_t, kCount> rounded;
    double error = 0;
    for (std::size_t k = 0; k < kCount; ++k) {
      const double exact = weights[k] * scale;
      rounded[k] = static_cast<std::int32_t>(std::lround(exact));
      error += std::fabs(rounded[k] - exact);
    }
    if (error * its_scale < smallest_error * scale) {
      smallest_error = error;
      its_scale = scale;
      best = rounded;
    }
  }
  return best;
}

}  // namespace

CurveWeights CurveWeights::at(const LocalTime& time, bool compact) noexcept {
  const double t = time.t, s = time.rest;
  CurveWeights weights{{static_cast<float>(s), static_cast<float>(t)},
                       {static_cast<float>(s * s), static_cast<float>(2 * t * s), static_cast<float>(t * t)}};
  if (compact) {
    const auto linear = integer_weights<2>({s, t});
    const auto quadratic = integer_weights<3>({s * s, 2 * t * s, t * t});
    weights.linear16 = pair_of(linear[0], linear[1]);
    weights.ends16 = pair_of(quadratic[0], quadratic[2]);
    weights.middle16 = quadratic[1];
    weights.middle_low = (quadratic[1] + 16) / 32;
  }
  return weights;
}

}  // namespace chronormal::inline internal
