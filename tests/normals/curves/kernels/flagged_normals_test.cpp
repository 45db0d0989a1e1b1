// Compares flagged elements, which the kernel evaluates sixteen at a time, with eq. 5 of docs/theory.md in long double,
// for numbers of all magnitudes.

#include "normals/curves/kernels/flagged_normals.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <vector>

#include "simd/targets.h"
#include "tests/support/fixtures.h"

namespace chronormal::flagged_normals_test {
namespace {

using LongVector = std::array<long double, 3>;

LongVector combination(const ControlNormals& c, double t) {
  const long double a = t, w0 = (1 - a) * (1 - a), w1 = 2 * a * (1 - a), w2 = a * a;
  return {w0 * c.n0.x + w1 * c.m.x + w2 * c.n1.x, w0 * c.n0.y + w1 * c.m.y + w2 * c.n1.y,
          w0 * c.n0.z + w1 * c.m.z + w2 * c.n1.z};
}

// Returns |u x v| / |v|. Since u is a unit vector, this is the sine of the angle between u and v.
long double off(const LongVector& u, const LongVector& v) {
  const LongVector x{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
  return std::hypot(x[0], x[1], x[2]) / std::hypot(v[0], v[1], v[2]);
}

// The smallest size of n(t) at which the test compares directions: its largest component, as a share of the sum of w_k
// max_abs(c_k), where w_k are the weights of the control normals c_k.
constexpr double kCertain = 0x1p-26;

ControlNormals element(fixtures::Random& random, int exponent) {
  const auto vector = [&] {
    const auto [x, y, z] = random.in_cube(1.9);
    return Vec3d{std::ldexp(x, exponent), std::ldexp(y, exponent), std::ldexp(z, exponent)};
  };
  ControlNormals result{vector(), vector(), vector()};
  // In half of the cases, the curve passes close to zero at t = 1/2.
  if (random.below(2) == 0) result = {result.n0, -1.0 * result.n0, result.n0};
  result.m.x += std::ldexp(random.uniform(-1e-9, 1e-3), exponent);
  return result;
}

TEST(FlaggedNormals, have_the_direction_of_the_quadratic_at_any_size) {
  for (const int exponent : {0, -20, 100, 500, 1000, 1022, 1023, -500, -1000, -1021, -1030}) {
    std::vector<std::vector<FlaggedUnits>> results;
    for (const auto target : supported_targets()) {
      const ScopedTarget scope(target);
      fixtures::Random random(20261125);
      std::vector<FlaggedTile> tiles(6);
      std::vector<ControlNormals> elements;
      for (std::size_t i = 0; i < 90; ++i) {  // six lanes of the last tile are unused
        elements.push_back(element(random, exponent));
        const FlaggedNormals scaled = FlaggedNormals::scaled(elements.back(), kCertain);
        const double back = std::ldexp(1.0, scaled.exponent);
        ASSERT_EQ(back * scaled.normals.n0, elements.back().n0) << exponent;
        ASSERT_EQ(back * scaled.normals.m, elements.back().m) << exponent;
        tiles[i / kTile].set(i % kTile, scaled);
      }
      results.emplace_back(tiles.size());
      for (const double t : {0.5, 0.0, 0.31, 1.0}) {
        flagged_unit_normals(tiles, t, results.back());
        for (std::size_t i = 0; i < elements.size(); ++i) {
          const FlaggedUnits& units = results.back()[i / kTile];
          const std::size_t lane = i % kTile;
          const LongVector expected = combination(elements[i], t);
          const Vec3d n = normal_at(elements[i], t);
          const auto& [n0, m, n1] = elements[i];
          const double size = (1 - t) * (1 - t) * max_abs(n0) + 2 * t * (1 - t) * max_abs(m) + t * t * max_abs(n1);
          const double largest = std::max({max_abs(n0), max_abs(m), max_abs(n1)});
          const bool is_uncertain = (units.uncertain >> lane & 1) != 0;
          const bool is_too_small = largest < 0x1p-1022 || max_abs(n) <= kCertain * size;
          const bool is_far_above = max_abs(n) > 1.00001 * kCertain * size && max_abs(n) > 0x1p-49 * largest;
          ASSERT_TRUE(is_uncertain ? !is_far_above || is_too_small : !is_too_small)
              << exponent << " " << i << " at " << t;
          if (is_uncertain) continue;
          const LongVector found{units[lane].x, units[lane].y, units[lane].z};
          // If the terms of n(t) cancel, n(t) has an error even in double. This error is largest for subnormal numbers.
          const long double in_double = (exponent < -1000 ? 0x1p-36L : 0x1p-52L) * size / max_abs(n);
          ASSERT_LE(off(found, expected), 1.3e-7L + 10 * in_double) << exponent << " " << i << " at " << t;
          ASSERT_NEAR(static_cast<double>(std::hypot(found[0], found[1], found[2])), 1, 4e-7);
        }
      }
      ASSERT_EQ(std::memcmp(results.back().data(), results[0].data(), sizeof(FlaggedUnits) * tiles.size()), 0)
          << target_name(target);
    }
  }
}

}  // namespace
}  // namespace chronormal::flagged_normals_test
