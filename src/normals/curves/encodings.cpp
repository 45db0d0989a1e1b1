#include "chronormal/normals/normal_curves.h"

#include <cmath>

namespace chronormal {
namespace {

std::uint32_t snorm(float component, float largest, std::uint32_t mask) {
  return static_cast<std::uint32_t>(std::lrint(component * largest)) & mask;
}

// Returns the signed integer in the lowest `bit_count` bits, divided by the largest integer of that width. The most
// negative integer counts as the next larger one, so that the result is at least -1.
float from_snorm(std::uint32_t bits, int bit_count) {
  const int shift = 32 - bit_count;
  const std::int32_t value = static_cast<std::int32_t>(bits << shift) >> shift;
  const float largest = static_cast<float>((1 << (bit_count - 1)) - 1);
  return std::fmax(static_cast<float>(value) / largest, -1.0f);
}

Vec3f normalized_or_zero(const Vec3f& v) {
  const float square = dot(v, v);
  return square > 0 ? (1 / std::sqrt(square)) * v : Vec3f{};
}

}  // namespace

Octahedral encode_octahedral(const Vec3f& v) noexcept {
  const float sum = std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z);
  if (!(sum > 0)) return {};
  float x = v.x / sum, y = v.y / sum;
  if (v.z < 0) {
    const float folded = std::copysign(1 - std::fabs(y), x);
    y = std::copysign(1 - std::fabs(x), y);
    x = folded;
  }
  return {snorm(x, 32767, 0xFFFF) | snorm(y, 32767, 0xFFFF) << 16};
}

Rgb10A2 encode_rgb10a2(const Vec3f& v) noexcept {
  return {snorm(v.x, 511, 0x3FF) | snorm(v.y, 511, 0x3FF) << 10 | snorm(v.z, 511, 0x3FF) << 20};
}

Vec3f decode(Octahedral encoded) noexcept {
  const float x = from_snorm(encoded.bits, 16), y = from_snorm(encoded.bits >> 16, 16);
  const float z = 1 - std::fabs(x) - std::fabs(y);
  if (z >= 0) return normalized_or_zero({x, y, z});
  return normalized_or_zero({std::copysign(1 - std::fabs(y), x), std::copysign(1 - std::fabs(x), y), z});
}

Vec3f decode(Rgb10A2 encoded) noexcept {
  return normalized_or_zero(
      {from_snorm(encoded.bits, 10), from_snorm(encoded.bits >> 10, 10), from_snorm(encoded.bits >> 20, 10)});
}

}  // namespace chronormal
