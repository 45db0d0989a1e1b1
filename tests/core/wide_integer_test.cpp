// Compares wide integers with the integers of GMP, a library for large numbers.

#include "core/wide_integer.h"

#include <gmpxx.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "tests/support/fixtures.h"
#include "tests/support/integer_normal.h"

namespace chronormal::wide_integer_test {
namespace {

template <std::size_t kMost>
mpz_class value_of(const WideInteger<kMost>& integer) {
  mpz_class value = 0;
  for (std::size_t k = integer.size(); k > 0; --k) value = (value << 24) + static_cast<long>(integer.digit(k - 1));
  return value;
}

// Draws a float of any exponent, including subnormal ones and zeros.
float any_float(fixtures::Random& random) {
  switch (random.below(8)) {
    case 0:
      return random.below(2) == 0 ? 0.0F : -0.0F;
    case 1:
      return std::numeric_limits<float>::max() * (random.below(2) == 0 ? 1.0F : -1.0F);
    case 2:
      return std::numeric_limits<float>::denorm_min() * static_cast<float>(random.below(1000));
    default:
      return std::ldexp(static_cast<float>(random.uniform(-1, 1)), static_cast<int>(random.below(270)) - 145);
  }
}

TEST(WideInteger, holds_sums_of_products_of_floats) {
  fixtures::Random random(31);
  for (int i = 0; i < 3000; ++i) {
    WideInteger<26> sum;
    mpz_class expected = 0;
    for (std::size_t terms = random.below(20); terms > 0; --terms) {
      const float a = any_float(random), b = any_float(random);
      const bool is_minus = random.below(2) == 0;
      sum.add_product(FloatParts::of(a), FloatParts::of(b), is_minus ? -1 : 1);
      expected += (is_minus ? -1 : 1) * test::integer_of(a) * test::integer_of(b);
    }
    sum.settle();
    ASSERT_EQ(value_of(sum), expected) << i;
    ASSERT_EQ(sum.size() == 0, expected == 0) << i;
    for (std::size_t k = 0; k < sum.size(); ++k) ASSERT_LE(std::abs(sum.digit(k)), kDigitBase / 2);
    if (expected == 0) {
      ASSERT_EQ(sum.to_double(-298), 0.0);
      continue;
    }
    ASSERT_LE(abs(mpq_class(sum.to_double(0)) - expected) * mpz_class(1) / abs(expected), mpq_class(0x1p-51)) << i;
  }
}

TEST(WideInteger, is_multiplied_by_every_double_from_0_to_1) {
  fixtures::Random random(32);
  for (int i = 0; i < 3000; ++i) {
    const double simple[] = {0, 1, 0.5, 0.75, 0x1p-200, 1 - 0x1p-53, 0x1.fffffffffffffp-200};
    const double t = random.below(3) == 0 ? simple[random.below(7)]
                                          : std::ldexp(random.uniform(0.5, 1), -static_cast<int>(random.below(190)));
    WideInteger<26> factor;
    for (int k = 0; k < 3; ++k)
      factor.add_product(FloatParts::of(any_float(random)), FloatParts::of(any_float(random)));
    factor.settle();
    const UnitFraction fraction = UnitFraction::of(t);
    WideInteger<50> product;
    product.add_product(factor, fraction);
    product.add_shifted(factor, fraction.scale);
    product.settle();
    // The product is (t + 1) * factor, as an integer in units of 2^-scale.
    const mpq_class expected = (mpq_class(t) + 1) * value_of(factor) * (mpz_class(1) << fraction.scale);
    ASSERT_EQ(mpq_class(value_of(product)), expected) << t;
  }
}

TEST(WideInteger, cancels_to_zero_and_no_further) {
  WideInteger<26> sum;
  const auto of = [](float v) { return FloatParts::of(v); };
  sum.add_product(of(3e38F), of(3e38F));
  sum.add_product(of(1e-45F), of(1e-45F));
  sum.add_product(of(-3e38F), of(3e38F));
  sum.settle();
  EXPECT_EQ(value_of(sum), 1);
  sum.add_product(of(1e-45F), of(1e-45F), -1);
  sum.settle();
  EXPECT_EQ(sum.size(), 0u);
}

}  // namespace
}  // namespace chronormal::wide_integer_test
