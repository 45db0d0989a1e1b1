/// Roots of a polynomial whose coefficients are only known to a bound, as far as that bound lets them be certain.
///
/// In Bernstein form the coefficients bound the polynomial, and by Descartes' rule one change of sign among them is
/// exactly one root. So a part of [0, 1] is settled where all coefficients are beyond the bound on one side, or where
/// those beyond it on one side come first, those beyond it on the other side last, and only those of which the sign is
/// unknown between. Any other part is halved, a few times; what is not settled then is for integers
/// (analysis/signs/exact_roots.h). The only root of a part is bracketed by two values that are beyond the bound.
#ifndef CHRONORMAL_ANALYSIS_SIGNS_CERTAIN_ROOTS_H_
#define CHRONORMAL_ANALYSIS_SIGNS_CERTAIN_ROOTS_H_

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "analysis/signs/exact_roots.h"
#include "chronormal/core/polynomial.h"
#include "core/rounding.h"

namespace chronormal::inline internal {

template <std::size_t M>
class CertainRoots {
 public:
  /// The roots of all polynomials with coefficients within error of these; nothing where they differ in the number of
  /// roots, or where it takes more to see that they do not. (A root has no part in 0 or 1 then.)
  [[nodiscard]] static std::optional<ExactRoots> of(const std::array<double, M>& p, double error) noexcept {
    double size = 0;
    for (const double b : p) size = std::fmax(size, std::fabs(b));
    // A halving adds three roundings to a coefficient, and an evaluation nine.
    constexpr double kRoundings = 3 * kMostHalvings + 16;
    CertainRoots search(error + kRoundings * kUnitRoundoff * size);
    if (!search.settle(p, 0, 1, kMostHalvings)) return std::nullopt;
    return search.found_;
  }

 private:
  static constexpr int kMostHalvings = 10, kMostSteps = 20;

  explicit CertainRoots(double error) noexcept : error_(error) {}

  [[nodiscard]] int sign_of(double value) const noexcept { return value > error_ ? 1 : value < -error_ ? -1 : 0; }

  // Settles the part of [0, 1] from t0 on, of this width, on which the polynomial is p.
  bool settle(const std::array<double, M>& p, double t0, double width, int halvings) noexcept {
    const int first = sign_of(p[0]), last = sign_of(p[M - 1]);
    if (first != 0 && last != 0) {
      // One side, then unknown ones, then the other: at most one change, whatever the unknown ones are.
      bool is_settled = true;
      std::size_t k = 0;
      while (k < M && sign_of(p[k]) == first) ++k;
      if (k < M) {
        while (k < M && sign_of(p[k]) == 0) ++k;
        while (k < M && sign_of(p[k]) == last) ++k;
        is_settled = k == M && first != last;
      }
      if (is_settled) {
        if (first == last) {
          if (found_.count == 0) found_.sign = first;
          return true;
        }
        return add_root(p, t0, width, first);
      }
    }
    if (halvings == 0) return false;
    const Halves<double, M - 1> halves = split(p, 0.5);
    return settle(halves.before, t0, width / 2, halvings - 1) &&
           settle(halves.after, t0 + width / 2, width / 2, halvings - 1);
  }

  struct Guess {
    double root = 0, slope = 0;  // slope: of p there, without its sign
  };

  // By Newton's method, kept between values of different signs by bisection; rounding decides how good it is.
  static Guess only_root(const std::array<double, M>& p) noexcept {
    const Power<double, M - 1> power = to_power(p);
    double low = 0, high = 1, t = p[0] / (p[0] - p[M - 1]), slope = 0;
    for (int i = 0; i < kMostSteps; ++i) {
      double value = power.a[M - 1];
      slope = 0;
      for (std::size_t k = M - 1; k > 0; --k) {
        slope = slope * t + value;
        value = value * t + power.a[k - 1];
      }
      ((value < 0) == (p[0] < 0) ? low : high) = t;
      double next = t - value / slope;
      if (!(low <= next && next <= high)) next = low + (high - low) / 2;
      if (std::fabs(next - t) <= 2 * kUnitRoundoff) break;
      t = next;
    }
    return {t, std::fabs(slope)};
  }

  bool add_root(const std::array<double, M>& p, double t0, double width, int before) noexcept {
    const auto [root, slope] = only_root(p);
    double step = 2 * error_ / slope + 2 * kUnitRoundoff;
    for (int i = 0; i < 4; ++i, step *= 8) {
      // The sums may round; the fractions of the part that they stand for are exact again.
      const double lower = std::fmax(t0 + width * std::fmax(root - step, 0.0), t0);
      const double upper = std::fmin(t0 + width * std::fmin(root + step, 1.0), t0 + width);
      const auto sign_at = [&](double t) { return sign_of(evaluate(p, (t - t0) / width)); };
      if (sign_at(lower) == before && sign_at(upper) == -before) {
        if (found_.count == M - 1) return false;
        found_.at[found_.count++] = {lower, upper, before, -before};
        return true;
      }
    }
    return false;
  }

  double error_;
  ExactRoots found_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_SIGNS_CERTAIN_ROOTS_H_
