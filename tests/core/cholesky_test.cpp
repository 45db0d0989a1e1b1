// Tests the solution of linear systems by Cholesky factors, also for matrices that rounding has made indefinite.

#include "core/cholesky.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace chronormal::cholesky_test {
namespace {

std::vector<Vec3d> solution(const std::vector<double>& matrix, double least, std::vector<Vec3d> right) {
  Cholesky(matrix, right.size(), least).solve(right);
  return right;
}

TEST(Cholesky, solves_a_system) {
  // Entries of the matrix that must not be read have the value 7.
  const auto x = solution({4, 7, 7, 2, 5, 7, 2, 1, 6}, 1e-300, {{8, 0, 4}, {8, 4, 2}, {9, 1, 2}});
  // The right-hand sides are A = (4 2 2; 2 5 1; 2 1 6) times (1, 1, 1), times (-0.6, 1, 0.2), and times (1, 0, 0),
  // computed by hand. The residuals below check the solutions.
  const double a[3][3] = {{4, 2, 2}, {2, 5, 1}, {2, 1, 6}};
  const Vec3d right[3] = {{8, 0, 4}, {8, 4, 2}, {9, 1, 2}};
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3d residual = a[i][0] * x[0] + a[i][1] * x[1] + a[i][2] * x[2] - right[i];
    EXPECT_LT(max_abs(residual), 1e-14) << i;
  }
  EXPECT_NEAR(x[0].x, 1, 1e-15);
  EXPECT_NEAR(x[0].z, 1, 1e-15);
}

TEST(Cholesky, a_pivot_below_the_least_is_the_least) {
  // The square of the second pivot is 1 - 1 = 0, or about -1e-16 because of rounding. In both cases, 1/4 replaces the
  // square, so the matrix becomes (1 1; 1 1.25), whose inverse is (5 -4; -4 4).
  for (const double corner : {1.0, 1 - 0x1p-53}) {
    const auto x = solution({1, 1, 1, corner}, 0.25, {{1, 0, 2}, {0, 1, 1}});
    EXPECT_EQ(x[0], (Vec3d{5, -4, 6})) << corner;
    EXPECT_EQ(x[1], (Vec3d{-4, 4, -4})) << corner;
  }
}

}  // namespace
}  // namespace chronormal::cholesky_test
