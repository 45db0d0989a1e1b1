#include "simd/trigonometry.h"

#include <gtest/gtest.h>

#include <cmath>

namespace chronormal::trigonometry_test {
namespace {

TEST(Trigonometry, sine_and_cosine_are_within_the_stated_error) {
  double worst = 0;
  for (int i = -800000; i <= 800000; ++i) {
    const float x = static_cast<float>(i) * 1e-5f;
    const auto [sine, cosine] = sin_cos(x);
    worst = std::fmax(worst, std::fabs(static_cast<double>(sine) - std::sin(static_cast<double>(x))));
    worst = std::fmax(worst, std::fabs(static_cast<double>(cosine) - std::cos(static_cast<double>(x))));
  }
  EXPECT_LT(worst, 1.2e-7);
  EXPECT_EQ(sin_cos(0).sin, 0);
  EXPECT_EQ(sin_cos(0).cos, 1);
}

TEST(Trigonometry, upper_angle_is_within_the_stated_error) {
  double worst = 0;
  for (int i = 0; i <= 1000000; ++i) {
    const double angle = 3.14159265358979 * i / 1000000;
    const float y = static_cast<float>(0.7 * std::sin(angle)), x = static_cast<float>(0.7 * std::cos(angle));
    worst = std::fmax(worst, std::fabs(static_cast<double>(upper_angle(y, x)) -
                                       std::atan2(static_cast<double>(y), static_cast<double>(x))));
  }
  EXPECT_LT(worst, 3e-7);
}

TEST(Trigonometry, upper_angle_of_the_zero_vector_is_zero) { EXPECT_EQ(upper_angle(0, 0), 0); }

TEST(Trigonometry, small_angles_keep_their_relative_precision) {
  for (const float x : {1e-3f, 1e-6f, 1e-12f, 1e-20f}) {
    EXPECT_NEAR(sin_cos(x).sin / x, 1, 1e-6);
    EXPECT_NEAR(upper_angle(x, 1) / x, 1, 1e-6);
  }
}

}  // namespace
}  // namespace chronormal::trigonometry_test
