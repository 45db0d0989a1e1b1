/// Finds where a polynomial with integer coefficients is zero in [0, 1], and its sign everywhere else, without any
/// rounding.
///
///     f(t) = a[0] + a[1] t + ... + a[N] t^N,   N = 1, 2 or 3
///
/// Sturm's theorem counts the roots: in the chain f, f', -(f mod f'), ... the number of changes of sign drops by one at
/// each root of f, whatever its multiplicity, and nowhere else. All signs are signs of integers (core/wide_integer.h).
/// The signs are taken just after t, so a t that is itself a root needs no special case. The number of changes is
/// monotone in t, so a search over doubles finds the neighbours between which the number drops. The search starts from
/// a guess in floating point, which only affects the time: a few microseconds with a good guess.
///
/// Several roots between the same two neighbouring doubles are returned as one root. Roots below 2^-200 count as 0.
///
/// Source: Basu, Pollack, Roy, Algorithms in Real Algebraic Geometry (2006), chapter 2.
#ifndef CHRONORMAL_ANALYSIS_SIGNS_EXACT_ROOTS_H_
#define CHRONORMAL_ANALYSIS_SIGNS_EXACT_ROOTS_H_

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "chronormal/core/polynomial.h"
#include "core/bits.h"
#include "core/wide_integer.h"

namespace chronormal::inline internal {

/// A root in [lower, upper]. The two bounds are equal, or are doubles with no double between them. Several roots
/// between two such bounds count as one root.
struct ExactRoot {
  double lower = 0, upper = 0;
  int before = 0, after = 0;  ///< signs of f before and after the root; 0 before t = 0 and after t = 1
};

struct ExactRoots {
  std::array<ExactRoot, 3> at;  ///< the roots, in ascending order
  std::size_t count = 0;
  int sign = 0;  ///< the sign of f if f has no root; 0 if f is zero throughout

  [[nodiscard]] std::span<const ExactRoot> all() const& noexcept { return {at.data(), count}; }
  void all() && = delete;  // a loop over a temporary would outlive it
};

/// A polynomial of degree up to N. Its coefficients are in the order of rising powers, and must be settled
/// (WideInteger::settle()).
template <std::size_t N, std::size_t kDigits>
struct IntegerPolynomial {
  std::array<WideInteger<kDigits>, N + 1> a;

  /// Returns the number of coefficients up to the last nonzero coefficient.
  [[nodiscard]] std::size_t terms() const noexcept {
    std::size_t count = N + 1;
    while (count > 0 && a[count - 1].sign() == 0) --count;
    return count;
  }

  /// Returns the sign of a derivative of f at t. The derivative of order 0 is f itself.
  [[nodiscard]] int sign_at(const UnitFraction& t, std::size_t derivative = 0) const noexcept {
    constexpr std::size_t kDigitsOfFactor = 11;  // t is an integer times 2^-scale, with scale < 264
    using Value = WideInteger<kDigits + N * kDigitsOfFactor + 4>;
    const std::size_t count = terms();
    if (count <= derivative) return 0;
    Value value;
    for (std::size_t k = count; k > derivative; --k) {
      Value next;
      next.add_product(value, t);
      WideInteger<kDigits + 1> term;
      term.add(a[k - 1], static_cast<std::int64_t>(binomial(k - 1, derivative)));
      term.settle();
      next.add_shifted(term, static_cast<unsigned>(count - k) * t.scale);
      next.settle();
      value = next;
    }
    return value.sign();
  }

  /// Returns the sign of f just after t, which is the sign of the first derivative that is not zero at t.
  [[nodiscard]] int sign_after(const UnitFraction& t) const noexcept {
    for (std::size_t derivative = 0; derivative <= N; ++derivative) {
      if (const int sign = sign_at(t, derivative); sign != 0) return sign;
    }
    return 0;
  }

  [[nodiscard]] int sign_before_zero() const noexcept {
    for (std::size_t k = 0; k <= N; ++k) {
      if (a[k].sign() != 0) return k % 2 == 0 ? a[k].sign() : -a[k].sign();
    }
    return 0;
  }
};

/// Sturm's chain of a polynomial f. The chain has f, the derivative f' and the remainders, each multiplied by a
/// positive factor.
template <std::size_t N, std::size_t kDigits>
class SturmChain {
 public:
  explicit SturmChain(const IntegerPolynomial<N, kDigits>& f) noexcept : f_(f) {
    const std::size_t terms = f.terms();
    for (std::size_t k = 1; k < terms; ++k) {
      slope_.a[k - 1].add(f.a[k], static_cast<std::int64_t>(k));
      slope_.a[k - 1].settle();
    }
    if (terms == 3) take_quadratic();
    if constexpr (N == 3) {
      if (terms == 4) take_cubic();
    }
  }

  /// Return the number of changes of sign in the chain just after t, and just before 0.
  [[nodiscard]] int variations_after(const UnitFraction& t) const noexcept {
    return variations(f_.sign_after(t), slope_.sign_after(t), remainder_.sign_after(t));
  }
  [[nodiscard]] int variations_before_zero() const noexcept {
    return variations(f_.sign_before_zero(), slope_.sign_before_zero(), remainder_.sign_before_zero());
  }

 private:
  [[nodiscard]] int variations(int f, int slope, int remainder) const noexcept {
    int count = 0, last = 0;
    for (const int sign : {f, slope, remainder, last_}) {
      if (sign != 0 && last != 0 && sign != last) ++count;
      if (sign != 0) last = sign;
    }
    return count;
  }

