/// Small polynomials over [0, 1], in Bernstein form and in power form.
///
/// Bernstein<T, N> has the coefficients b[0] ... b[N] of
///     p(t) = sum_k  C(N, k) (1-t)^(N-k) t^k  b[k]
/// where T is a scalar or a Vec3. The end coefficients are the end values, every value is a convex combination of the
/// coefficients (so they bound the polynomial), and evaluation loses no digits at either end. Power<T, N> has p(t) =
/// sum_k a[k] t^k, which takes fewer operations but is less accurate near t = 1.
///
/// Source: Farouki, The Bernstein polynomial basis: a centennial retrospective (2012).
#ifndef CHRONORMAL_CORE_POLYNOMIAL_H_
#define CHRONORMAL_CORE_POLYNOMIAL_H_

#include <array>
#include <cassert>
#include <cstddef>
#include <functional>

namespace chronormal {

template <class T, std::size_t N>
using Bernstein = std::array<T, N + 1>;

template <class T, std::size_t N>
struct Power {
  std::array<T, N + 1> a;
};

/// Returns the binomial coefficient C(n, k) for small n.
[[nodiscard]] constexpr double binomial(std::size_t n, std::size_t k) noexcept {
  double result = 1;
  for (std::size_t i = 0; i < k; ++i) result = result * static_cast<double>(n - i) / static_cast<double>(i + 1);
  return result;
}

/// The two parts of a polynomial p that is cut at t. They are p over [0, t] and p over [t, 1], each written as a
/// polynomial over [0, 1]. split() computes them by de Casteljau's algorithm, with N (N+1) / 2 linear interpolations.
template <class T, std::size_t N>
struct Halves {
  Bernstein<T, N> before, after;
};
template <class T, std::size_t M>
[[nodiscard]] constexpr Halves<T, M - 1> split(const std::array<T, M>& p, double t) {
  Halves<T, M - 1> halves;
  std::array<T, M> row = p;
  for (std::size_t level = 0; level < M; ++level) {
    halves.before[level] = row[0];
    halves.after[M - 1 - level] = row[M - 1 - level];
    for (std::size_t k = 0; k + level + 1 < M; ++k) row[k] = (1 - t) * row[k] + t * row[k + 1];
  }
  return halves;
}

/// Returns p(t), by de Casteljau's algorithm. Exact at t = 0 and t = 1.
template <class T, std::size_t M>
[[nodiscard]] constexpr T evaluate(const std::array<T, M>& p, double t) {
  return split(p, t).before[M - 1];
}

/// Returns p over the interval [t0, t1], as a polynomial over [0, 1].
/// Precondition: 0 <= t0 < t1 <= 1.
template <class T, std::size_t M>
[[nodiscard]] constexpr std::array<T, M> restrict_to(const std::array<T, M>& p, double t0, double t1) {
  assert(0 <= t0 && t0 < t1 && t1 <= 1);
  return split(split(p, t1).before, t0 / t1).after;
}

/// Returns the product of two polynomials, whose degree is the sum of their degrees. `product` multiplies two
/// coefficients; if it is a dot product, two vector polynomials give a scalar polynomial.
template <class P, std::size_t M, class Q, std::size_t N, class Product = std::multiplies<>>
[[nodiscard]] constexpr auto multiply(const std::array<P, M>& p, const std::array<Q, N>& q, Product product = {}) {
  std::array<decltype(product(p[0], q[0])), M + N - 1> result{};
  for (std::size_t i = 0; i < M; ++i) {
    for (std::size_t j = 0; j < N; ++j) {
      const double share = binomial(M - 1, i) * binomial(N - 1, j) / binomial(M + N - 2, i + j);
      result[i + j] = result[i + j] + share * product(p[i], q[j]);
    }
  }
  return result;
}

/// Converts a polynomial to power form. The terms of the power form cancel near t = 1, so evaluate the Bernstein form
/// where accuracy matters.
template <class T, std::size_t M>
[[nodiscard]] constexpr Power<T, M - 1> to_power(const std::array<T, M>& p) {
  Power<T, M - 1> power;
  std::array<T, M> differences = p;
  for (std::size_t k = 0; k < M; ++k) {
    power.a[k] = binomial(M - 1, k) * differences[0];
    for (std::size_t i = 0; i + k + 1 < M; ++i) differences[i] = differences[i + 1] - differences[i];
  }
  return power;
}

/// Converts a polynomial from power form to Bernstein form.
template <class T, std::size_t N>
[[nodiscard]] constexpr Bernstein<T, N> to_bernstein(const Power<T, N>& p) {
  Bernstein<T, N> b;
  for (std::size_t k = 0; k <= N; ++k) {
    b[k] = p.a[0];
    for (std::size_t i = 1; i <= k; ++i) b[k] = b[k] + (binomial(k, i) / binomial(N, i)) * p.a[i];
  }
  return b;
}

/// Returns p(t) by Horner's scheme, which takes N multiplications and N additions.
template <class T, std::size_t N>
[[nodiscard]] constexpr T evaluate(const Power<T, N>& p, double t) {
  T value = p.a[N];
  for (std::size_t k = N; k > 0; --k) value = t * value + p.a[k - 1];
  return value;
}

/// The roots in [0, 1] of a polynomial of degree up to N.
template <std::size_t N>
struct Roots {
  std::array<double, N> t{};  ///< the roots in ascending order; a root of even multiplicity may be listed once or twice
  std::size_t count = 0;
  bool everywhere = false;  ///< true if p is zero for all t; count is then 0
};

namespace detail {

/// Finds the root of p in [0, 1], where p must have exactly one root and opposite signs at 0 and 1. Uses false position
/// with the Illinois rule (Dowell, Jarratt 1971), and bisection where false position makes too little progress.
template <std::size_t M>
[[nodiscard]] double only_root(const std::array<double, M>& p) {
  double a = 0, b = 1, fa = p[0], fb = p[M - 1];
  for (int i = 0; i < 100 && b - a > 1e-16 * b; ++i) {
    const double width = b - a;
    double t = (a * fb - b * fa) / (fb - fa);
    if (i % 4 == 3 || !(a < t && t < b)) t = a + width / 2;
    const double ft = evaluate(p, t);
    if (ft == 0) return t;
    if ((ft < 0) == (fb < 0)) {
      b = t;
      fb = ft;
      fa /= 2;
    } else {
      a = t;
      fa = ft;
      fb /= 2;
    }
  }
  return a + (b - a) / 2;
}

/// Finds the roots of p in [t0, t1] by the number of sign changes among its coefficients (Descartes). Halves the
/// interval until each part has at most one root, or is only as wide as a rounding error.
template <std::size_t M>
void find_roots(const std::array<double, M>& p, double t0, double t1, Roots<M - 1>& roots) {
  std::size_t variations = 0;
  double last = 0;
  for (const double b : p) {
    if (b != 0 && last != 0 && (b < 0) != (last < 0)) ++variations;
    if (b != 0) last = b;
  }
  // Sign changes do not show a zero at an end of the interval. Two neighbouring intervals share such a root, so it is
  // added only once.
  const auto add = [&roots](double t) {
    if (roots.count < M - 1 && (roots.count == 0 || roots.t[roots.count - 1] + 1e-14 < t)) roots.t[roots.count++] = t;
  };
  if (p[0] == 0) add(t0);
  if (variations == 1 && p[0] != 0 && p[M - 1] != 0) {
    add(t0 + (t1 - t0) * only_root(p));
  } else if (variations > 0) {
    const double middle = t0 + (t1 - t0) / 2;
    if (t1 - t0 < 1e-15 || middle <= t0 || middle >= t1) {
      add(middle);
    } else {
      const Halves<double, M - 1> halves = split(p, 0.5);
      find_roots(halves.before, t0, middle, roots);
      find_roots(halves.after, middle, t1, roots);
    }
  }
  if (p[M - 1] == 0 && last != 0) add(t1);
}

}  // namespace detail

/// Finds the roots of p in [0, 1], including the ends. The error of a simple root is at most 1e-15 times its condition
/// number. The error of a root of multiplicity k is about the k-th root of this bound. A double root that rounding has
/// moved off the axis may be missed, or found as two roots. Decisions that depend on double roots need exact
/// arithmetic.
template <std::size_t M>
[[nodiscard]] Roots<M - 1> roots_in_unit_interval(const std::array<double, M>& p) {
  Roots<M - 1> roots;
  roots.everywhere = true;
  for (const double b : p) roots.everywhere &= b == 0;
  if (!roots.everywhere) detail::find_roots(p, 0, 1, roots);
  return roots;
}

}  // namespace chronormal

#endif  // CHRONORMAL_CORE_POLYNOMIAL_H_
