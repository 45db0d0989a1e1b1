/// Decides without rounding whether a normal with integer components is inside a cone that is stored in four floats.
///
/// A normal n is inside the cone with the stored axis a and sine s if n.a >= 0 and (n.a)^2 >= (1 - s^2) |n|^2 |a|^2.
/// Clear cases are decided in double with a margin of 1e-12, and all other cases in integers of any size.
#ifndef CHRONORMAL_TESTS_SUPPORT_CONE_ORACLE_H_
#define CHRONORMAL_TESTS_SUPPORT_CONE_ORACLE_H_

#include <gmpxx.h>

#include <array>
#include <cmath>
#include <cstddef>

#include "chronormal/analysis/cones.h"
#include "tests/support/fixtures.h"
#include "tests/support/integer_normal.h"

namespace chronormal::test {

[[nodiscard]] inline mpz_class exact_dot(const IntegerVector& a, const IntegerVector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Tells whether the normal n is inside the cone. The zero vector is inside every cone.
[[nodiscard]] inline bool contains(const NormalCone& cone, const IntegerVector& n) {
  if (is_zero(n)) return true;
  const bool has_axis = cone.axis.x != 0 || cone.axis.y != 0 || cone.axis.z != 0;
  if (!has_axis) return cone.sine >= 1;
  const std::array<double, 3> d = direction_of(n);
  const double ax = double{cone.axis.x}, ay = double{cone.axis.y}, az = double{cone.axis.z};
  const double x = ay * d[2] - az * d[1], y = az * d[0] - ax * d[2], z = ax * d[1] - ay * d[0];
  const double along = ax * d[0] + ay * d[1] + az * d[2], across = std::sqrt(x * x + y * y + z * z);
  const double sine = across / std::hypot(along, across);
  if (along > 0 && sine < double{cone.sine} - 1e-12) return true;
  const IntegerVector axis{integer_of(cone.axis.x), integer_of(cone.axis.y), integer_of(cone.axis.z)};
  const mpz_class dot = exact_dot(n, axis), s = integer_of(cone.sine), one = mpz_class(1) << 149;
  if (dot < 0) return false;
  return mpz_class(dot * dot * one * one) >= mpz_class((one * one - s * s) * exact_dot(n, n) * exact_dot(axis, axis));
}

/// Returns 64 instants in [t0, t1]: both ends, 15 equidistant instants between them, 23 random instants, and 24
/// instants at random distances from an end, most of which are small.
[[nodiscard]] inline std::array<double, 64> some_times_in(double t0, double t1, fixtures::Random& random) {
  std::array<double, 64> times{};
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double share = i < 17 ? static_cast<double>(i) / 16 : random.uniform(0, 1);
    const double step = std::ldexp(random.uniform(0.5, 1), -static_cast<int>(random.below(54)));
    const double t = i < 40 ? t0 + share * (t1 - t0) : i < 50 ? t0 + step * (t1 - t0) : t1 - step * (t1 - t0);
    times[i] = std::fmin(std::fmax(t < 0x1p-200 ? 0 : t, t0), t1);
  }
  return times;
}

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_CONE_ORACLE_H_
