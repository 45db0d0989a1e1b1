#include "core/twofold.h"

#include <gmpxx.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

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

}  // namespace
}  // namespace chronormal::twofold_test
