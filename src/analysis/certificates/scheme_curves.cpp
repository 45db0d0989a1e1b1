#include "analysis/certificates/scheme_curves.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include "core/portable_math.h"
#include "core/rounding.h"

namespace chronormal::inline internal {
namespace {

constexpr double kE = kFloatUnitRoundoff;
constexpr double kScaling = 2 * kE;  // the error, in radians, of scaling a vector to length 1
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Returns the rounding error of a weighted sum of `count` vectors, if the sum of |weights| |vectors| is 1. The error
// has one rounding for a product, one for each addition, and two for the weights.
constexpr double rounding_of_sum(std::size_t count) { return (static_cast<double>(count) + 2) * kE; }

double length_of(const Vec3d& v) { return std::sqrt(dot(v, v)); }

Bernstein<Vec3d, 3> elevated(const Bernstein<Vec3d, 2>& p) {
  return {p[0], (1.0 / 3) * (p[0] + 2.0 * p[1]), (1.0 / 3) * (2.0 * p[1] + p[2]), p[2]};
}

CurvePiece cubic_piece(const Bernstein<Vec3d, 3>& p, double radius, double middle_radius) {
  return {p, radius, 0.125 * (p[0] + p[3]) + 0.375 * (p[1] + p[2]), middle_radius, kScaling};
}

}  // namespace

CubicCurve::CubicCurve(const WeightBasis& basis, ElementCoefficients c) noexcept : angle_(kScaling) {
  const std::size_t degree = basis.degree();
  assert(degree <= 3);
  const double rounding = rounding_of_sum(basis.count());
  std::array<Vec3d, 4> p{};
  std::array<double, 4> sizes{};  // for each coefficient, the sum of the sizes of its terms
  double largest = 0;
  for (std::size_t k = 0; k < basis.count(); ++k) {
    const Vec3d v = to_double(c.vector(k));
    largest = std::max(largest, length_of(v));
    for (std::size_t i = 0; i <= degree; ++i) {
      p[i] = p[i] + basis.weight(k)[i] * v;
      sizes[i] += std::fabs(basis.weight(k)[i]) * length_of(v);
    }
  }
  if (degree == 1) {
    *this = CubicCurve(p[0], rounding * sizes[0], p[1], rounding * sizes[1]);
    return;
  }
  p_ = degree == 3 ? p : elevated({p[0], p[1], p[2]});
  radius_.fill((rounding * basis.most_weight() + basis.conversion_error()) * largest);
}

CubicCurve::CubicCurve(const Vec3d& from, double from_radius, const Vec3d& to, double to_radius) noexcept
    : p_{from, (1.0 / 3) * (2.0 * from + to), (1.0 / 3) * (from + 2.0 * to), to},
      radius_{from_radius, 0.5 * (from_radius + to_radius), to_radius},
      angle_(kScaling) {}

CubicCurve::CubicCurve(ElementCoefficients c) noexcept : angle_(kScaling) {
  const Vec3d n0 = to_double(c.vector(0)), m = to_double(c.vector(1)), n1 = to_double(c.vector(2));
  p_ = elevated({n0, m, n1});
  const double rounding = rounding_of_sum(3);
  radius_ = {rounding * length_of(n0), rounding * length_of(m), rounding * length_of(n1)};
}

CubicCurve::CubicCurve(const Bernstein<Vec3d, 2>& n, double angle, const Bernstein<double, 2>& error) noexcept
    : p_(elevated(n)), radius_(error), angle_(angle) {}

CurvePiece CubicCurve::over(double a, double b) const noexcept {
  const Bernstein<double, 2> radius = restrict_to(radius_, a, b);
  CurvePiece piece = cubic_piece(restrict_to(p_, a, b), *std::max_element(radius.begin(), radius.end()),
                                 0.25 * (radius[0] + radius[2]) + 0.5 * radius[1]);
  piece.angle = angle_;
  return piece;
}

SumCurve::SumCurve(const WeightBasis& basis, ElementCoefficients c) noexcept : degree_(basis.degree()) {
  double largest = 0;
  p_ = {};
  for (std::size_t k = 0; k < basis.count(); ++k) {
    const Vec3d v = to_double(c.vector(k));
    largest = std::max(largest, length_of(v));
    for (std::size_t i = 0; i <= degree_; ++i) p_[i] = p_[i] + basis.weight(k)[i] * v;
  }
  radius_ = (rounding_of_sum(basis.count()) * basis.most_weight() + basis.conversion_error()) * largest;
}

CurvePiece SumCurve::over(double a, double b) const noexcept {
  std::array<Vec3d, WeightBasis::kMostDegree + 1> coefficients = p_;
  const std::span<Vec3d> p(coefficients.data(), degree_ + 1);
  restrict_in_place(p, a, b);
  // The cubic has the same ends and the same slopes at the ends as p. The cubic is raised to the degree of p, so that
  // the coefficients of both can be compared.
  const double degree = static_cast<double>(degree_), steps = degree / 3;
  const Bernstein<Vec3d, 3> cubic = {p[0], p[0] + steps * (p[1] - p[0]),
                                     p[degree_] + steps * (p[degree_ - 1] - p[degree_]), p[degree_]};
  double away = 0;
  for (std::size_t j = 0; j <= degree_; ++j) {
    Vec3d raised;
    for (std::size_t i = 0; i <= 3; ++i) {
      if (i > j || j - i > degree_ - 3) continue;
      raised = raised + (binomial(3, i) * binomial(degree_ - 3, j - i) / binomial(degree_, j)) * cubic[i];
    }
    away = std::max(away, length_of(p[j] - raised));
  }
  CurvePiece piece = cubic_piece(cubic, radius_ + away * 1.0001, radius_);
  std::array<Vec3d, WeightBasis::kMostDegree + 1> half = coefficients;
  keep_before(std::span<Vec3d>(half.data(), degree_ + 1), 0.5);
  piece.middle = half[degree_];
  return piece;
}

ArcCurve::ArcCurve(Formula formula, ElementCoefficients c) noexcept {
  const bool is_great = formula == Formula::kGreatArc;
  if (!is_great) w_ = to_double(c.vector(0));
  p_ = to_double(c.vector(is_great ? 0 : 1));
  q_ = to_double(c.vector(is_great ? 1 : 2));
  angle_ = static_cast<double>(c[is_great ? 6 : 9]);
  const double w = length_of(w_), p = length_of(p_), q = length_of(q_);
  largest_ = std::max(p, q);
  // Rounding errors come from t, the product of t with the angle A, sine and cosine (at most 1.2e-7 = 2.02 e, where e =
  // 2^-24), two products, and two additions.
  double time_error = 2.01 * kE;
  if (formula == Formula::kTimedCircleArc) {
    // The warped time changes by at most `steepest` times the rounding of t, and by a few roundings of its own.
    const double share = static_cast<double>(c[10]);
    const double steepest = share > 0 && share < 1 ? std::max(share / (1 - share), (1 - share) / share) : kInfinity;
    time_error += (steepest + 6) * kE;
  }
  rounding_ = time_error * angle_ * largest_ + kE * (2.1 * (p + q) + 3 * (w + p + q));
}

CurvePiece ArcCurve::over(double a, double b) const noexcept {
  const double at = (a + (b - a) / 2) * angle_, beta = (b - a) / 2 * angle_;
  const double cosine = portable::cos(at), sine = portable::sin(at);
  const Vec3d p = cosine * p_ + sine * q_, q = cosine * q_ - sine * p_;
  // The formulas below hold for x in [-beta, beta]. In cos x = 1 - x^2 / 2 + x^4 / 24, the formulas replace x^4 by
  // beta^2 x^2 - beta^4 / 8, with an error of at most beta^4 / 8. For the sine, they use sin x = x - x^3 / 6.
  const double square = beta * beta, fourth = square * square;
  const double constant = 1 - fourth / 192, quadratic = square / 24 - 0.5;
  const Vec3d outer = w_ + (constant + quadratic * square) * p, inner = w_ + (constant - quadratic * square / 3) * p;
  const Vec3d far = (beta - beta * square / 6) * q, near = (beta / 3 + beta * square / 6) * q;
  const double away = (fourth / 192 + fourth * square / 720 + fourth * beta / 120) * largest_;
  CurvePiece piece;
  piece.p = {outer - far, inner - near, inner + near, outer + far};
  piece.radius = rounding_ + 1.0001 * away;
  piece.middle = w_ + p;
  piece.middle_radius = rounding_;
  return piece;
}

SphericalCurve::SphericalCurve(std::size_t count, ElementCoefficients c) noexcept : count_(count) {
  constexpr double kMostOff = 4 * kE;  // the largest error of the squared length of a unit vector in float32
  for (std::size_t k = 0; k < count; ++k) {
    const Vec3d v = to_double(c.vector(k));
    points_[k] = unit(v);
    are_unit_ = are_unit_ && std::fabs(dot(v, v) - 1) <= kMostOff;
  }
}

CurvePiece SphericalCurve::over(double a, double b) const noexcept {
  // The largest angle between two vectors, in radians, for which float32 determines their slerp.
  constexpr double kMostTurn = std::numbers::pi - 1e-3;
  if (!are_unit_) return {{}, kInfinity, {}, kInfinity, 0};
  const double t = a + (b - a) / 2, half = (b - a) / 2;
  // The vector that de Casteljau's algorithm has at the middle of the piece, the largest speed of this vector anywhere
  // on the piece, and its rounding errors. `across` is the error perpendicular to the vector, `along` the error in its
  // direction.
  struct Moving {
    Vec3d at;
    double speed = 0, across = 0, along = 0;
  };
  std::array<Moving, kMaxDeCasteljauNormals> row;
  for (std::size_t k = 0; k < count_; ++k) row[k] = {points_[k], 0, 0, kScaling};
  for (std::size_t left = count_ - 1; left > 0; --left) {
    for (std::size_t k = 0; k < left; ++k) {
      const Moving &from = row[k], &to = row[k + 1];
      const double turn = angle_between(from.at, to.at);
      const double most = turn + half * (from.speed + to.speed) + from.across + to.across + 1e-9;
      if (!(most < kMostTurn)) return {{}, kInfinity, {}, kInfinity, 0};
      // If one end of an arc with the angle T moves by the distance 1, the point that divides the arc at `share` moves
      // by sin(share T) / sin T. `factor` bounds this quotient for the shares on this piece.
      const double sine = portable::sin(most);
      const auto factor = [most, sine](double share) {
        if (most < 1e-6) return share * (1 + 1e-9);
        const double angle = share * most;
        return (angle < std::numbers::pi / 2 ? portable::sin(angle) : 1) / sine * (1 + 1e-12);
      };
      const double of_from = factor(1 - a), of_to = factor(b);
      const double local = most < std::numbers::pi / 2 ? 40 * kE : 20 * kE * (1 + 1 / std::min(sine, 1.0));
      Moving next;
      if (turn < 1e-9) {
        next.at = lerp(from.at, to.at, t);
      } else {
        const double inverse = 1 / portable::sin(turn);
        next.at = (portable::sin((1 - t) * turn) * inverse) * from.at + (portable::sin(t * turn) * inverse) * to.at;
      }
      next.at = unit(next.at);
      next.speed = most + of_from * from.speed + of_to * to.speed;
      next.across = of_from * from.across + of_to * to.across +
                    portable::sin(most / 2) / portable::cos(most / 2) * from.along + local;
      next.along = (most < std::numbers::pi / 2 ? 1 : 1 / sine) * from.along + local;
      row[k] = next;
    }
  }
  const Vec3d middle = row[0].at;
  const double rounding = row[0].across + 2 * kE;
  return {{middle, middle, middle, middle}, rounding + half * row[0].speed, middle, rounding, kScaling};
}

}  // namespace chronormal::inline internal
