/// The largest angle between two curves on one piece of a segment, by Bernstein coefficients.
///
/// A scheme on a piece is a cubic p with a ball around it, and the normal a quadratic n that may be off by a little.
/// Both S = p x n and D = p.n have degree 5, and tan(angle) = |S| / D. A quotient of polynomials lies between the quotients of
/// their Bernstein coefficients as long as those of the denominator are positive, so
///
///     D > 0:   angle <= atan sqrt(max_k (S.S)_k / (D^2)_k)
///     else     angle <= pi - atan sqrt(min_k (S.S)_k / (D^2)_k),   all (S.S)_k > 0
///
/// which converges with the square of the width of the piece. S.S + D^2 = |p|^2 |n|^2 has the same coefficients at
/// hand; its smallest says how much the ball and the error of n turn the two. (docs/theory.md, section 19)
///
/// Threads    pure: no allocation, no throw.
#ifndef CHRONORMAL_ANALYSIS_CERTIFICATES_ANGLE_BOUND_H_
#define CHRONORMAL_ANALYSIS_CERTIFICATES_ANGLE_BOUND_H_

#include <cstddef>

#include "chronormal/core/polynomial.h"
#include "chronormal/core/vec3.h"

namespace chronormal::inline internal {

/// This is the vector that a scheme makes on a piece, before it is scaled to length 1.
struct CurvePiece {
  Bernstein<Vec3d, 3> p;
  double radius = 0;         ///< what is shown at any t of the piece is within this of p(t)
  Vec3d middle;              ///< what is shown in the middle is within
  double middle_radius = 0;  ///< this of `middle`
  double angle = 0;          ///< beside all that, a direction may be off by this, radians
};

/// The normal on a piece, and how long an error it may have.
struct NormalPiece {
  Bernstein<Vec3d, 2> n;
  Bernstein<double, 2> error;
};

/// An upper bound of the angle between what is shown and the true normal, at all t of the piece: pi where there is no
/// better one.
[[nodiscard]] double largest_angle(const CurvePiece& curve, const NormalPiece& normal) noexcept;

/// The angle in the middle of the piece, and how far what is not known may turn it; pi where that is everything.
struct MiddleAngle {
  double angle = 0, uncertainty = 0;
};
[[nodiscard]] MiddleAngle middle_angle(const CurvePiece& curve, const NormalPiece& normal) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_CERTIFICATES_ANGLE_BOUND_H_
