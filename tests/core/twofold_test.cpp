#include "core/twofold.h"

#include <gmpxx.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "tests/support/fixtures.h"

namespace chronormal::twofold_test {
namespace {

mpq_class exact(const Twofold& x) { return mpq_class(x.high) + mpq_class(x.low); }

TEST(Twofold, sums_and_products_of_doubles_are_exact_and_those_of_pairs_nearly) {
  constexpr std::uint64_t kSeed = 4953;
  fixtures::Random random(kSeed);
  const mpq_class share(0x1p-100);
  for (int i = 0; i < 20000; ++i) {
    const auto any = [&random] { return std::ldexp(random.uniform(-1, 1), static_cast<int>(random.below(160)) - 80); };
    const double a = any(), b = any(), c = any(), d = any();
    const Twofold sum = Twofold::sum(a, b), product = Twofold::product(c, d);
    ASSERT_EQ(exact(sum), mpq_class(a) + mpq_class(b)) << a << ' ' << b << " from seed " << kSeed;
    ASSERT_EQ(exact(product), mpq_class(c) * mpq_class(d)) << c << ' ' << d << " from seed " << kSeed;
    ASSERT_LE(abs(exact(sum + product) - exact(sum) - exact(product)), share * (abs(exact(sum)) + abs(exact(product))));
    ASSERT_LE(abs(exact(sum * product) - exact(sum) * exact(product)), share * abs(exact(sum) * exact(product)));
  }
}

// A twofold number is the sum of two doubles, a high and a low part. In this test, the high parts of two such numbers
// nearly cancel, as in differences of coordinates far from the origin.
TEST(Twofold, differences_are_rounded_once_whatever_cancels) {
  constexpr std::uint64_t kSeed = 4954;
  fixtures::Random random(kSeed);
  const mpq_class share(0x1.01p-53);
  for (int i = 0; i < 20000; ++i) {
    const double a = static_cast<double>(static_cast<float>(random.uniform(-2, 2)));
    const auto low = [&random] {
      return random.uniform(-1, 1) * std::ldexp(1, -25 - static_cast<int>(random.below(40)));
    };
    const double b = a + static_cast<double>(static_cast<int>(random.below(5)) - 2) * 0x1p-23, a_low = low();
    const double b_low = random.below(2) == 0 ? low() : a_low + (a - b) + low() * 0x1p-30;
    const mpq_class exact_difference = mpq_class(a) + mpq_class(a_low) - mpq_class(b) - mpq_class(b_low);
    const double found = difference(a, a_low, b, b_low);
    ASSERT_LE(abs(mpq_class(found) - exact_difference), share * abs(exact_difference))
        << a << ' ' << a_low << ' ' << b << ' ' << b_low << " from seed " << kSeed;
  }
}

TEST(Twofold, long_sums_of_products_that_cancel_keep_77_bits_of_their_terms) {
  constexpr std::uint64_t kSeed = 4955;
  fixtures::Random random(kSeed);
  for (int i = 0; i < 300; ++i) {
    LongSums sums(5);
    std::array<mpq_class, 5> exact_sums, sizes;
    for (int term = 0; term < 30; ++term) {
      const double factor =
          random.below(2) == 0 ? static_cast<double>(static_cast<float>(random.uniform(-2, 2))) : random.uniform(-2, 2);
      std::array<float, 5> values;
      for (std::size_t k = 0; k < 5; ++k) {
        values[k] = static_cast<float>(random.uniform(-1, 1) * std::ldexp(1, -static_cast<int>(random.below(30))));
        exact_sums[k] += mpq_class(factor) * mpq_class(static_cast<double>(values[k]));
        sizes[k] += abs(mpq_class(factor) * mpq_class(static_cast<double>(values[k])));
      }
      sums.add(factor, std::span<const float>(values));
    }
    sums.settle();
    for (std::size_t k = 0; k < 5; ++k)
      ASSERT_LE(abs(exact(sums[k]) - exact_sums[k]), mpq_class(0x1p-96) * sizes[k]) << "from seed " << kSeed;
  }
}

}  // namespace
}  // namespace chronormal::twofold_test