  // Computes the remainder r for a quadratic: f = q f' - r with r = (a1^2 - 4 a0 a2) / (4 a2).
  void take_quadratic() noexcept {
    const int sign = f_.a[2].sign();
    Wide fourfold;
    fourfold.add_product(f_.a[0], f_.a[2], 4);
    fourfold.settle();
    remainder_.a[0].add_product(f_.a[1], f_.a[1], sign);
    remainder_.a[0].add(fourfold, -sign);
    remainder_.a[0].settle();
  }

  // Computes the remainders for a cubic: f = q f' - r with 9 a3 r = (2 a2^2 - 6 a1 a3) t + (a1 a2 - 9 a0 a3), and f' =
  // q r - s with r_1^2 s = -(3 a3 r_0^2 - 2 a2 r_0 r_1 + a1 r_1^2).
  void take_cubic() noexcept {
    const auto& a = f_.a;
    const int sign = a[3].sign();
    auto& [r0, r1] = remainder_.a;
    r1.add_product(a[2], a[2], 2 * sign);
    r1.add_product(a[1], a[3], -6 * sign);
    r0.add_product(a[1], a[2], sign);
    r0.add_product(a[0], a[3], -9 * sign);
    r0.settle();
    r1.settle();
    if (r1.sign() == 0) return;
    WideInteger<5 * kDigits + 4> last;
    const auto add = [&](const Wide& p, const Wide& q, const WideInteger<kDigits>& b, int factor) {
      WideInteger<4 * kDigits + 3> product;
      product.add_product(p, q);
      product.settle();
      last.add_product(product, b, factor);
    };
    add(r0, r0, a[3], -3);
    add(r0, r1, a[2], 2);
    add(r1, r1, a[1], -1);
    last.settle();
    last_ = last.sign();
  }

  using Wide = WideInteger<2 * kDigits + 1>;
  IntegerPolynomial<N, kDigits> f_;
  IntegerPolynomial<N - 1, kDigits + 1> slope_;
  IntegerPolynomial<1, 2 * kDigits + 1> remainder_;
  int last_ = 0;
};

// Doubles are numbered in ascending order: 0 has the number 0, and the doubles in [2^-200, 1] follow.
inline constexpr std::uint64_t kBelowFirstDouble = (std::uint64_t{1023 - 200} << 52) - 1;
inline constexpr std::uint64_t kLastDouble = (std::uint64_t{1023} << 52) - kBelowFirstDouble;
[[nodiscard]] inline double numbered_double(std::uint64_t number) noexcept {
  return number == 0 ? 0 : bit_cast<double>(number + kBelowFirstDouble);
}
[[nodiscard]] inline std::uint64_t number_of_double(double t) noexcept {
  if (!(t >= 0x1p-200)) return 0;
  return t >= 1 ? kLastDouble : bit_cast<std::uint64_t>(t) - kBelowFirstDouble;
}

/// Returns the roots of f in floating point, as guesses.
template <std::size_t N, std::size_t kDigits>
[[nodiscard]] Roots<N> guess_roots(const IntegerPolynomial<N, kDigits>& f) noexcept {
  std::size_t size = 0;
  for (const auto& coefficient : f.a) size = std::max(size, coefficient.size());
  Power<double, N> rounded;
  for (std::size_t k = 0; k <= N; ++k) rounded.a[k] = f.a[k].to_double(-kDigitBits * static_cast<int>(size));
  return roots_in_unit_interval(to_bernstein(rounded));
}

template <std::size_t N, std::size_t kDigits>
[[nodiscard]] ExactRoots exact_roots(const IntegerPolynomial<N, kDigits>& f) noexcept {
  const auto at = [](std::uint64_t number) { return UnitFraction::of(numbered_double(number)); };
  ExactRoots found;
  found.sign = f.sign_after(at(0));
  if (found.sign == 0) return found;
  const SturmChain<N, kDigits> chain(f);
  const int at_start = chain.variations_before_zero();
  const auto count_up_to = [&](std::uint64_t number) { return at_start - chain.variations_after(at(number)); };
  const int total = count_up_to(kLastDouble);
  if (total == 0) return found;

  const Roots<N> guesses = guess_roots(f);
  for (int i = 1; i <= total;) {
    // The search is for the first double up to which there are i roots. This double is always in (low, high].
    const double guess = guesses.count == 0 ? 0.5 : guesses.t[std::min(static_cast<std::size_t>(i), guesses.count) - 1];
    std::int64_t low = -1, high = static_cast<std::int64_t>(kLastDouble), step = 1;
    for (auto probe = static_cast<std::int64_t>(number_of_double(guess)); low < high - 1; step *= 2) {
      if (count_up_to(static_cast<std::uint64_t>(probe)) >= i) {
        high = probe;
        probe = high - step;
        if (probe <= low) break;
      } else {
        low = probe;
        probe = low + step;
        if (probe >= high) break;
      }
    }
    while (low < high - 1) {
      const std::int64_t middle = low + (high - low) / 2;
      (count_up_to(static_cast<std::uint64_t>(middle)) >= i ? high : low) = middle;
    }
    const UnitFraction end = at(static_cast<std::uint64_t>(high));
    const int count = count_up_to(static_cast<std::uint64_t>(high));
    const bool is_root = f.sign_at(end) == 0;
    ExactRoot root;
    root.upper = numbered_double(static_cast<std::uint64_t>(high));
    root.lower = is_root && count == i ? root.upper : numbered_double(static_cast<std::uint64_t>(low));
    root.before = low < 0 ? 0 : f.sign_after(at(static_cast<std::uint64_t>(low)));
    root.after = is_root && root.upper == 1 ? 0 : f.sign_after(end);
    found.at[found.count++] = root;
    i = count + 1;
  }
  return found;
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_SIGNS_EXACT_ROOTS_H_
