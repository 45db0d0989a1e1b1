/// Polynomials with integer coefficients of any size, for checking the roots and signs that the library finds.
///
/// Positions in float32 are integers times 2^-149. The values of a cubic at the integers t = -1, 0, 1 and 2 are
/// therefore integers in this unit, and they determine the cubic. Roots are counted by Descartes' rule and bisection,
/// after multiple roots were removed.
#ifndef CHRONORMAL_TESTS_SUPPORT_WHOLE_POLYNOMIAL_H_
#define CHRONORMAL_TESTS_SUPPORT_WHOLE_POLYNOMIAL_H_

#include <gmpxx.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "chronormal/core/vec3.h"
#include "chronormal/motion/motion.h"

namespace chronormal::test {

using Whole = mpz_class;
using WholeVector = std::array<Whole, 3>;

/// Returns a vector of floats, multiplied by 2^149, as integers.
[[nodiscard]] inline WholeVector whole(const Vec3f& v) {
  const auto one = [](float x) { return Whole(std::ldexp(static_cast<double>(x), 149)); };
  return {one(v.x), one(v.y), one(v.z)};
}

/// Returns p + t (q - p) for an integer t.
[[nodiscard]] inline WholeVector on_line(const WholeVector& p, const WholeVector& q, long t) {
  WholeVector result;
  for (std::size_t k = 0; k < 3; ++k) result[k] = p[k] + t * (q[k] - p[k]);
  return result;
}

[[nodiscard]] inline WholeVector minus(const WholeVector& p, const WholeVector& q) {
  return {Whole(p[0] - q[0]), Whole(p[1] - q[1]), Whole(p[2] - q[2])};
}

[[nodiscard]] inline WholeVector cross_of(const WholeVector& p, const WholeVector& q) {
  return {Whole(p[1] * q[2] - p[2] * q[1]), Whole(p[2] * q[0] - p[0] * q[2]), Whole(p[0] * q[1] - p[1] * q[0])};
}

[[nodiscard]] inline Whole dot_of(const WholeVector& p, const WholeVector& q) {
  return p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
}

/// Returns the normal of a polygon at an integer t, multiplied by 2^298: the sum of the cross products of its
/// triangles.
[[nodiscard]] inline WholeVector whole_normal(const Segment& segment, std::span<const std::uint32_t> vertices, long t) {
  const auto corner = [&](std::size_t c) {
    return on_line(whole(segment.from[vertices[c]]), whole(segment.to[vertices[c]]), t);
  };
  const WholeVector a = corner(0);
  WholeVector sum;
  for (std::size_t c = 2; c < vertices.size(); ++c) {
    const WholeVector n = cross_of(minus(corner(c - 1), a), minus(corner(c), a));
    for (std::size_t k = 0; k < 3; ++k) sum[k] += n[k];
  }
  return sum;
}

class WholePolynomial {
 public:
  /// Returns six times the polynomial of degree 3 or less that has these values at t = -1, 0, 1 and 2. The factor makes
  /// all coefficients integers.
  [[nodiscard]] static WholePolynomial through(const Whole& at_minus_1, const Whole& at_0, const Whole& at_1,
                                               const Whole& at_2) {
    const Whole c3 = at_2 - 3 * at_1 + 3 * at_0 - at_minus_1, c2 = 3 * (at_1 - 2 * at_0 + at_minus_1);
    return WholePolynomial({Whole(6 * at_0), Whole(6 * (at_1 - at_0) - c2 - c3), c2, c3});
  }

  [[nodiscard]] bool is_zero() const { return a_.empty(); }
  [[nodiscard]] bool is_constant() const { return a_.size() < 2; }

  [[nodiscard]] static WholePolynomial greatest_common_divisor(WholePolynomial p, WholePolynomial q);

  /// Returns the sign of the polynomial at a double t from 0 to 1.
  [[nodiscard]] int sign_at(double t) const {
    int exponent = 0;
    const Whole mantissa(std::ldexp(std::frexp(t, &exponent), 53));
    const auto shift = static_cast<mp_bitcnt_t>(exponent < 53 ? 53 - exponent : 0);  // t = mantissa 2^-shift
    Whole value = 0, power = 1;
    for (std::size_t k = a_.size(); k-- > 0;) {
      value = value * mantissa + a_[k] * power;
      power <<= shift;
    }
    return sgn(value);
  }

  /// Tells whether this polynomial is linear. If so, slope_at_root() returns the sign of the derivative of another
  /// polynomial p at the root of this polynomial.
  [[nodiscard]] bool is_linear() const { return a_.size() == 2; }
  [[nodiscard]] int slope_at_root(const WholePolynomial& p) const {
    const Whole root = -a_[0], unit = a_[1];  // t = root / unit
    Whole slope = 0, power = 1;
    for (std::size_t k = p.a_.size(); k-- > 1;) {
      slope = slope * root + static_cast<unsigned long>(k) * p.a_[k] * power;
      power *= unit;
    }
    const bool is_odd = p.a_.size() >= 2 && p.a_.size() % 2 == 1;  // true if slope has an odd power of `unit`
    return is_odd ? sgn(slope) * sgn(unit) : sgn(slope);
  }

  /// Returns the number of distinct roots in [0, 1].
  [[nodiscard]] std::size_t count_roots() const {
    const std::size_t at_ends = (sign_at(0) == 0 ? 1U : 0U) + (sign_at(1) == 0 ? 1U : 0U);
    const std::vector<Whole> b = bernstein();
    return at_ends + (variations(b) < 2 ? variations(b) : count_in(without_multiple_roots().bernstein()));
  }

