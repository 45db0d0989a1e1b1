/// Bounds the curves of schemes piece by piece. For any piece [a, b], finds a cubic and a radius such that the rendered
/// vector is always within a ball of that radius around the cubic.
///
/// Everything is computed from the float32 coefficients that the scheme evaluates (schemes/fitted_curves.h), so the
/// rounding of fits does not matter. The rounding of one evaluation, with e = 2^-24, is bounded for each formula of
/// schemes/kernels/formulas-inl.h, operation by operation (docs/theory.md, section 19):
///
///     weighted sums of K + 1       (K + 3) e sum |w_k| |c_k|
///     arcs                         e (2 A r + 2.1 (|p| + |q|) + 3 (|w| + |p| + |q|)),   r the larger of |p|, |q|
///     slerp of slerp, each         40 e, or 20 e (1 + 1 / sin T) beyond a right angle
///     scaling to length 1          2 e, an angle
///
/// Threads    pure: no allocation, no throw, unless a class says so.
#ifndef CHRONORMAL_ANALYSIS_CERTIFICATES_SCHEME_CURVES_H_
#define CHRONORMAL_ANALYSIS_CERTIFICATES_SCHEME_CURVES_H_

#include <array>
#include <cstddef>
#include <vector>

#include "analysis/certificates/angle_bound.h"
#include "chronormal/core/polynomial.h"
#include "chronormal/core/vec3.h"
#include "schemes/fitted_curves.h"
#include "schemes/weight_basis.h"

namespace chronormal::inline internal {

/// Curves that are exactly cubics: weighted sums whose weights have degree 3 at most, and quadratics.
class CubicCurve {
 public:
  /// Takes the weights and the coefficients of a weighted sum. Precondition: basis.degree() is at most 3.
  CubicCurve(const WeightBasis& basis, ElementCoefficients c) noexcept;
  /// Takes the coefficients of the numerator of the scheme `rational`, which is a quadratic whose weights are Bernstein
  /// polynomials.
  explicit CubicCurve(ElementCoefficients c) noexcept;
  /// Takes a line between two vectors, each of which may be anywhere in a ball of the given radius.
  CubicCurve(const Vec3d& from, double from_radius, const Vec3d& to, double to_radius) noexcept;
  /// Takes a quadratic that is rendered with an error of up to `angle` radians. The length of a further error of the
  /// quadratic itself is at most `error`.
  CubicCurve(const Bernstein<Vec3d, 2>& n, double angle, const Bernstein<double, 2>& error = {}) noexcept;

  [[nodiscard]] CurvePiece over(double a, double b) const noexcept;

 private:
  Bernstein<Vec3d, 3> p_;
  Bernstein<double, 2> radius_{};  // radius of the ball around the cubic, as a polynomial over [0, 1]
  double angle_;
};

/// Weighted sums whose weights have degree 3 or more. Each sum is within a ball around the cubic that has the same ends
/// and the same slopes at the ends.
class SumCurve {
 public:
  /// Takes the weights and the coefficients of a weighted sum. Precondition: basis.degree() is at least 3.
  SumCurve(const WeightBasis& basis, ElementCoefficients c) noexcept;

  [[nodiscard]] CurvePiece over(double a, double b) const noexcept;

 private:
  std::size_t degree_;
  std::array<Vec3d, WeightBasis::kMostDegree + 1> p_;
  double radius_ = 0;
};

/// Great arcs and other circular arcs. For an arc that reaches its middle at another time than 1/2, the last
/// coefficient is the share of the time before the middle. Such an arc runs in warped time; see warped_normal().
class ArcCurve {
 public:
  /// Takes the coefficients w, p, q, A of one of the formulas kGreatArc, kCircleArc and kTimedCircleArc, in their
  /// order.
  ArcCurve(Formula formula, ElementCoefficients c) noexcept;

  [[nodiscard]] CurvePiece over(double a, double b) const noexcept;

 private:
  Vec3d w_, p_, q_;
  double angle_ = 0, largest_ = 0, rounding_ = 0;
};

/// The curves that de Casteljau's algorithm makes with slerp. On a piece, a curve is within a ball around the vector in
/// the middle of the piece.
class SphericalCurve {
 public:
  SphericalCurve(std::size_t count, ElementCoefficients c) noexcept;

  [[nodiscard]] CurvePiece over(double a, double b) const noexcept;

 private:
  std::size_t count_;
  std::array<Vec3d, kMaxDeCasteljauNormals> points_;
  bool are_unit_ = true;  // false if not all points are unit vectors; then no bound is known
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_CERTIFICATES_SCHEME_CURVES_H_
