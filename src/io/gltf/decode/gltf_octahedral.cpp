#include "io/gltf/decode/gltf_octahedral.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "io/bytes/binary.h"

namespace chronormal::inline internal::gltf {
namespace {

template <class T>
void decode_element(char* element) noexcept {
  constexpr std::endian kOrder = std::endian::little;
  const auto load = [&](std::size_t i) { return static_cast<float>(binary::load<T>(element + i * sizeof(T), kOrder)); };
  // Each operation is rounded to float on its own, and the operations have the order of the decoder in browsers, so
  // that all bits of the result agree with those in browsers.
  float x = load(0), y = load(1);
  const float z = load(2) - (std::fabs(x) + std::fabs(y));

  // The corners of the square stand for normals with negative z. These lines fold the corners back.
  const float fold = std::min(z, 0.0F);
  x += x < 0 ? -fold : fold;
  y += y < 0 ? -fold : fold;

  const float length = std::sqrt(x * x + (y * y + z * z));
  const float scale = length > 0 ? static_cast<float>(std::numeric_limits<T>::max()) / length : 0.0F;
  // Like the decoder in browsers, std::nearbyint() rounds halves to even numbers.
  const auto store = [&](std::size_t i, float component) {
    binary::store(element + i * sizeof(T), static_cast<T>(std::nearbyint(component * scale)), kOrder);
  };
  store(0, x);
  store(1, y);
  store(2, z);
}

}  // namespace

void decode_octahedral(std::string& bytes, std::size_t stride) noexcept {
  for (std::size_t at = 0; at < bytes.size(); at += stride) {
    if (stride == 4)
      decode_element<std::int8_t>(&bytes[at]);
    else
      decode_element<std::int16_t>(&bytes[at]);
  }
}

}  // namespace chronormal::inline internal::gltf