  /// Returns the number of distinct roots in [low, high]. Requires 0 <= low < high <= 1.
  [[nodiscard]] std::size_t count_roots(double low, double high) const {
    // Substitutes t = low + s (high - low), where low and high are integers times 2^-shift.
    constexpr int kShift = 1080;
    const auto scaled = [](double t) {
      int exponent = 0;
      Whole value(std::ldexp(std::frexp(t, &exponent), 53));
      value <<= static_cast<mp_bitcnt_t>(kShift - 53 + exponent);
      return value;
    };
    const Whole from = scaled(low), step = scaled(high) - from;
    std::vector<Whole> moved;
    Whole power = 1;
    for (std::size_t k = a_.size(); k-- > 0;) {
      // Does a step of Horner's scheme: multiplies `moved` by from + s step, and adds the coefficient a_k. The factor
      // `power` brings a_k to the common denominator.
      std::vector<Whole> next(moved.size() + 1);
      for (std::size_t i = 0; i < moved.size(); ++i) {
        next[i] += moved[i] * from;
        next[i + 1] += moved[i] * step;
      }
      next[0] += a_[k] * power;
      moved = next;
      power <<= kShift;
    }
    return WholePolynomial(moved).count_roots();
  }

 private:
  explicit WholePolynomial(std::vector<Whole> a) : a_(std::move(a)) {
    while (!a_.empty() && a_.back() == 0) a_.pop_back();
  }

  [[nodiscard]] WholePolynomial derivative() const {
    std::vector<Whole> a;
    for (std::size_t k = 1; k < a_.size(); ++k) a.emplace_back(static_cast<unsigned long>(k) * a_[k]);
    return WholePolynomial(a);
  }

  [[nodiscard]] WholePolynomial without_content() const {
    Whole content = 0;
    for (const Whole& a : a_) content = gcd(content, a);
    WholePolynomial result = *this;
    if (content != 0)
      for (Whole& a : result.a_) a /= content;
    return result;
  }

  // The quotient and the remainder of a division, multiplied by a number that makes all coefficients integers
  // (pseudo-division).
  struct Division;
  [[nodiscard]] Division divided_by(const WholePolynomial& q) const;
  [[nodiscard]] WholePolynomial without_multiple_roots() const;

  // Returns the coefficients in Bernstein form, multiplied by a positive number.
  [[nodiscard]] std::vector<Whole> bernstein() const {
    if (a_.empty()) return {};
    const std::size_t n = a_.size() - 1;
    std::vector<Whole> b(n + 1);
    const auto choose = [](std::size_t from, std::size_t k) {
      Whole result;
      mpz_bin_uiui(result.get_mpz_t(), from, k);
      return result;
    };
    Whole common = 1;
    for (std::size_t k = 0; k <= n; ++k) common *= choose(n, k);
    for (std::size_t k = 0; k <= n; ++k)
      for (std::size_t i = 0; i <= k; ++i) b[k] += common * choose(k, i) * a_[i] / choose(n, i);
    return b;
  }

  static std::size_t variations(const std::vector<Whole>& b) {
    std::size_t count = 0;
    int last = 0;
    for (const Whole& one : b) {
      if (sgn(one) != 0 && last != 0 && sgn(one) != last) ++count;
      if (sgn(one) != 0) last = sgn(one);
    }
    return count;
  }

  // Returns the number of roots in the open interval (0, 1) of the polynomial with the Bernstein coefficients b. All
  // roots must be simple.
  static std::size_t count_in(const std::vector<Whole>& b) {
    if (variations(b) < 2) return variations(b);
    // Halves the interval by de Casteljau's algorithm. The coefficients on both halves are multiplied by 2^n, so that
    // they are integers.
    std::vector<Whole> before = b, after = b, row = b;
    const std::size_t n = b.size() - 1;
    for (std::size_t level = 0; level <= n; ++level) {
      before[level] = row[0] << static_cast<mp_bitcnt_t>(n - level);
      after[n - level] = row[n - level] << static_cast<mp_bitcnt_t>(n - level);
      for (std::size_t k = 0; k + level < n; ++k) row[k] += row[k + 1];
    }
    return count_in(before) + (sgn(after[0]) == 0 ? 1U : 0U) + count_in(after);
  }

  std::vector<Whole> a_;  // coefficients of 1, t, t^2, ...; the last one is not zero
};

struct WholePolynomial::Division {
  WholePolynomial quotient, remainder;
};

inline WholePolynomial::Division WholePolynomial::divided_by(const WholePolynomial& q) const {
  std::vector<Whole> rest = a_, quotient(a_.size() >= q.a_.size() ? a_.size() - q.a_.size() + 1 : 0);
  for (std::size_t k = quotient.size(); k-- > 0;) {
    const Whole factor = rest[k + q.a_.size() - 1];
    for (Whole& one : rest) one *= q.a_.back();
    for (Whole& one : quotient) one *= q.a_.back();
    quotient[k] += factor;
    for (std::size_t i = 0; i < q.a_.size(); ++i) rest[k + i] -= factor * q.a_[i];
  }
  return {WholePolynomial(quotient), WholePolynomial(rest)};
}

inline WholePolynomial WholePolynomial::greatest_common_divisor(WholePolynomial p, WholePolynomial q) {
  while (!q.is_zero()) {
    WholePolynomial rest = p.is_zero() ? p : p.divided_by(q).remainder.without_content();
    p = std::move(q);
    q = std::move(rest);
  }
  return p;
}

inline WholePolynomial WholePolynomial::without_multiple_roots() const {
  const WholePolynomial p = greatest_common_divisor(*this, derivative());
  return p.a_.size() < 2 ? *this : divided_by(p).quotient.without_content();
}

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_WHOLE_POLYNOMIAL_H_
