/// Sets components of a computed vector to zero if they are nothing but rounding error.
///
/// Terms that cancel leave rounding errors behind. Such an error has a length but a meaningless direction, so three
/// collinear corners would get a random normal. The error of a sum is at most a multiple of the unit roundoff u times
/// the sum of the absolute values that were added (Higham, Accuracy and Stability of Numerical Algorithms, sections 2
/// to 4). So this sum of absolute values is computed along with the value, and a value that is not above its error
/// counts as zero.
#ifndef CHRONORMAL_CORE_ROUNDING_H_
#define CHRONORMAL_CORE_ROUNDING_H_

#include <cmath>
#include <cstddef>

#include "chronormal/core/vec3.h"

namespace chronormal::inline internal {

/// The unit roundoffs u of double and of float. An operation has a relative error of at most u.
inline constexpr double kUnitRoundoff = 0x1p-53;
inline constexpr double kFloatUnitRoundoff = 0x1p-24;

[[nodiscard]] inline Vec3d absolute(const Vec3d& v) noexcept {
  return {std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)};
}
[[nodiscard]] inline double sum_abs(const Vec3d& v) noexcept {
  return std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z);
}

/// Returns v, or zero if no component has an absolute value above `error`.
[[nodiscard]] inline Vec3d without_rounding(const Vec3d& v, double error) noexcept {
  return max_abs(v) > error ? v : Vec3d{};
}

/// Returns v, with zero in place of each component whose absolute value is at most the same component of `error`.
[[nodiscard]] inline Vec3d without_rounding(const Vec3d& v, const Vec3d& error) noexcept {
  const auto keep = [](double value, double e) { return std::fabs(value) <= e ? 0.0 : value; };
  return {keep(v.x, error.x), keep(v.y, error.y), keep(v.z, error.z)};
}

/// A sum of vectors and a bound of its error. Each term adds 4 u times the sum of all absolute values to the bound: u
/// for the addition, and the rest for the rounding of the term itself.
class VectorSum {
 public:
  void add(const Vec3d& term) noexcept {
    value_ = value_ + term;
    magnitude_ = magnitude_ + absolute(term);
    ++terms_;
  }

  [[nodiscard]] Vec3d without_rounding() const noexcept {
    return chronormal::without_rounding(value_, 4 * kUnitRoundoff * static_cast<double>(terms_) * magnitude_);
  }

  /// Returns the largest component of the sum of the terms' absolute values.
  [[nodiscard]] double size() const noexcept { return max_abs(magnitude_); }
  /// Returns a bound of the error of any component of without_rounding(), compared with the exact sum of the terms.
  [[nodiscard]] double error() const noexcept {
    return 8 * kUnitRoundoff * static_cast<double>(terms_) * max_abs(magnitude_);
  }

 private:
  Vec3d value_, magnitude_;
  std::size_t terms_ = 0;
};

/// A sum of cross products of rounded edges. The error of a cross product is below 4 u times the sum of the absolute
/// values of the products in it. Twice this bound is assumed for safety.
class CrossSum {
 public:
  void add(const Vec3d& a, const Vec3d& b) noexcept {
    value_ = value_ + cross(a, b);
    const Vec3d p = absolute(a), q = absolute(b);
    magnitude_ = magnitude_ + Vec3d{p.y * q.z + p.z * q.y, p.z * q.x + p.x * q.z, p.x * q.y + p.y * q.x};
    ++terms_;
  }

  /// Returns the sum of the absolute values of the products, for each component.
  [[nodiscard]] const Vec3d& magnitude() const noexcept { return magnitude_; }

  [[nodiscard]] Vec3d without_rounding() const noexcept {
    return chronormal::without_rounding(value_, 8 * kUnitRoundoff * static_cast<double>(terms_) * magnitude_);
  }

  /// Returns a bound of the error of any component of without_rounding(), compared with the exact sum: 4 u for
  /// rounding, and 8 u for a component that was set to zero.
  [[nodiscard]] double error() const noexcept {
    return 12 * kUnitRoundoff * static_cast<double>(terms_) * max_abs(magnitude_);
  }

 private:
  Vec3d value_, magnitude_;
  std::size_t terms_ = 0;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_CORE_ROUNDING_H_
