#include "core/portable_math.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <numbers>
#include <random>

namespace chronormal::portable_math_test {
namespace {

constexpr unsigned kSeed = 20;
constexpr int kCases = 200000;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Returns the error of `value` against the more precise value `right`, in units in the last place of a double.
double units_off(double value, long double right) {
  const auto nearest = static_cast<double>(right);
  const long double unit = std::nextafter(std::fabs(nearest), kInfinity) - std::fabs(nearest);
  return static_cast<double>(std::fabs(static_cast<long double>(value) - right) / unit);
}

double worst_of(double (*ours)(double), long double (*right)(long double), double low, double high) {
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> among(low, high);
  double worst = 0;
  for (int i = 0; i < kCases; ++i) {
    const double x = among(random);
    worst = std::fmax(worst, units_off(ours(x), right(x)));
  }
  return worst;
}

TEST(PortableMath, functions_of_one_number_are_within_five_units_of_those_with_more_digits) {
  EXPECT_LT(worst_of(portable::sin, std::sin, -10, 10), 5);
  EXPECT_LT(worst_of(portable::cos, std::cos, -10, 10), 5);
  EXPECT_LT(worst_of(portable::asin, std::asin, -1, 1), 5);
  EXPECT_LT(worst_of(portable::atan, std::atan, -30, 30), 5);
  EXPECT_LT(worst_of(portable::exp, std::exp, -700, 709), 5);
  EXPECT_LT(worst_of(portable::exp, std::exp, -1, 1), 5);
  EXPECT_LT(worst_of(portable::exp2, std::exp2, -1000, 1000), 5);
  EXPECT_LT(worst_of(portable::log, std::log, 1e-3, 1e3), 5);
  EXPECT_LT(worst_of(portable::log, std::log, 1e-300, 1e300), 5);
}

TEST(PortableMath, angles_and_lengths_of_vectors_are_within_five_units_in_all_quadrants_and_at_all_scales) {
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> among(-1, 1), exponent(-900, 900), difference(-60, 60);
  double worst_angle = 0, worst_length = 0;
  for (int i = 0; i < kCases; ++i) {
    const int scale = static_cast<int>(exponent(random));
    const double y = std::ldexp(among(random), scale),
                 x = std::ldexp(among(random), scale + static_cast<int>(difference(random)));
    worst_angle = std::fmax(worst_angle, units_off(portable::atan2(y, x), std::atan2(static_cast<long double>(y),
                                                                                     static_cast<long double>(x))));
    worst_length = std::fmax(worst_length, units_off(portable::hypot(x, y), std::hypot(static_cast<long double>(x),
                                                                                       static_cast<long double>(y))));
  }
  EXPECT_LT(worst_angle, 5);
  EXPECT_LT(worst_length, 5);
  EXPECT_DOUBLE_EQ(portable::hypot(3e200, 4e200), 5e200);
  EXPECT_EQ(portable::hypot(2, 3, 6), 7);
}

TEST(PortableMath, special_arguments_give_what_the_standard_library_gives) {
  const double values[] = {0.0, -0.0, 1.0, -1.0, kInfinity, -kInfinity};
  for (const double y : values)
    for (const double x : values) {
      EXPECT_EQ(portable::atan2(y, x), std::atan2(y, x)) << y << ' ' << x;
      EXPECT_EQ(std::signbit(portable::atan2(y, x)), std::signbit(std::atan2(y, x))) << y << ' ' << x;
    }
  for (const double x : {0.0, -kInfinity, kInfinity, 1000.0, -1000.0}) EXPECT_EQ(portable::exp(x), std::exp(x)) << x;
  for (const double x : {0.0, 1.0, kInfinity}) EXPECT_EQ(portable::log(x), std::log(x)) << x;
  EXPECT_TRUE(std::isnan(portable::log(-1)));
  EXPECT_EQ(portable::sin(0), 0);
  EXPECT_EQ(portable::cos(0), 1);
  EXPECT_EQ(portable::asin(1), std::numbers::pi / 2);
  EXPECT_EQ(portable::asin(1.5), std::numbers::pi / 2);
  EXPECT_EQ(portable::atan(-kInfinity), -std::numbers::pi / 2);
}

// Compares a hash of the results with a constant, since the results must be the same on every machine and with every
// compiler. cmake/bits.cmake also builds this test for other machines.
TEST(PortableMath, the_bits_are_these) {
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> among(-20, 20);
  std::uint64_t hash = 14695981039346656037U;
  const auto take = [&](double value) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    for (int byte = 0; byte < 8; ++byte, bits >>= 8U) hash = (hash ^ (bits & 0xFFU)) * 1099511628211U;
  };
  for (int i = 0; i < 20000; ++i) {
    const double x = among(random), y = among(random);
    for (const double value :
         {portable::sin(x), portable::cos(x), portable::atan(x), portable::atan2(y, x), portable::exp(x),
          portable::log(std::fabs(x)), portable::asin(x / 20), portable::hypot(x, y)})
      take(value);
  }
  EXPECT_EQ(hash, 13009684376921375972U);
}

}  // namespace
}  // namespace chronormal::portable_math_test
