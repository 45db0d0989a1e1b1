/// Intervals of numbers. The result of every operation contains the exact result, despite rounding.
///
/// Each bound of a result is moved outwards by more than its rounding error: by 2^-51 of itself, which is at least two
/// units in the last place, and by the smallest double, for results that underflow. (One unit would be enough if both
/// operands were exact, but a factor such as 1/3 has a rounding of its own.) The result is the whole line for a
/// division by an interval that contains zero, and for a root of an interval that contains negative numbers.
#ifndef CHRONORMAL_NORMALS_WEIGHTING_INTERVAL_H_
#define CHRONORMAL_NORMALS_WEIGHTING_INTERVAL_H_

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/portable_math.h"

namespace chronormal::inline internal {

struct Interval {
  double low = 0, high = 0;

  /// Returns [low, high] with both bounds moved outwards, or the whole line if a bound is NaN.
  [[nodiscard]] static Interval outwards(double low, double high) noexcept {
    constexpr double kStep = 0x1p-51, kSmallest = std::numeric_limits<double>::denorm_min();
    if (!(low <= high)) return whole();
    return {low - (kStep * std::fabs(low) + kSmallest), high + (kStep * std::fabs(high) + kSmallest)};
  }
  [[nodiscard]] static Interval whole() noexcept {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    return {-kInfinity, kInfinity};
  }
  [[nodiscard]] static Interval point(double x) noexcept { return {x, x}; }

  [[nodiscard]] bool finite() const noexcept { return std::isfinite(low) && std::isfinite(high); }
  /// Returns the largest absolute value in the interval.
  [[nodiscard]] double magnitude() const noexcept { return std::max(-low, high); }

  friend Interval operator+(const Interval& a, const Interval& b) noexcept {
    return outwards(a.low + b.low, a.high + b.high);
  }
  friend Interval operator-(const Interval& a, const Interval& b) noexcept {
    return outwards(a.low - b.high, a.high - b.low);
  }
  friend Interval operator*(const Interval& a, const Interval& b) noexcept {
    const double p = a.low * b.low, q = a.low * b.high, r = a.high * b.low, s = a.high * b.high;
    if (!std::isfinite(p + q + r + s)) return whole();
    return outwards(std::min(std::min(p, q), std::min(r, s)), std::max(std::max(p, q), std::max(r, s)));
  }
  friend Interval operator*(double a, const Interval& b) noexcept {
    const double p = a * b.low, q = a * b.high;
    return outwards(std::min(p, q), std::max(p, q));
  }
};

/// Returns an interval that contains 1 / x for all x in a.
[[nodiscard]] inline Interval reciprocal(const Interval& a) noexcept {
  if (!(a.low > 0 || a.high < 0)) return Interval::whole();
  return Interval::outwards(1 / a.high, 1 / a.low);
}

[[nodiscard]] inline Interval square_root(const Interval& a) noexcept {
  if (!(a.low >= 0)) return Interval::whole();
  return Interval::outwards(std::sqrt(a.low), std::sqrt(a.high));
}

/// Returns an interval that contains x^2 for all x in a. The interval has no negative numbers.
[[nodiscard]] inline Interval square(const Interval& a) noexcept {
  const Interval product = a * a;
  return {std::max(product.low, 0.0), product.high};
}

/// Returns an interval that contains the angles, in radians, of all vectors whose components are in the intervals x and
/// y, and whose y is not negative. The interval lies around the angle of the point in the middle, with the largest
/// possible difference on both sides. The arc tangent of core/portable_math.h is assumed to be within 16 eps of the
/// true value.
[[nodiscard]] inline Interval angle_of(const Interval& y, const Interval& x) noexcept {
  if (!y.finite() || !x.finite()) return Interval::whole();
  const double my = std::fmax(0.5 * (y.low + y.high), 0.0), mx = 0.5 * (x.low + x.high);
  const double radius = (y.high - y.low) + (x.high - x.low);
  // The distance between the origin and any point of the intervals is at least `distance`.
  const double distance = 0.999 * portable::hypot(mx, my) - radius;
  if (!(distance > 0)) return Interval::whole();
  constexpr double kLibrary = 16 * std::numeric_limits<double>::epsilon();
  const double angle = portable::atan2(my, mx), error = 1.001 * radius / distance + kLibrary;
  return Interval::outwards(angle - error, angle + error);
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_WEIGHTING_INTERVAL_H_
