/// Computes the normals that viewers render, in double and in integers, without the library. Plain loops evaluate the
/// formulas in the sources of the viewers. Each viewer has its own code, under its name.
#ifndef CHRONORMAL_TESTS_SUPPORT_VIEWER_ORACLE_H_
#define CHRONORMAL_TESTS_SUPPORT_VIEWER_ORACLE_H_

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/io/gltf_document.h"
#include "tests/support/gltf_weights.h"

namespace chronormal::test {

using Triple = std::array<double, 3>;

[[nodiscard]] inline Triple scaled_to_one(const Triple& v) {
  const double size = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  return size > 0 ? Triple{v[0] / size, v[1] / size, v[2] / size} : Triple{};
}

/// Rounds a value to a 16-bit float: keeps ten binary digits after the first, and rounds up if the first dropped digit
/// is 1.
[[nodiscard]] inline double as_half(double value) {
  const auto narrow = static_cast<float>(value);
  std::uint32_t bits = 0;
  std::memcpy(&bits, &narrow, 4);
  const int exponent = static_cast<int>((bits >> 23) & 255U) - 127;
  std::uint32_t digits = bits & 0x7FFFFFU;
  int dropped = 13;
  if (exponent < -14) {  // subnormal numbers have fewer digits
    if (exponent < -26) return 0;
    digits |= 0x800000U;
    dropped += -14 - exponent;
    const double kept = static_cast<double>((digits + (1U << (dropped - 1))) >> dropped);
    return std::copysign(kept * std::pow(2.0, -24), value);
  }
  const double kept = static_cast<double>((digits + (1U << (dropped - 1))) >> dropped) / 1024;
  return std::copysign((1 + kept) * std::pow(2.0, exponent), value);
}

/// Projects a direction onto an octahedron, and returns two coordinates. The lower half of the octahedron is folded
/// outwards. `sum` is |x| + |y| + |z|.
[[nodiscard]] inline std::array<double, 2> on_octahedron(const Triple& v, double sum) {
  const double x = v[0] / sum, y = v[1] / sum;
  if (v[2] >= 0) return {x, y};
  return {(1 - std::fabs(y)) * (x >= 0 ? 1 : -1), (1 - std::fabs(x)) * (y >= 0 ? 1 : -1)};
}

/// Encodes and decodes a direction as Godot does: on an octahedron, with two coordinates that are truncated to integers
/// from 0 to 65535.
[[nodiscard]] inline Triple through_godot(const Triple& v) {
  const double sum = std::fabs(v[0]) + std::fabs(v[1]) + std::fabs(v[2]);
  if (sum == 0) return {};
  auto [x, y] = on_octahedron(v, sum);
  const auto kept_x = static_cast<std::uint16_t>((x * 0.5 + 0.5) * 65535);
  const auto kept_y = static_cast<std::uint16_t>((y * 0.5 + 0.5) * 65535);
  x = kept_x / 65535.0 * 2 - 1;
  y = kept_y / 65535.0 * 2 - 1;
  const double z = 1 - std::fabs(x) - std::fabs(y);
  if (z < 0) {
    x += x >= 0 ? z : -z;
    y += y >= 0 ? z : -z;
  }
  return scaled_to_one({x, y, z});
}

/// Encodes and decodes a normal as Filament does without texture coordinates. Makes a frame (t, n x t, n) by Frisvad's
/// rule, and converts its matrix to a quaternion by the four cases of Shepperd's method. Then rounds the quaternion to
/// four 16-bit integers, and returns the third axis of the decoded frame.
[[nodiscard]] inline Triple through_filament(const Triple& n) {
  if (n == Triple{}) return {};
  const double a = 1 / (1 + n[1]);
  Triple t = {-n[2] * n[0] * a, -n[2], 1 - n[2] * n[2] * a};
  if (n[1] < -0.9999999) t = {-1, 0, 0};
  const Triple b = {n[1] * t[2] - n[2] * t[1], n[2] * t[0] - n[0] * t[2], n[0] * t[1] - n[1] * t[0]};
  double w = 0, x = 0, y = 0, z = 0;  // each component of the quaternion, times four times the largest one
  if (t[0] + b[1] + n[2] > 0) {
    w = 1 + t[0] + b[1] + n[2], x = b[2] - n[1], y = n[0] - t[2], z = t[1] - b[0];
  } else if (t[0] >= b[1] && t[0] >= n[2]) {
    w = b[2] - n[1], x = 1 + t[0] - b[1] - n[2], y = t[1] + b[0], z = n[0] + t[2];
  } else if (b[1] >= n[2]) {
    w = n[0] - t[2], x = t[1] + b[0], y = 1 + b[1] - n[2] - t[0], z = n[1] + b[2];
  } else {
    w = t[1] - b[0], x = n[0] + t[2], y = n[1] + b[2], z = 1 + n[2] - t[0] - b[1];
  }
  const double size = std::sqrt(w * w + x * x + y * y + z * z);
  for (double* part : {&w, &x, &y, &z}) *part = std::round(*part / size * 32767) / 32767;
  return scaled_to_one({2 * x * z + 2 * w * y, 2 * y * z - 2 * w * x, 1 - 2 * x * x - 2 * y * y});
}

/// Returns the integer that is nearest to value * most. Finds it by trying all integers. If two integers are equally
/// near, returns the integer with the larger absolute value.
[[nodiscard]] inline int nearest_integer(double value, int most) {
  int best = 0;
  for (int k = 1; k <= most; ++k)
    if (std::fabs(k - std::fabs(value) * most) <= std::fabs(best - std::fabs(value) * most)) best = k;
  return value < 0 ? -best : best;
}

/// Rounds a component of a normal as gltfpack does, and as glTF Transform does with 8 bits.
[[nodiscard]] inline double as_byte(double value) { return nearest_integer(value, 127) / 127.0; }

/// Rounds a component of a normal as glTF Transform does with 10 bits: the file stores a sign and nine binary digits,
/// and the leading digits are repeated to make fifteen digits.
[[nodiscard]] inline double as_ten_bits(double value) {
  std::string digits;
  const int kept = std::abs(nearest_integer(value, 511));
  for (int bit = 8; bit >= 0; --bit) digits += ((kept >> bit) & 1) != 0 ? '1' : '0';
  const std::string fifteen = (digits + digits).substr(0, 15);
  return std::copysign(std::stoi(fifteen, nullptr, 2) / 32767.0, value);
}

/// Encodes and decodes a direction as the meshopt command of glTF Transform does: first on an octahedron with
/// coordinates from -127 to 127, and then as three bytes.
[[nodiscard]] inline Triple through_meshopt(const Triple& v) {
  const double sum = std::fabs(v[0]) + std::fabs(v[1]) + std::fabs(v[2]);
  if (sum == 0) return {};
  auto [x, y] = on_octahedron(v, sum);
  x = as_byte(x);
  y = as_byte(y);
  const double z = 1 - std::fabs(x) - std::fabs(y);
  if (z < 0) {
    x += x >= 0 ? z : -z;
    y += y >= 0 ? z : -z;
  }
  const Triple u = scaled_to_one({x, y, z});
  return {as_byte(u[0]), as_byte(u[1]), as_byte(u[2])};
}

[[nodiscard]] inline Triple each(const Triple& v, double (*change)(double)) {
  return {change(v[0]), change(v[1]), change(v[2])};
}

/// Returns the unit normal that a viewer renders for a base normal, its deltas and these weights.
[[nodiscard]] inline Triple shown_by(std::string_view viewer, const Triple& normal, const std::vector<Triple>& deltas,
                                     const std::vector<double>& weights) {
  const auto plus = [](const Triple& a, double w, const Triple& b) {
    return Triple{a[0] + w * b[0], a[1] + w * b[1], a[2] + w * b[2]};
  };
  Triple sum = normal;
  if (viewer == "three" || viewer == "babylon" || viewer == "bevy") {
    for (std::size_t k = 0; k < deltas.size(); ++k) sum = plus(sum, weights[k], deltas[k]);
  } else if (viewer == "playcanvas") {
    Triple change{};
    for (std::size_t k = 0; k < deltas.size(); ++k)
      if (std::fabs(weights[k]) > 1e-5) change = plus(change, weights[k], each(deltas[k], as_half));
    sum = plus(sum, 1, each(change, as_half));
  } else if (viewer == "godot") {
    double total = 0;
    Triple targets{};
    for (std::size_t k = 0; k < deltas.size(); ++k) {
      if (!(std::fabs(weights[k]) > 0.0001)) continue;
      targets = plus(targets, weights[k], through_godot(plus(normal, 1, deltas[k])));
      total += weights[k];
    }
    sum = plus(targets, 1 - total, through_godot(normal));
  } else if (viewer == "filament") {
    const Triple base = through_filament(normal);
    sum = base;
    for (std::size_t k = 0; k < deltas.size(); ++k) {
      const Triple target = through_filament(plus(normal, 1, deltas[k]));
      sum = plus(sum, weights[k], plus(target, -1, base));
    }
  } else if (viewer == "gltfpack") {
    sum = each(normal, as_byte);
    for (std::size_t k = 0; k < deltas.size(); ++k) sum = plus(sum, weights[k], each(deltas[k], as_byte));
  } else if (viewer == "quantize") {
    sum = each(normal, as_ten_bits);
    for (std::size_t k = 0; k < deltas.size(); ++k) sum = plus(sum, weights[k], each(deltas[k], as_ten_bits));
  } else if (viewer == "meshopt") {
    sum = through_meshopt(normal);
    for (std::size_t k = 0; k < deltas.size(); ++k) sum = plus(sum, weights[k], each(deltas[k], as_byte));
  } else {
    throw std::invalid_argument("the oracle knows no such viewer");
  }
  return scaled_to_one(sum);
}

/// Returns the weights that a viewer computes from the keyframes of a track at `time`. All times are in seconds. The
/// animation starts at `start` and ends at `end`.
[[nodiscard]] inline std::vector<double> played_by(std::string_view viewer, GltfInterpolation interpolation,
                                                   const std::vector<float>& times, const std::vector<float>& values,
                                                   std::size_t targets, double start, double end, double time) {
  const auto specified = [&](double at) { return weights_at(interpolation, times, values, targets, at); };
  const auto mixed = [](const std::vector<double>& a, const std::vector<double>& b, double t) {
    std::vector<double> result;
    for (std::size_t i = 0; i < a.size(); ++i) result.push_back(a[i] + t * (b[i] - a[i]));
    return result;
  };
  const bool is_spline = interpolation == GltfInterpolation::kCubicSpline;
  if (viewer == "filament" && is_spline) {
    if (time <= static_cast<double>(times.front()) || time >= static_cast<double>(times.back())) return specified(time);
    std::size_t next = 1;
    while (static_cast<double>(times[next]) < time) ++next;
    const double from = times[next - 1], t = (time - from) / (static_cast<double>(times[next]) - from);
    std::vector<double> weights;
    for (std::size_t i = 0; i < targets; ++i) {
      const auto of_key = [&](std::size_t key, std::size_t which) {
        return static_cast<double>(values[(3 * key + which) * targets + i]);
      };
      weights.push_back((2 * t * t * t - 3 * t * t + 1) * of_key(next - 1, 1) +
                        (t * t * t - 2 * t * t + t) * of_key(next - 1, 2) * t +
                        (3 * t * t - 2 * t * t * t) * of_key(next, 1) + (t * t * t - t * t) * of_key(next, 0) * t);
    }
    return weights;
  }
  if (viewer == "playcanvas" && is_spline) {
    // A keyframe of a cubic spline has three numbers for each target. PlayCanvas makes a separate track of each number.
    const std::size_t tracks = values.size() / times.size(), keys = times.size();
    std::vector<double> weights;
    for (std::size_t j = 0; j < targets; ++j) {
      std::vector<double> data;
      for (std::size_t k = 0; k < keys; ++k) data.push_back(static_cast<double>(values[k * tracks + j]));
      const auto number = [&](std::size_t i) { return i < data.size() ? data[i] : std::nan(""); };
      std::size_t left = 0, right = 0;
      double length = 0, t = 0;
      if (time >= static_cast<double>(times.back())) {
        left = right = keys - 1;
      } else if (time >= static_cast<double>(times.front())) {
        while (time >= static_cast<double>(times[left + 1])) ++left;
        right = left + 1;
        length = static_cast<double>(times[right]) - static_cast<double>(times[left]);
        t = (time - static_cast<double>(times[left])) / length;
      }
      const double weight = (1 + 2 * t) * (1 - t) * (1 - t) * number(left * 3 + 1) +
                            t * (1 - t) * (1 - t) * number(left * 3 + 2) * length +
                            t * t * (3 - 2 * t) * number(right * 3 + 1) + t * t * (t - 1) * number(right * 3) * length;
      weights.push_back(std::fabs(weight) > 1e-5 ? weight : 0);
    }
    return weights;
  }
  if (viewer == "godot" && is_spline) {
    const double last = times.back();
    std::vector<double> samples = {0};
    while (samples.back() < last) samples.push_back(std::min(samples.back() + 1 / 30.0, last));
    for (std::size_t i = 0; i + 1 < samples.size(); ++i)
      if (time < samples[i + 1])
        return mixed(specified(samples[i]), specified(samples[i + 1]),
                     (time - samples[i]) / (samples[i + 1] - samples[i]));
    return specified(last);
  }
  if (viewer == "gltfpack") {
    const int frames = 1 + static_cast<int>((end - start) * 30 + 0.8);
    std::vector<std::vector<double>> kept;
    for (int frame = 0; frame < frames; ++frame) {
      kept.push_back(specified(start + frame / 30.0));
      for (double& weight : kept.back())
        weight = weight < 0 ? 0 : weight > 1 ? 1 : std::floor(weight * 255 + 0.5) / 255;
    }
    for (int frame = 0; frame + 1 < frames; ++frame) {
      const double from = start + frame / 30.0, to = start + (frame + 1) / 30.0;
      if (time >= to) continue;
      const double t = interpolation == GltfInterpolation::kStep || time < from ? 0 : (time - from) * 30;
      return mixed(kept[static_cast<std::size_t>(frame)], kept[static_cast<std::size_t>(frame) + 1], t);
    }
    return kept.back();
  }
  return specified(time);
}

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_VIEWER_ORACLE_H_
