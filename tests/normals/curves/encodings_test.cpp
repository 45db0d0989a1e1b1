// Tests unit normals that are encoded in four bytes: the meaning of the bits, the errors in radians, and whether the
// kernels agree with the functions for single normals.

#include "chronormal/normals/normal_curves.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <vector>

#include "simd/targets.h"
#include "tests/support/fixtures.h"
#include "tests/support/hard_normals.h"

namespace chronormal::encodings_test {
namespace {

constexpr double kOctahedral = 7e-5, kRgb10A2 = 1.7e-3;  // in radians, the guaranteed largest errors (encodings.h)

double angle(const Vec3f& a, const Vec3f& b) { return angle_between(to_double(a), to_double(b)); }

Vec3f random_unit(fixtures::Random& random) {
  for (;;) {
    const Vec3d v = test::random_vector(random);
    if (dot(v, v) > 0.01 && dot(v, v) < 1) return to_float(unit(v));
  }
}

// Returns directions on and near the axes, the coordinate planes and the diagonals, where the octahedron has its folds.
std::vector<Vec3f> special_directions() {
  std::vector<Vec3f> all;
  for (const double x : {-1.0, -0.0, 0.0, 1.0}) {
    for (const double y : {-1.0, -0.0, 0.0, 1.0}) {
      for (const double z : {-1.0, -0.0, 0.0, 1.0}) {
        for (const double by : {0.0, 1e-12, 1e-7, 1e-5, 1e-4, 1e-3, 1e-2}) {
          for (int turn = 0; turn < 8; ++turn) {
            const double sx = (turn & 1) != 0 ? by : -by, sy = (turn & 2) != 0 ? by : -by,
                         sz = (turn & 4) != 0 ? by : -by;
            const Vec3d v{x + sx, y + sy, z + sz};
            if (max_abs(v) > 0.5) all.push_back(to_float(unit(v)));
          }
        }
      }
    }
  }
  return all;
}

TEST(Octahedral, has_its_components_where_the_header_says) {
  EXPECT_EQ(encode_octahedral({0, 0, 1}).bits, 0u);
  EXPECT_EQ(encode_octahedral({1, 0, 0}).bits, 0x7FFFu);
  EXPECT_EQ(encode_octahedral({-1, 0, 0}).bits, 0x8001u);
  EXPECT_EQ(encode_octahedral({0, 1, 0}).bits, 0x7FFF0000u);
  EXPECT_EQ(encode_octahedral({0, -1, 0}).bits, 0x80010000u);
  EXPECT_EQ(encode_octahedral({0, 0, -1}).bits, 0x7FFF7FFFu);
  EXPECT_EQ(encode_octahedral({0.6f, 0, 0.8f}).bits, 14043u);  // (0.6 / 1.4) * 32767
  // The direction is on the lower half of the octahedron, with x = -(1 - 0) and y = 1 - 0.6 / 1.4.
  EXPECT_EQ(encode_octahedral({-0.6f, 0, -0.8f}).bits, (32767u - 14043u) << 16 | 0x8001u);
  EXPECT_EQ(encode_octahedral({}).bits, 0u);
  EXPECT_EQ(decode(Octahedral{0}), (Vec3f{0, 0, 1}));
}

TEST(Rgb10A2, has_its_components_where_the_header_says) {
  EXPECT_EQ(encode_rgb10a2({1, 0, 0}).bits, 511u);
  EXPECT_EQ(encode_rgb10a2({0, 1, 0}).bits, 511u << 10);
  EXPECT_EQ(encode_rgb10a2({0, 0, 1}).bits, 511u << 20);
  EXPECT_EQ(encode_rgb10a2({-1, 0, 0}).bits, 1024u - 511);
  EXPECT_EQ(encode_rgb10a2({0, -1, 0}).bits, (1024u - 511) << 10);
  EXPECT_EQ(encode_rgb10a2({0, 0, -1}).bits, (1024u - 511) << 20);
  EXPECT_EQ(encode_rgb10a2({0.6f, -0.8f, 0}).bits, 307u | (1024u - 409) << 10);
  EXPECT_EQ(encode_rgb10a2({}).bits, 0u);
  EXPECT_EQ(decode(Rgb10A2{0}), Vec3f{});
  EXPECT_EQ(decode(Rgb10A2{512}), (Vec3f{-1, 0, 0}));  // -512 means the same as -511
}

template <class Encode>
double largest_error(Encode encode) {
  double largest = 0;
  const auto judge = [&](const Vec3f& v) {
    const Vec3f back = decode(encode(v));
    EXPECT_NEAR(dot(back, back), 1, 4e-7f);
    largest = std::max(largest, angle(back, v));
  };
  fixtures::Random random(81);
  for (int i = 0; i < 300000; ++i) judge(random_unit(random));
  for (const Vec3f& v : special_directions()) judge(v);
  return largest;
}

TEST(Octahedral, comes_back_within_the_stated_angle) {
  const double largest = largest_error(encode_octahedral);
  std::cout << "  largest error " << largest << " rad\n";
  EXPECT_LE(largest, kOctahedral);
  EXPECT_GT(largest, kOctahedral / 2);
}

TEST(Rgb10A2, comes_back_within_the_stated_angle) {
  const double largest = largest_error(encode_rgb10a2);
  std::cout << "  largest error " << largest << " rad\n";
  EXPECT_LE(largest, kRgb10A2);
  EXPECT_GT(largest, kRgb10A2 / 2);
}

TEST(Rgb10A2, has_no_bits_in_alpha) {
  fixtures::Random random(82);
  for (int i = 0; i < 10000; ++i) EXPECT_EQ(encode_rgb10a2(random_unit(random)).bits >> 30, 0u);
}

// Compares encoded normals with the nearest integers to the exact values, which are computed in long double.
TEST(Octahedral, is_the_nearest_point_of_the_grid) {
  fixtures::Random random(83);
  for (int i = 0; i < 100000; ++i) {
    const Vec3f v = random_unit(random);
    const test::Real sum = std::fabs(test::Real{v.x}) + std::fabs(test::Real{v.y}) + std::fabs(test::Real{v.z});
    test::Real x = v.x / sum, y = v.y / sum;
    if (v.z < 0) {
      const test::Real folded = std::copysign(1 - std::fabs(y), x);
      y = std::copysign(1 - std::fabs(x), y);
      x = folded;
    }
    const std::uint32_t bits = encode_octahedral(v).bits;
    // The error of each integer is at most 1/2, plus the error of an earlier rounding to float32.
    EXPECT_LE(std::fabs(static_cast<std::int16_t>(bits & 0xFFFF) - x * 32767), 0.51L) << i;
    EXPECT_LE(std::fabs(static_cast<std::int16_t>(bits >> 16) - y * 32767), 0.51L) << i;
  }
}

TEST(Octahedral, decoded_and_encoded_again_is_the_same_direction) {
  fixtures::Random random(84);
  for (int i = 0; i < 100000; ++i) {
    const auto bits = static_cast<std::uint32_t>(random.below(std::size_t{1} << 32));
    const Vec3f v = decode(Octahedral{bits});
    EXPECT_NEAR(dot(v, v), 1, 4e-7f);
    EXPECT_LE(angle(decode(encode_octahedral(v)), v), 5e-7) << std::hex << bits;
  }
}

// ---- encoded normals as results of curves ---------------------------------------------------------------------------

TEST(EncodedResults, are_within_both_tolerances) {
  fixtures::Random random(85);
  std::vector<ControlNormals> normals;
  for (int i = 0; i < 4000; ++i) normals.push_back(test::hard_element(random, true));
  std::vector<Octahedral> octahedral(normals.size());
  std::vector<Rgb10A2> rgb(normals.size());
  for (const std::int64_t target : supported_targets()) {
    const ScopedTarget scoped(target);
    for (const double tolerance : {1e-6, 1e-3, 5e-3}) {
      const NormalCurves curves(normals, {tolerance});
      for (const double t : {0.0, 0.4, 1.0}) {
        EXPECT_EQ(curves.unit_normals(t, octahedral), 0u);
        EXPECT_EQ(curves.unit_normals(t, rgb), 0u);
        for (std::size_t i = 0; i < normals.size(); ++i) {
          const UnitNormal u = unit_normal_at(normals[i], t);
          if (u.direction != Direction::kRegular) continue;
          ASSERT_LE(angle_between(to_double(decode(octahedral[i])), u.vector), tolerance + kOctahedral) << i;
          ASSERT_LE(angle_between(to_double(decode(rgb[i])), u.vector), tolerance + kRgb10A2) << i;
        }
      }
    }
  }
}

// The kernels compute the integers of an encoded normal differently from the functions for single normals, so the
// integers of a kernel may differ by 1.
TEST(EncodedResults, are_those_of_the_functions) {
  fixtures::Random random(86);
  std::vector<ControlNormals> normals;
  for (const Vec3f& v : special_directions()) {
    const Vec3d n = to_double(v);
    normals.push_back({n, n, n});
    normals.push_back({n, n, 2.0 * n});
    normals.push_back({n, 1.5 * n, n});
  }
  for (int i = 0; i < 4000; ++i) normals.push_back(test::hard_element(random, true));
  std::vector<float> xyz(3 * normals.size());
  std::vector<Octahedral> octahedral(normals.size());
  std::vector<Rgb10A2> rgb(normals.size());
  const auto view = VectorView<float>::packed(xyz.data(), normals.size());
  for (const double tolerance : {1e-6, 1e-3, 5e-3}) {
    const NormalCurves curves(normals, {tolerance});
    (void)curves.unit_normals(0.3, view);
    (void)curves.unit_normals(0.3, octahedral);
    (void)curves.unit_normals(0.3, rgb);
    for (std::size_t i = 0; i < normals.size(); ++i) {
      ASSERT_EQ(rgb[i], encode_rgb10a2(view[i])) << i;
      const std::uint32_t a = octahedral[i].bits, b = encode_octahedral(view[i]).bits;
      const auto low = [](std::uint32_t bits) { return static_cast<std::int16_t>(bits & 0xFFFF); };
      const auto high = [](std::uint32_t bits) { return static_cast<std::int16_t>(bits >> 16); };
      const bool close = std::abs(low(a) - low(b)) <= 1 && std::abs(high(a) - high(b)) <= 1;
      // At a fold of the octahedron, two different codes may stand for nearly the same direction.
      ASSERT_TRUE(close || angle(decode(octahedral[i]), view[i]) <= kOctahedral) << i;
    }
  }
}

TEST(EncodedResults, of_nothing_are_zero_and_counted) {
  const std::vector<ControlNormals> nothing(37);
  const NormalCurves curves(nothing, {kCompactTolerance});
  std::vector<Octahedral> octahedral(37, Octahedral{1});
  std::vector<Rgb10A2> rgb(37, Rgb10A2{1});
  EXPECT_EQ(curves.unit_normals(0.3, octahedral), 37u);
  EXPECT_EQ(curves.unit_normals(0.3, rgb), 37u);
  for (std::size_t i = 0; i < 37; ++i) {
    EXPECT_EQ(octahedral[i], Octahedral{});
    EXPECT_EQ(rgb[i], Rgb10A2{});
  }
}

}  // namespace
}  // namespace chronormal::encodings_test
