// Evaluates the channel of one weight at the keys of all weights of its node. These additional keys split the curve
// into more pieces. A piece of a line, step or cubic is again a line, step or cubic, so the curve stays exact.
#include "io/gltf/gltf_lone_weights.h"

namespace chronormal::inline internal::gltf {
namespace {

// The value of a curve at a key, and its tangents before and after the key.
struct Row {
  double in_tangent = 0, value = 0, out_tangent = 0;
};

double number(std::span<const float> numbers, std::size_t i) { return static_cast<double>(numbers[i]); }

// Returns the value and the tangents of key k as the file stores them. The tangents are 0 unless the channel is a cubic
// spline.
Row key_at(const LoneKeys& keys, std::size_t k) {
  if (keys.interpolation != GltfInterpolation::kCubicSpline) return {0, number(keys.values, k), 0};
  return {number(keys.values, 3 * k), number(keys.values, 3 * k + 1), number(keys.values, 3 * k + 2)};
}

// Returns the slope of the line from key k to the next key.
double slope_after(const LoneKeys& keys, std::size_t k) {
  return (number(keys.values, k + 1) - number(keys.values, k)) / (number(keys.times, k + 1) - number(keys.times, k));
}

// Returns the value and the tangents at key k of the channel. is_first and is_last tell whether the key is also the
// first or last of the track. On a side where the channel is constant, the tangent is 0.
Row row_at_key(const LoneKeys& keys, std::size_t k, bool is_first, bool is_last) {
  Row row = key_at(keys, k);
  const bool begins = k == 0, ends = k + 1 == keys.times.size();
  if (keys.interpolation == GltfInterpolation::kLinear) {
    row.in_tangent = begins ? 0 : slope_after(keys, k - 1);
    row.out_tangent = ends ? 0 : slope_after(keys, k);
  } else {
    if (begins && !is_first) row.in_tangent = 0;
    if (ends && !is_last) row.out_tangent = 0;
  }
  return row;
}

// Returns the value and the tangents of the channel at a time between key k and key k + 1.
Row row_between(const LoneKeys& keys, std::size_t k, double time) {
  const Row from = key_at(keys, k), to = key_at(keys, k + 1);
  const double begin = number(keys.times, k), duration = number(keys.times, k + 1) - begin;
  const double s = (time - begin) / duration;
  switch (keys.interpolation) {
    case GltfInterpolation::kStep:
      return {0, from.value, 0};
    case GltfInterpolation::kLinear: {
      const double slope = slope_after(keys, k);
      return {slope, from.value + s * (to.value - from.value), slope};
    }
    case GltfInterpolation::kCubicSpline:
      break;
  }
  // Uses the formula in appendix C.4 of the specification, and its derivative with respect to time.
  const double rise = to.value - from.value;
  const double value = from.value + s * s * (3 - 2 * s) * rise +
                       duration * s * (1 - s) * ((1 - s) * from.out_tangent - s * to.in_tangent);
  const double slope =
      6 * s * (1 - s) * rise / duration + (1 - s) * (1 - 3 * s) * from.out_tangent + s * (3 * s - 2) * to.in_tangent;
  return {slope, value, slope};
}

}  // namespace

void write_column(const LoneKeys& keys, std::span<const float> times, bool is_cubic_track, std::size_t target,
                  std::size_t width, std::span<double> values) noexcept {
  // The index of the first key of the channel that is not before times[i].
  std::size_t next = 0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    while (next < keys.times.size() && keys.times[next] < times[i]) ++next;
    Row row;
    if (next < keys.times.size() && keys.times[next] == times[i])
      row = row_at_key(keys, next, i == 0, i + 1 == times.size());
    else if (next == 0)
      row = {0, key_at(keys, 0).value, 0};
    else if (next == keys.times.size())
      row = {0, key_at(keys, next - 1).value, 0};
    else
      row = row_between(keys, next - 1, static_cast<double>(times[i]));
    if (!is_cubic_track) {
      values[target + width * i] = row.value;
      continue;
    }
    values[target + width * (3 * i)] = row.in_tangent;
    values[target + width * (3 * i + 1)] = row.value;
    values[target + width * (3 * i + 2)] = row.out_tangent;
  }
}

}  // namespace chronormal::inline internal::gltf
