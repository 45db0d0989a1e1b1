/// Taylor coefficients in interval arithmetic.
///
/// A Series<M> has the coefficients of 1, s, ..., s^(M-1) of a function about a point c. A series may also be about all
/// points of an interval T. Each of its coefficients is then an interval that contains the coefficients about every c
/// in T. If c and c + s are both in T,
///     f(c + s) = sum_(k < M-1) f_k(c) s^k + f_(M-1)(x) s^(M-1)     for some x in T,
/// where f_(M-1)(x) is in the last coefficient of the series about T. A polynomial about its centre is shifted to the
/// interval; other functions follow by the recurrences of power series. (Moore, Interval Analysis, 1966.)
#ifndef CHRONORMAL_NORMALS_WEIGHTING_TAYLOR_H_
#define CHRONORMAL_NORMALS_WEIGHTING_TAYLOR_H_

#include <array>
#include <cstddef>

#include "chronormal/core/polynomial.h"
#include "normals/weighting/interval.h"

namespace chronormal::inline internal {

template <std::size_t M>
using Series = std::array<Interval, M>;
template <std::size_t M>
using VectorSeries = std::array<Series<M>, 3>;

/// Returns the first K coefficients of the product of two series. Coefficients beyond the last one of a series count as
/// zero.
template <std::size_t K, std::size_t M, std::size_t N>
[[nodiscard]] Series<K> product(const Series<M>& a, const Series<N>& b) noexcept {
  Series<K> result{};
  for (std::size_t i = 0; i < M && i < K; ++i) {
    for (std::size_t j = 0; j < N && i + j < K; ++j) result[i + j] = result[i + j] + a[i] * b[j];
  }
  return result;
}

template <std::size_t M>
[[nodiscard]] Series<M> operator+(const Series<M>& a, const Series<M>& b) noexcept {
  Series<M> result;
  for (std::size_t k = 0; k < M; ++k) result[k] = a[k] + b[k];
  return result;
}

template <std::size_t M>
[[nodiscard]] Series<M> operator-(const Series<M>& a, const Series<M>& b) noexcept {
  Series<M> result;
  for (std::size_t k = 0; k < M; ++k) result[k] = a[k] - b[k];
  return result;
}

template <std::size_t K, std::size_t M, std::size_t N>
[[nodiscard]] Series<K> dot_product(const VectorSeries<M>& a, const VectorSeries<N>& b) noexcept {
  return product<K>(a[0], b[0]) + product<K>(a[1], b[1]) + product<K>(a[2], b[2]);
}

template <std::size_t K, std::size_t M, std::size_t N>
[[nodiscard]] VectorSeries<K> cross_product(const VectorSeries<M>& a, const VectorSeries<N>& b) noexcept {
  VectorSeries<K> result;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    result[i] = product<K>(a[j], b[k]) - product<K>(a[k], b[j]);
  }
  return result;
}

template <std::size_t K, std::size_t M, std::size_t N>
[[nodiscard]] VectorSeries<K> scaled_by(const Series<M>& factor, const VectorSeries<N>& a) noexcept {
  return {product<K>(factor, a[0]), product<K>(factor, a[1]), product<K>(factor, a[2])};
}

/// Returns a polynomial about c as a series about all points c + s, where s is in `around`.
template <std::size_t M>
[[nodiscard]] Series<M> shifted(const Series<M>& p, const Interval& around) noexcept {
  if (around.low == 0 && around.high == 0) return p;
  Series<M> result = p;
  for (std::size_t k = 0; k + 1 < M; ++k) {
    Interval value = binomial(M - 1, k) * p[M - 1];
    for (std::size_t j = M - 1; j > k; --j) value = value * around + binomial(j - 1, k) * p[j - 1];
    result[k] = value;
  }
  return result;
}

template <std::size_t M>
[[nodiscard]] VectorSeries<M> shifted(const VectorSeries<M>& p, const Interval& around) noexcept {
  return {shifted(p[0], around), shifted(p[1], around), shifted(p[2], around)};
}

/// Returns the series y of p^exponent. The function uses the recurrence that follows from p y' = exponent p' y. `first`
/// is the first coefficient of y.
template <std::size_t K, std::size_t M>
[[nodiscard]] Series<K> power(const Series<M>& p, double exponent, const Interval& first) noexcept {
  Series<K> y;
  y[0] = first;
  const Interval inverse = reciprocal(p[0]);
  for (std::size_t k = 1; k < K; ++k) {
    Interval sum;
    for (std::size_t j = 1; j <= k && j < M; ++j) {
      const double factor = exponent * static_cast<double>(j) - static_cast<double>(k - j);
      sum = sum + factor * (p[j] * y[k - j]);
    }
    y[k] = (1 / static_cast<double>(k)) * (sum * inverse);
  }
  return y;
}

template <std::size_t M>
[[nodiscard]] Series<M - 1> derivative(const Series<M>& p) noexcept {
  Series<M - 1> result;
  for (std::size_t k = 1; k < M; ++k) result[k - 1] = static_cast<double>(k) * p[k];
  return result;
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_WEIGHTING_TAYLOR_H_
