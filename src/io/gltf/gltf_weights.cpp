#include "io/gltf/gltf_weights.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace chronormal::inline internal::gltf {

double WeightCurve::value(std::size_t key, std::size_t target) const noexcept {
  const bool cubic = interpolation_ == GltfInterpolation::kCubicSpline;
  return keys_.values[(cubic ? 3 * key + 1 : key) * target_count_ + target];
}

double WeightCurve::tangent(std::size_t key, bool out, std::size_t target) const noexcept {
  return keys_.values[(3 * key + (out ? 2 : 0)) * target_count_ + target];
}

void WeightCurve::at(double time, bool just_before, std::span<double> weights) const noexcept {
  assert(weights.size() == target_count_);
  const std::vector<double>& times = keys_.times;
  // Find the last key that is not after the time. If the weights just before a key are wanted, find the last key before
  // the time.
  const auto after = just_before ? std::lower_bound(times.begin(), times.end(), time)
                                 : std::upper_bound(times.begin(), times.end(), time);
  const std::size_t next = static_cast<std::size_t>(after - times.begin());
  const std::size_t key = next == 0 ? 0 : next - 1;
  const bool outside = next == 0 || next == times.size();
  if (outside || interpolation_ == GltfInterpolation::kStep) {
    for (std::size_t i = 0; i < target_count_; ++i) weights[i] = value(key, i);
    return;
  }
  const double duration = times[next] - times[key], t = (time - times[key]) / duration;
  for (std::size_t i = 0; i < target_count_; ++i) {
    const double from = value(key, i), to = value(next, i);
    if (interpolation_ == GltfInterpolation::kLinear) {
      weights[i] = (1 - t) * from + t * to;
      continue;
    }
    const double leaving = duration * tangent(key, true, i), arriving = duration * tangent(next, false, i);
    const double s = 1 - t;
    // Evaluates the cubic Hermite spline in the Bernstein basis.
    weights[i] =
        s * s * s * from + 3 * s * s * t * (from + leaving / 3) + 3 * s * t * t * (to - arriving / 3) + t * t * t * to;
  }
}

void WeightCurve::curvature(double from_time, double to_time, std::span<double> bounds) const noexcept {
  assert(bounds.size() == target_count_);
  const std::vector<double>& times = keys_.times;
  std::fill(bounds.begin(), bounds.end(), 0.0);
  if (interpolation_ != GltfInterpolation::kCubicSpline || from_time < times.front() || to_time > times.back()) return;
  const std::size_t next =
      static_cast<std::size_t>(std::upper_bound(times.begin(), times.end() - 1, from_time) - times.begin());
  const std::size_t key = next - 1;
  const double duration = times[next] - times[key];
  for (std::size_t i = 0; i < target_count_; ++i) {
    const double from = value(key, i), to = value(next, i);
    const double leaving = duration * tangent(key, true, i), arriving = duration * tangent(next, false, i);
    // The second derivative of a weight is linear in time, so its absolute value is largest at an end of the interval.
    const double at_start = 6 * (to - from) - 4 * leaving - 2 * arriving;
    const double at_end = 6 * (from - to) + 2 * leaving + 4 * arriving;
    for (const double time : {from_time, to_time}) {
      const double t = (time - times[key]) / duration;
      bounds[i] = std::max(bounds[i], std::fabs((1 - t) * at_start + t * at_end) / (duration * duration));
    }
  }
}

}  // namespace chronormal::inline internal::gltf
