/// The kernels of analysis/signs/facing.cpp: coefficients of f(t) = n(t) . w(t) of many faces at a time, and the roots of
/// those that change their sign once.
///
/// Every face is computed in its own lane with the same operations, so that a result depends on nothing but its face.
#ifndef CHRONORMAL_ANALYSIS_SIGNS_KERNELS_FACING_LANES_H_
#define CHRONORMAL_ANALYSIS_SIGNS_KERNELS_FACING_LANES_H_

#include <cstddef>

#include "chronormal/core/vec3.h"
#include "chronormal/normals/control_normals.h"

namespace chronormal::inline internal {

/// How many faces are one block, at most.
inline constexpr std::size_t kFacingBlock = 32;

/// By how much a dot product with a control normal may be off, against the sum of the absolute components of that and
/// the largest component of the other vector: sqrt(3) 2^-26 and a few roundings.
inline constexpr double kDotShare = 0x1p-25;

/// The way to the eye of each face at t = 0 (x, y, z) and at t = 1.
struct alignas(64) FacingWays {
  double at[6][kFacingBlock];
};

/// Bernstein coefficients of f, each times its binomial coefficient: three for a direction, four for an eye.
struct alignas(64) FacingCoefficients {
  double values[4][kFacingBlock];
  double bounds[4][kFacingBlock];  ///< how far each may be off, by control normals that are within 2^-26 of theirs
  double reach[kFacingBlock];      ///< the sum of the absolute components of the way to the viewer, the larger one
  int signs[kFacingBlock];         ///< 1 or -1 where all coefficients are beyond their bounds on that side; else 0
};

/// count <= kFacingBlock
void facing_of_direction(const ControlNormals* normals, std::size_t count, const Vec3d& way,
                         FacingCoefficients& result) noexcept;
void facing_of_eye(const ControlNormals* normals, std::size_t count, const FacingWays& ways,
                   FacingCoefficients& result) noexcept;

/// Polynomials in Bernstein form, and brackets of their roots.
struct alignas(64) SingleRoots {
  double p[4][kFacingBlock];   ///< the coefficients of each: three, or four
  double error[kFacingBlock];  ///< how far each of them may be off, without the rounding of what follows
  double lower[kFacingBlock], upper[kFacingBlock];
  int before[kFacingBlock];  ///< the sign below the only root; 0 where it takes more to find all roots
};

/// Finds the only root of those that have one for certain, as CertainRoots does; the others are left to that.
void find_single_roots(std::size_t degree, std::size_t count, SingleRoots& roots) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_SIGNS_KERNELS_FACING_LANES_H_
