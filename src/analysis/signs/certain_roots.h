/// Finds the roots of a polynomial whose coefficients are only known up to an error bound. The search succeeds if the
/// number of roots is certain despite the errors.
///
/// In Bernstein form the coefficients bound the polynomial, and by Descartes' rule one change of sign among them means
/// exactly one root. So a part of [0, 1] is settled in two cases: if all coefficients have the same certain sign, or if
/// the coefficients begin with one certain sign, go on with some coefficients of unknown sign, and end with the other
/// certain sign. Any other part is halved, up to kMostHalvings times. If a part is then still not settled, integers
/// decide (analysis/signs/exact_roots.h). The only root of a part is bracketed by two places at which the polynomial is
/// certainly not zero.
#ifndef CHRONORMAL_ANALYSIS_SIGNS_CERTAIN_ROOTS_H_
#define CHRONORMAL_ANALYSIS_SIGNS_CERTAIN_ROOTS_H_

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "analysis/signs/exact_roots.h"
#include "chronormal/core/polynomial.h"
#include "core/rounding.h"

namespace chronormal::inline internal {

template <std::size_t M>
class CertainRoots {
 public:
  /// Finds the roots of all polynomials whose coefficients are within `error` of p. Returns false if two such
  /// polynomials have, or might have, different numbers of roots. If the result is true, no root is at 0 or 1.
  [[nodiscard]] static bool find(const std::array<double, M>& p, double error, ExactRoots& found) noexcept {
    double size = 0;
    for (const double b : p) size = std::max(size, std::fabs(b));
    // A halving adds three roundings to a coefficient, and an evaluation adds nine.
    constexpr double kRoundings = 3 * kMostHalvings + 16;
    return CertainRoots(error + kRoundings * kUnitRoundoff * size, found).settle(p, 0, 1, kMostHalvings);
  }

 private:
  static constexpr int kMostHalvings = 10, kMostSteps = 20;

  CertainRoots(double error, ExactRoots& found) noexcept : error_(error), found_(found) {}

  [[nodiscard]] int sign_of(double value) const noexcept { return value > error_ ? 1 : value < -error_ ? -1 : 0; }

  // Finds the roots in the part of [0, 1] that begins at t0 and is `width` wide. p has the Bernstein coefficients over
  // this part. Returns false if the roots are not certain.
  bool settle(const std::array<double, M>& p, double t0, double width, int halvings) noexcept {
    const int first = sign_of(p[0]), last = sign_of(p[M - 1]);
    if (first != 0 && last != 0) {
      // The signs are one certain sign, then unknown signs, then the other certain sign. Whatever the unknown signs
      // are, there is only one change of sign.
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
    double root = 0, slope = 0;  // `slope` is |p'| at the root
  };

  // Returns the only root in [0, 1] of a quadratic whose values at 0 and 1 have different signs. s = t / (1 - t) is a
  // root of p2 s^2 + 2 p1 s + p0, and is computed by the formula in which nothing cancels.
  static double root_of_quadratic(double p0, double p1, double p2) noexcept {
    const double w = p1 + std::copysign(std::sqrt(p1 * p1 - p0 * p2), p1);
    return (w < 0) == (p2 < 0) ? p0 / (p0 - w) : w / (w - p2);
  }

  static Guess only_root(const std::array<double, 3>& p) noexcept {
    const double t = root_of_quadratic(p[0], p[1], p[2]);
    return {t, std::fabs(2 * ((1 - t) * (p[1] - p[0]) + t * (p[2] - p[1])))};
  }

  // Finds the only root by Newton's method, which starts from the root of a quadratic that agrees with p at the ends
  // and in the middle. Bisection keeps the root between values of different signs. Rounding limits the accuracy of the
  // result.
  static Guess only_root(const std::array<double, 4>& p) noexcept {
    constexpr double kLastStep = 0x1p-28;  // after a step of this size, the error is about the square of the step
    const double a1 = 3 * (p[1] - p[0]), a2 = 3 * ((p[2] - p[1]) - (p[1] - p[0])),
                 a3 = (p[3] - p[0]) - 3 * (p[2] - p[1]);
    double low = 0, high = 1, slope = 0;
    double t = root_of_quadratic(p[0], 0.25 * (3 * (p[1] + p[2]) - (p[0] + p[3])), p[3]);
    for (int i = 0; i < kMostSteps; ++i) {
      const double value = ((a3 * t + a2) * t + a1) * t + p[0];
      slope = (3 * a3 * t + 2 * a2) * t + a1;
      ((value < 0) == (p[0] < 0) ? low : high) = t;
      double next = t - value / slope;
      if (!(low <= next && next <= high)) next = low + (high - low) / 2;
      const double step = std::fabs(next - t);
      t = next;
      if (step <= kLastStep) break;
    }
    return {t, std::fabs(slope)};
  }

  bool add_root(const std::array<double, M>& p, double t0, double width, int before) noexcept {
    const auto [root, slope] = only_root(p);
    const double per_width = 1 / width;  // a power of two
    double step = 2 * error_ / slope + 2 * kUnitRoundoff;
    for (int i = 0; i < 4; ++i, step *= 8) {
      // The bounds may be rounded. But (t - t0) / width is computed exactly, so the signs below are the signs at the
      // rounded bounds.
      const double lower = std::max(t0 + width * std::max(root - step, 0.0), t0);
      const double upper = std::min(t0 + width * std::min(root + step, 1.0), t0 + width);
      const auto sign_at = [&](double t) { return sign_of(evaluate(p, (t - t0) * per_width)); };
      if (sign_at(lower) == before && sign_at(upper) == -before) {
        if (found_.count == M - 1) return false;
        found_.at[found_.count++] = {lower, upper, before, -before};
        return true;
      }
    }
    return false;
  }

  double error_;
  ExactRoots& found_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_SIGNS_CERTAIN_ROOTS_H_
