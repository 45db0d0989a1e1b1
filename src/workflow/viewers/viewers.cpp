// Rounds normals and deltas as viewers do when they store them.
#include "chronormal/workflow/viewers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

#include "core/bits.h"
#include "core/nearest.h"

namespace chronormal {
namespace {

// Returns the nearest 16-bit float. Rounds ties away from zero. A 16-bit float has a sign, 5 bits of exponent and 10
// bits of fraction; a float32 has 23 bits of fraction.
float half(float value) noexcept {
  constexpr std::uint32_t kInfinity = 0x7f800000, kLeastNormal = 0x38800000, kHalfOfLast = 1U << 12;
  constexpr float kLargest = 65504, kStep = 0x1p-24F;  // kStep: the step between numbers below 2^-14
  const float size = std::fabs(value);
  const auto bits = bit_cast<std::uint32_t>(size);
  if (bits >= kInfinity) return value;
  if (bits < kLeastNormal) return std::copysign(std::round(size / kStep) * kStep, value);
  const auto rounded = bit_cast<float>((bits + kHalfOfLast) & ~(2 * kHalfOfLast - 1));
  return std::copysign(rounded > kLargest ? INFINITY : rounded, value);
}

Vec3f half(const Vec3f& v) noexcept { return {half(v.x), half(v.y), half(v.z)}; }

// Limits a number to [-1, 1], rounds the result to a signed integer of `bits` bits, and returns the number that this
// integer stands for. Rounds ties away from zero. Integers of 9 to 15 bits are stored in 16 bits. The upper bits are
// repeated in the unused lower bits, so that 1 stays 1.
float clamped(float value, int bits) noexcept {
  const int wide = bits <= 8 ? 8 : 16;
  const int lack = wide - bits;
  const float size = std::fabs(value) < 1 ? std::fabs(value) : std::isnan(value) ? 0 : 1.0F;
  const float scaled = size * static_cast<float>((1 << (bits - 1)) - 1);
  const int whole = static_cast<int>(scaled);
  // The difference below is exact in float32.
  const int small = scaled - static_cast<float>(whole) >= 0.5F ? whole + 1 : whole;
  const int kept = lack == 0 ? small : (small << lack) | (small >> (bits - 1 - lack));
  return std::copysign(static_cast<float>(kept) / static_cast<float>((1 << (wide - 1)) - 1), value);
}

Vec3f clamped(const Vec3f& v, int bits) noexcept {
  return {clamped(v.x, bits), clamped(v.y, bits), clamped(v.z, bits)};
}

struct Octahedral {
  double x = 0, y = 0;  // coordinates on the unfolded octahedron, in [-1, 1]
};

Octahedral to_octahedral(const Vec3d& v) noexcept {
  const double size = std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z);
  const double x = v.x / size, y = v.y / size;
  if (v.z >= 0) return {x, y};
  return {std::copysign(1 - std::fabs(y), x), std::copysign(1 - std::fabs(x), y)};
}

Vec3d from_octahedral(const Octahedral& o) noexcept {
  const double z = 1 - std::fabs(o.x) - std::fabs(o.y), fold = std::fmax(-z, 0);
  return unit(Vec3d{o.x - std::copysign(fold, o.x), o.y - std::copysign(fold, o.y), z});
}

// Returns the direction that a viewer reads back after it has stored `v` in octahedral form. The form has two unsigned
// integers of `bits` bits that represent [-1, 1], rounded down.
Vec3d through_unsigned_octahedral(const Vec3d& v, int bits) noexcept {
  if (v == Vec3d{} || !is_finite(v)) return v;
  const double most = std::ldexp(1, bits) - 1;
  const auto kept = [&](double value) { return 2 * std::floor((value / 2 + 0.5) * most) / most - 1; };
  const Octahedral o = to_octahedral(v);
  return from_octahedral({kept(o.x), kept(o.y)});
}

// Returns the direction that a viewer reads back after it has stored `v` in octahedral form. The form has two signed
// integers of `bits` bits, rounded to the nearest integer.
Vec3d through_signed_octahedral(const Vec3d& v, int bits) noexcept {
  if (v == Vec3d{} || !is_finite(v)) return v;
  const double most = std::ldexp(1, bits - 1) - 1;
  const Octahedral o = to_octahedral(v);
  return from_octahedral({std::round(o.x * most) / most, std::round(o.y * most) / most});
}

// Returns the first axis of Frisvad's frame of a unit vector, here for a frame whose y axis points up. Viewers that
// store frames (Viewer::by_frame) apply the formula also to vectors of other lengths, so this function does the same.
Vec3d first_axis(const Vec3d& n) noexcept {
  constexpr double kDown = -1 + 1.0 / (1 << 23);
  if (n.y < kDown) return {-1, 0, 0};
  const double a = 1 / (1 + n.y);
  return {-n.z * n.x * a, -n.z, 1 - n.z * n.z * a};
}

// Returns the third axis of a vector's frame after the viewer has stored the frame as a quaternion of signed integers.
// The viewer converts any frame as if it were orthonormal, so this function does the same.
Vec3d through_frame(const Vec3d& v, int bits) noexcept {
  if (v == Vec3d{} || !is_finite(v)) return v;
  const Vec3d x = first_axis(v), y = cross(v, x);
  const double m[3][3] = {{x.x, x.y, x.z}, {y.x, y.y, y.z}, {v.x, v.y, v.z}};
  std::array<double, 4> q{};  // the quaternion, in the order x, y, z, w
  const double trace = m[0][0] + m[1][1] + m[2][2];
  if (trace > 0) {
    const double root = std::sqrt(trace + 1), s = 0.5 / root;
    q = {(m[1][2] - m[2][1]) * s, (m[2][0] - m[0][2]) * s, (m[0][1] - m[1][0]) * s, root / 2};
  } else {
    const std::size_t larger = m[1][1] > m[0][0] ? 1 : 0;
    const std::size_t i = m[2][2] > m[larger][larger] ? 2 : larger, j = (i + 1) % 3, k = (j + 1) % 3;
    const double root = std::sqrt(m[i][i] - m[j][j] - m[k][k] + 1), s = 0.5 / root;  // root is 1 or more
    q[i] = root / 2;
    q[j] = (m[i][j] + m[j][i]) * s;
    q[k] = (m[i][k] + m[k][i]) * s;
    q[3] = (m[j][k] - m[k][j]) * s;
  }
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  const double most = std::ldexp(1, bits - 1) - 1;
  for (double& part : q) part = std::round(part / length * most) / most;
  return unit(
      Vec3d{2 * (q[0] * q[2] + q[3] * q[1]), 2 * (q[1] * q[2] - q[3] * q[0]), 1 - 2 * (q[0] * q[0] + q[1] * q[1])});
}

// Returns the unit normal that a viewer stores for a vector of any length. A viewer with 32 bits only rounds the vector
// to float32. A viewer that stores frames also turns vectors whose length is not 1.
Vec3f kept_direction(const Viewer& viewer, const Vec3f& v) noexcept {
  constexpr int kAllBits = 32;
  const Vec3d vector = to_double(v);
  if (viewer.by_frame) return to_float(through_frame(vector, std::min(viewer.bits, kAllBits - 1)));
  return to_float(viewer.bits >= kAllBits ? unit(vector) : through_unsigned_octahedral(unit(vector), viewer.bits));
}

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return lower;
}

