/// Bounds functions over a piece of time, from their Taylor series (taylor.h). The Taylor polynomial is in the hull of
/// its Bernstein coefficients, and the function differs from the polynomial by at most the remainder.
#ifndef CHRONORMAL_NORMALS_WEIGHTING_SERIES_BOUNDS_H_
#define CHRONORMAL_NORMALS_WEIGHTING_SERIES_BOUNDS_H_

#include <algorithm>
#include <array>
#include <cstddef>

#include "chronormal/core/polynomial.h"
#include "chronormal/core/vec3.h"
#include "normals/weighting/interval.h"
#include "normals/weighting/taylor.h"

namespace chronormal::inline internal {

/// The number of terms of a series, and the degree of its polynomial. The polynomial has 5 coefficients, and the sixth
/// term is the remainder.
inline constexpr std::size_t kTerms = 6, kDegree = kTerms - 2;

/// Returns an upper bound of the length of all vectors whose components are in the intervals x, y and z.
[[nodiscard]] inline double largest_length(const Interval& x, const Interval& y, const Interval& z) noexcept {
  return (1 + 0x1p-50) * length(Vec3d{x.magnitude(), y.magnitude(), z.magnitude()});
}

/// Returns the Bernstein coefficients, over [c - half, c + half], of the Taylor polynomial about c.
[[nodiscard]] inline std::array<Interval, kDegree + 1> bernstein(const Series<kTerms>& taylor, double half) noexcept {
  // Row k has C(4, j) times the Bernstein coefficients j of u^k over [-1, 1], for k = 0 ... 4.
  constexpr std::array<std::array<double, kDegree + 1>, kDegree + 1> kOfPowers = {
      {{1, 1, 1, 1, 1}, {-4, -2, 0, 2, 4}, {6, 0, -2, 0, 6}, {-4, 2, 0, -2, 4}, {1, -1, 1, -1, 1}}};
  std::array<Interval, kDegree + 1> result;
  Interval power = Interval::point(1);
  for (std::size_t k = 0; k <= kDegree; ++k) {
    const Interval coefficient = (1 / binomial(kDegree, k)) * (taylor[k] * power);
    for (std::size_t j = 0; j <= kDegree; ++j) result[j] = result[j] + kOfPowers[k][j] * coefficient;
    power = half * power;
  }
  return result;
}

/// Returns an interval that contains the remainder of a series at every point of [c - half, c + half]. `around` is the
/// series about all points of this interval.
[[nodiscard]] inline Interval remainder(const Series<kTerms>& around, double half) noexcept {
  Interval power = Interval::point(1);
  for (std::size_t k = 1; k < kTerms; ++k) power = half * power;
  return around[kTerms - 1] * power;
}

/// Returns a lower bound of a function over [c - half, c + half]. `here` is its series about c, and `around` its series
/// about all points of the interval. The true function may differ from the series by `slack`.
[[nodiscard]] inline double least_over(const Series<kTerms>& here, const Series<kTerms>& around, double half,
                                       double slack) noexcept {
  const auto coefficients = bernstein(here, half);
  double least = coefficients[0].low;
  for (const Interval& coefficient : coefficients) least = std::min(least, coefficient.low);
  return least - (1 + 0x1p-50) * (remainder(around, half).magnitude() + slack);
}

/// Returns an upper bound of the length of a vector over [c - half, c + half]. `here` is its series about c, and
/// `around` its series about all points of the interval. The true vector may differ from the series by a vector of
/// length `slack`.
[[nodiscard]] inline double largest_length_over(const VectorSeries<kTerms>& here, const VectorSeries<kTerms>& around,
                                                double half, double slack) noexcept {
  const auto x = bernstein(here[0], half), y = bernstein(here[1], half), z = bernstein(here[2], half);
  double largest = 0;
  for (std::size_t j = 0; j <= kDegree; ++j) largest = std::max(largest, largest_length(x[j], y[j], z[j]));
  return largest + largest_length(remainder(around[0], half), remainder(around[1], half), remainder(around[2], half)) +
         slack;
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_WEIGHTING_SERIES_BOUNDS_H_
