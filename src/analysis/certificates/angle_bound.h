/// Bounds the largest angle between two curves on one piece of a segment, by Bernstein coefficients.
///
/// On a piece, the vector of a scheme is in a ball around a cubic p, and the exact normal is a quadratic n with a small
/// error. Both S = p x n and D = p.n have degree 5, and tan(angle) = |S| / D. A quotient of polynomials lies between
/// the quotients of their Bernstein coefficients if the coefficients of the denominator are positive, so
///
///     D > 0:   angle <= atan sqrt(max_k (S.S)_k / (D^2)_k)
///     else     angle <= pi - atan sqrt(min_k (S.S)_k / (D^2)_k),   if all (S.S)_k > 0
///
/// Both bounds converge with the square of the width of the piece. The sums (S.S)_k + (D^2)_k are the Bernstein
/// coefficients of S.S + D^2 = |p|^2 |n|^2. The smallest sum bounds the angles by which the ball and the error of n can
/// turn p and n (docs/theory.md, section 19).
///
/// Threads    pure: no allocation, no throw.
#ifndef CHRONORMAL_ANALYSIS_CERTIFICATES_ANGLE_BOUND_H_
#define CHRONORMAL_ANALYSIS_CERTIFICATES_ANGLE_BOUND_H_

#include <cstddef>

#include "chronormal/core/polynomial.h"
#include "chronormal/core/vec3.h"

namespace chronormal::inline internal {

/// The vector p(t) that a scheme makes on a piece of a segment, before the vector is scaled to length 1.
struct CurvePiece {
  Bernstein<Vec3d, 3> p;
  /// A bound of the distance between the rendered vector and p(t), at any t of the piece.
  double radius = 0;
  Vec3d middle;              ///< a vector near the rendered vector at the middle of the piece
  double middle_radius = 0;  ///< bound of the distance between `middle` and the rendered vector at the middle
  double angle = 0;          ///< a further error of the direction of the rendered vector, in radians
};

/// The exact normal on a piece of a segment, as a quadratic, and a bound of the length of its error.
struct NormalPiece {
  Bernstein<Vec3d, 2> n;
  Bernstein<double, 2> error;
};

/// Returns an upper bound, in radians, of the angle between the rendered and the true normal at all t of the piece.
/// Returns pi if no smaller bound is known.
[[nodiscard]] double largest_angle(const CurvePiece& curve, const NormalPiece& normal) noexcept;

/// The angle in the middle of the piece, in radians, and a bound of the change that errors may cause in this angle. The
/// angle is pi if a direction is unknown.
struct MiddleAngle {
  double angle = 0, uncertainty = 0;
};
[[nodiscard]] MiddleAngle middle_angle(const CurvePiece& curve, const NormalPiece& normal) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_CERTIFICATES_ANGLE_BOUND_H_