// Returns a name in a list without the blanks around it.
std::string_view trimmed(std::string_view name) {
  const std::size_t first = std::min(name.find_first_not_of(' '), name.size());
  return name.substr(first, name.find_last_not_of(' ') + 1 - first);
}

Error no_such_viewer(std::string_view name) {
  std::string list;
  std::vector<std::string> names;
  for (const Viewer& viewer : kViewers) {
    list.append(viewer.name).append(", ");
    names.emplace_back(viewer.name);
  }
  std::string message = std::string("there is no viewer '").append(name) + "'";
  const std::string nearest = nearest_name(lower_case(name), names);
  message.append(nearest.empty() ? "; choose from " : "; did you mean " + nearest + "? Choose from ");
  return Error{ErrorCode::kUsage, "", message.append(list).append("and all")};
}

}  // namespace

Result<std::vector<Viewer>> find_viewers(std::string_view names) {
  std::vector<Viewer> viewers;
  const auto add = [&viewers](const Viewer& viewer) {
    if (std::find(viewers.begin(), viewers.end(), viewer) == viewers.end()) viewers.push_back(viewer);
  };
  for (std::size_t first = 0; first <= names.size();) {
    const std::size_t end = std::min(names.find(',', first), names.size());
    const std::string_view name = trimmed(names.substr(first, end - first));
    const std::string lower = lower_case(name);
    first = end + 1;
    if (lower == "all") {
      for (const Viewer& viewer : kViewers)
        if (viewer.normals != NormalRule::kClamped) add(viewer);
      continue;
    }
    const auto* const found = std::find_if(kViewers.begin(), kViewers.end(), [&](const Viewer& viewer) {
      return viewer.name == lower || lower_case(viewer.title) == lower;
    });
    if (found == kViewers.end()) return no_such_viewer(name);
    add(*found);
  }
  return viewers;
}

Vec3f kept_normal(const Viewer& viewer, const Vec3f& normal) noexcept {
  switch (viewer.normals) {
    case NormalRule::kSum:
      return normal;
    case NormalRule::kUnit:
      return kept_direction(viewer, normal);
    case NormalRule::kClamped:
      return clamped(
          viewer.octahedral_base ? to_float(through_signed_octahedral(to_double(normal), viewer.bits)) : normal,
          viewer.bits);
  }
  return normal;
}

Vec3f kept_delta(const Viewer& viewer, const Vec3f& normal, const Vec3f& delta) noexcept {
  return kept_delta(viewer, normal, kept_normal(viewer, normal), delta);
}

Vec3f kept_delta(const Viewer& viewer, const Vec3f& normal, const Vec3f& kept_normal, const Vec3f& delta) noexcept {
  switch (viewer.normals) {
    case NormalRule::kSum:
      return viewer.keeps_halves() ? half(delta) : delta;
    case NormalRule::kUnit:
      return kept_direction(viewer, normal + delta) - kept_normal;
    case NormalRule::kClamped:
      return clamped(delta, viewer.bits);
  }
  return delta;
}

void drop_weights(const Viewer& viewer, std::span<double> weights, std::span<const std::size_t> targets) noexcept {
  for (std::size_t k = 0; k < weights.size(); ++k) {
    const bool is_beyond = viewer.most_targets > 0 && (targets.empty() ? k : targets[k]) >= viewer.most_targets;
    if (is_beyond || std::fabs(weights[k]) <= viewer.least_weight) weights[k] = 0;
  }
}

Vec3f vector_of_sum(const Viewer& viewer, const Vec3f& kept_normal, const Vec3f& sum) noexcept {
  return viewer.keeps_halves() ? kept_normal + half(sum) : sum;
}

Vec3f shown_of_sum(const Viewer& viewer, const Vec3f& kept_normal, const Vec3f& sum) noexcept {
  return to_float(unit(to_double(vector_of_sum(viewer, kept_normal, sum))));
}

}  // namespace chronormal
