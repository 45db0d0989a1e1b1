/// The kernels of analysis/signs/facing.cpp: the coefficients of f(t) = n(t) . w(t) of many faces at a time, and the
/// roots of polynomials that change their sign once.
///
/// Every face is computed in its own lane with the same operations, so that its result depends on nothing else.
#ifndef CHRONORMAL_ANALYSIS_SIGNS_KERNELS_FACING_LANES_H_
#define CHRONORMAL_ANALYSIS_SIGNS_KERNELS_FACING_LANES_H_

#include <cstddef>

#include "chronormal/core/vec3.h"
#include "chronormal/normals/control_normals.h"

namespace chronormal::inline internal {

/// The largest number of faces in a block.
inline constexpr std::size_t kFacingBlock = 32;

/// The relative error of a dot product with a control normal, against the sum of the absolute components of the control
/// normal times the largest component of the other vector: sqrt(3) 2^-26 and a few roundings.
inline constexpr double kDotShare = 0x1p-25;

/// The vector from each face to the eye: x, y, z at t = 0, then at t = 1.
struct alignas(64) FacingWays {
  double at[6][kFacingBlock];
};

/// Bernstein coefficients of f, each times its binomial coefficient: three for a direction, four for an eye.
struct alignas(64) FacingCoefficients {
  double values[4][kFacingBlock];
  /// Error bounds of the coefficients, for control normals within 2^-26 of the exact ones.
  double bounds[4][kFacingBlock];
  double reach[kFacingBlock];  ///< the sum of the absolute components of the vector to the viewer, at the end with more
  int signs[kFacingBlock];     ///< 1 or -1 if all coefficients are beyond their bounds on that side; else 0
};

/// Computes the coefficients for a viewer in a direction. count <= kFacingBlock
void facing_of_direction(const ControlNormals* normals, std::size_t count, const Vec3d& way,
                         FacingCoefficients& result) noexcept;
void facing_of_eye(const ControlNormals* normals, std::size_t count, const FacingWays& ways,
                   FacingCoefficients& result) noexcept;

/// Polynomials in Bernstein form, and brackets of their roots.
struct alignas(64) SingleRoots {
  double p[4][kFacingBlock];   ///< the coefficients of each polynomial: three, or four
  double error[kFacingBlock];  ///< the error of each coefficient, without the rounding of later operations
  double lower[kFacingBlock], upper[kFacingBlock];
  int before[kFacingBlock];  ///< the sign before the only root; 0 if the lane could not find all roots
};

/// Finds the only root of each polynomial that certainly has just one root, as CertainRoots does. The other polynomials
/// are left to CertainRoots.
void find_single_roots(std::size_t degree, std::size_t count, SingleRoots& roots) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_SIGNS_KERNELS_FACING_LANES_H_
