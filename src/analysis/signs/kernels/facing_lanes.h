/// The kernels of analysis/signs/facing.cpp: the coefficients of f(t) = n(t) . w(t) of many faces at a time, where w is
/// the vector to the viewer, and the roots of polynomials that change their sign once.
///
/// Every face is computed in its own lane with the same operations, so that its result does not depend on other faces.
#ifndef CHRONORMAL_ANALYSIS_SIGNS_KERNELS_FACING_LANES_H_
#define CHRONORMAL_ANALYSIS_SIGNS_KERNELS_FACING_LANES_H_

#include <cstddef>

#include "chronormal/core/vec3.h"
#include "chronormal/normals/control_normals.h"

namespace chronormal::inline internal {

/// The largest number of faces in a block, which one call computes.
inline constexpr std::size_t kFacingBlock = 32;

/// A bound of the error of a dot product with a control normal. The bound is relative to the sum of the absolute
/// components of the control normal times the largest component of the other vector. The bound covers sqrt(3) 2^-26 for
/// the control normal, and a few roundings.
inline constexpr double kDotShare = 0x1p-25;

/// The vector from each face to the eye: x, y, z at t = 0, and then x, y, z at t = 1.
struct alignas(64) FacingWays {
  double at[6][kFacingBlock];
};

/// The Bernstein coefficients of f = n . w (normal and vector to the viewer), each multiplied by its binomial
/// coefficient. A viewer infinitely far away has three coefficients, since f is a quadratic; an eye at a point has
/// four, since f is a cubic.
struct alignas(64) FacingCoefficients {
  double values[4][kFacingBlock];
  /// The error bounds of the coefficients, if each control normal differs from the exact one by at most 2^-26 of its
  /// length.
  double bounds[4][kFacingBlock];
  /// The sum of the absolute components of the vector to the viewer, at that end of the segment where it is larger.
  double reach[kFacingBlock];
  /// The sign of all coefficients if every coefficient exceeds its error bound and all have one sign; otherwise 0.
  int signs[kFacingBlock];
};

/// Compute the coefficients of f = n . w for a viewer in a direction, and for an eye. Precondition: count <=
/// kFacingBlock.
void facing_of_direction(const ControlNormals* normals, std::size_t count, const Vec3d& way,
                         FacingCoefficients& result) noexcept;
void facing_of_eye(const ControlNormals* normals, std::size_t count, const FacingWays& ways,
                   FacingCoefficients& result) noexcept;

/// Polynomials in Bernstein form, and the bracket of the only root of each.
struct alignas(64) SingleRoots {
  double p[4][kFacingBlock];   ///< the coefficients of each polynomial, three or four
  double error[kFacingBlock];  ///< the error of each coefficient, not counting the rounding of later operations
  double lower[kFacingBlock], upper[kFacingBlock];
  int before[kFacingBlock];  ///< the sign before the root; 0 if the root was not found
};

/// Finds the root of each polynomial that certainly has exactly one root. The other polynomials are left to
/// CertainRoots.
void find_single_roots(std::size_t degree, std::size_t count, SingleRoots& roots) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_SIGNS_KERNELS_FACING_LANES_H_
