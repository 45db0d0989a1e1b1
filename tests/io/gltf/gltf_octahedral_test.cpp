// Tests how octahedral normals of EXT_meshopt_compression are decoded. Compares the results with the formula of the
// specification in double and, bit by bit, with the results of the npm package meshoptimizer in browsers.
#include "io/gltf/decode/gltf_octahedral.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "tests/support/gltf_builder.h"

namespace chronormal::gltf_octahedral_test {
namespace {

// Returns encoded normals for each number of bits from least_bits to most_bits: all (x, y) on a grid with at most
// most_steps steps along each side of the square. For few bits, the grid has all possible values. The fourth component,
// w, must not change. tests/viewers/filters.test.mjs has the same loop.
template <class T>
std::vector<T> lattice(int least_bits, int most_bits, int most_steps) {
  std::vector<T> elements;
  for (int bits = least_bits; bits <= most_bits; ++bits) {
    const int one = (1 << (bits - 1)) - 1, steps = std::min(2 * one, most_steps);
    const auto at = [&](int i) { return static_cast<T>(-one + i * 2 * one / steps); };
    for (int i = 0; i <= steps; ++i) {
      for (int j = 0; j <= steps; ++j)
        elements.insert(elements.end(), {at(i), at(j), static_cast<T>(one), static_cast<T>((i + j) % 128)});
    }
  }
  return elements;
}

template <class T>
std::vector<T> decoded(const std::vector<T>& elements) {
  std::string bytes = test::bytes_of(elements);
  gltf::decode_octahedral(bytes, 4 * sizeof(T));
  std::vector<T> result(elements.size());
  std::memcpy(result.data(), bytes.data(), bytes.size());
  return result;
}

// Returns the normal for the encoded (x, y) without rounding: a point on the octahedron |x| + |y| + |z| = one, which is
// scaled to the given length.
std::array<double, 3> normal_of(int x, int y, int one, double length) {
  const int z = one - std::abs(x) - std::abs(y);
  const auto fold = [&](int a, int b) { return z < 0 ? (a < 0 ? -1 : 1) * (one - std::abs(b)) : a; };
  const std::array<double, 3> place = {static_cast<double>(fold(x, y)), static_cast<double>(fold(y, x)),
                                       static_cast<double>(z)};
  const double scale = length / std::hypot(place[0], place[1], place[2]);
  return {place[0] * scale, place[1] * scale, place[2] * scale};
}

// Compares the components of decoded normals, which are integers, with normals that are not rounded. Returns the
// largest difference.
template <class T>
double worst_rounding(const std::vector<T>& elements) {
  const std::vector<T> result = decoded(elements);
  double worst = 0;
  for (std::size_t i = 0; i < elements.size(); i += 4) {
    const auto exact = normal_of(elements[i], elements[i + 1], elements[i + 2], std::numeric_limits<T>::max());
    for (std::size_t k = 0; k < 3; ++k) worst = std::max(worst, std::fabs(result[i + k] - exact[k]));
    EXPECT_EQ(result[i + 3], elements[i + 3]) << i;
  }
  return worst;
}

// Returns the FNV-1a hash of the bytes of all elements.
template <class T>
std::uint32_t hash(const std::vector<T>& elements) {
  std::uint32_t value = 0x811C9DC5U;
  for (const char byte : test::bytes_of(elements)) value = (value ^ static_cast<unsigned char>(byte)) * 0x01000193U;
  return value;
}

const std::vector<std::int8_t> kEveryOf8Bits = lattice<std::int8_t>(4, 8, 254);
const std::vector<std::int16_t> kManyOf16Bits = lattice<std::int16_t>(4, 16, 255);

TEST(GltfOctahedral, every_8_bit_normal_is_the_nearest) { EXPECT_LE(worst_rounding(kEveryOf8Bits), 0.5 + 1e-9); }

TEST(GltfOctahedral, normals_of_16_bits_are_the_nearest_but_for_float) {
  EXPECT_LE(worst_rounding(kManyOf16Bits), 0.5 + 0.004);
}

// The constants are hashes of what the npm package meshoptimizer 1.3.0 returns. tests/viewers/filters.test.mjs computes
// the same hashes.
TEST(GltfOctahedral, normals_are_bit_for_bit_those_of_browsers) {
  EXPECT_EQ(hash(decoded(kEveryOf8Bits)), 4083453700U);
  EXPECT_EQ(hash(decoded(kManyOf16Bits)), 995496109U);
}

TEST(GltfOctahedral, elements_that_no_encoder_writes_decode_to_something) {
  const std::vector<std::int8_t> nowhere = {0, 0, 0, 7};
  EXPECT_EQ(decoded(nowhere), nowhere);
  const auto length_of = [](const auto& element) { return std::hypot(element[0], element[1], element[2]); };
  for (const int least : {-128, 0, 127}) {
    const auto byte = static_cast<std::int8_t>(least);
    EXPECT_NEAR(length_of(decoded<std::int8_t>({byte, -128, byte, 0})), 127, 1) << least;
  }
  EXPECT_NEAR(length_of(decoded<std::int16_t>({-32768, -32768, -32768, 0})), 32767, 1);
}

}  // namespace
}  // namespace chronormal::gltf_octahedral_test
