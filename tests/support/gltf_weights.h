/// Computes the weights of morph targets over time by the formulas of the glTF specification (appendix C), in long
/// double. Also computes the positions of a motion at a time, to compare with morphed positions.
#ifndef CHRONORMAL_TESTS_SUPPORT_GLTF_WEIGHTS_H_
#define CHRONORMAL_TESTS_SUPPORT_GLTF_WEIGHTS_H_

#include <algorithm>
#include <cstddef>
#include <vector>

#include "chronormal/io/gltf_document.h"
#include "chronormal/motion/motion.h"

namespace chronormal::test {

/// Returns the weights of target_count targets at a time. `values` has the layout of glTF: (K, N), or (K, 3, N) for a
/// cubic spline, for K keys and N targets. With STEP, the weights of a key begin exactly at the time of the key.
[[nodiscard]] inline std::vector<double> weights_at(GltfInterpolation interpolation, const std::vector<float>& times,
                                                    const std::vector<float>& values, std::size_t target_count,
                                                    double time) {
  const bool is_cubic = interpolation == GltfInterpolation::kCubicSpline;
  const auto at = [&](std::size_t key, std::size_t which, std::size_t target) {
    const std::size_t index = is_cubic ? (3 * key + which) * target_count + target : key * target_count + target;
    return static_cast<long double>(values.at(index));
  };
  constexpr std::size_t kIn = 0, kValue = 1, kOut = 2;
  // `next` is the index of the first key after the time, or the number of keys.
  const auto after = std::upper_bound(times.begin(), times.end(), time, [](double t, float key) { return t < key; });
  const auto next = static_cast<std::size_t>(after - times.begin());
  std::vector<double> weights;
  for (std::size_t k = 0; k < target_count; ++k) {
    if (next == 0 || next == times.size()) {
      weights.push_back(static_cast<double>(at(next == 0 ? 0 : next - 1, kValue, k)));
      continue;
    }
    const std::size_t key = next - 1;
    const long double from = times[key], d = static_cast<long double>(times[next]) - from;
    const long double t = (static_cast<long double>(time) - from) / d, t2 = t * t, t3 = t2 * t;
    const long double a = at(key, kValue, k), b = at(next, kValue, k);
    long double weight = a;
    if (interpolation == GltfInterpolation::kLinear) weight = (1 - t) * a + t * b;
    if (is_cubic)
      weight = (2 * t3 - 3 * t2 + 1) * a + d * (t3 - 2 * t2 + t) * at(key, kOut, k) + (3 * t2 - 2 * t3) * b +
               d * (t3 - t2) * at(next, kIn, k);
    weights.push_back(static_cast<double>(weight));
  }
  return weights;
}

/// Returns all positions of a motion at a time, on the straight line between two keyframes. Before the first keyframe,
/// returns the positions of the first; after the last keyframe, returns the positions of the last.
[[nodiscard]] inline std::vector<double> positions_at(const Motion& motion, double time) {
  for (const Motion::SegmentKeys& segment : motion.segments) {
    const Motion::Keyframe& from = motion.keyframes.at(segment.from);
    const Motion::Keyframe& to = motion.keyframes.at(segment.to);
    if (time > to.time && &segment != &motion.segments.back()) continue;
    const double t = std::clamp((time - from.time) / (to.time - from.time), 0.0, 1.0);
    std::vector<double> positions;
    for (std::size_t i = 0; i < from.positions.size(); ++i)
      positions.push_back((1 - t) * static_cast<double>(from.positions[i]) + t * static_cast<double>(to.positions[i]));
    return positions;
  }
  return {};
}

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_GLTF_WEIGHTS_H_
