#include "core/float32.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace chronormal::float32_test {
namespace {

TEST(Float32, a_vector_is_what_float32_keeps_of_each_component) {
  const Vec3d third = {1.0 / 3, -2.0 / 3, 1e10 / 3};
  const Vec3d kept = rounded_to_float(third);
  EXPECT_EQ(kept.x, 11184811.0 / 33554432);   // 0x1.555556p-2
  EXPECT_EQ(kept.y, -11184811.0 / 16777216);  // -0x1.555556p-1
  EXPECT_EQ(kept.z, 3333333248.0);
}

TEST(Float32, is_off_by_half_a_unit_of_24_bits_at_most_and_not_by_nothing) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> among(1, 2);
  for (int i = 0; i < 1000; ++i) {
    const Vec3d vector = {among(random), among(random), among(random)}, kept = rounded_to_float(vector);
    for (const double off : {kept.x - vector.x, kept.y - vector.y, kept.z - vector.z}) {
      EXPECT_LE(std::fabs(off), 0x1p-24);
      EXPECT_NE(off, 0);
    }
  }
}

}  // namespace
}  // namespace chronormal::float32_test
