/// When a normal vanishes on the way: the instants inside a segment at which a face has no area.
///
/// By the rank of its control normals, n(t) vanishes for no t (rank 3), at most once (rank 2) or at most twice (rank
/// 1). A simple zero turns the face over: the directions before and after are antipodal. A double zero does not: the
/// face shrinks to nothing and comes back as it was. Data in float32 hardly ever hit zero, so what is found is where
/// the length of n(t) falls below kCollapseShare of the largest control normal: so close that the direction is as good
/// as discontinuous. A random curve of rank 3 comes so close with a probability of 1e-12 or so.
///
/// Source     docs/theory.md, section 3; the minima of |n(t)| are the roots of a cubic (core/polynomial.h).
/// Threads    pure: no allocation, no throw.
#ifndef CHRONORMAL_ANALYSIS_COLLAPSE_H_
#define CHRONORMAL_ANALYSIS_COLLAPSE_H_

#include <array>
#include <cstddef>

#include "chronormal/normals/control_normals.h"

namespace chronormal::inline internal {

/// Far above the rounding of float32 positions, far below any length that was meant.
inline constexpr double kCollapseShare = 1e-6;

/// Nearer to an end than this, it is the keyframe that has no area.
inline constexpr double kCollapseMargin = 1e-6;

struct Collapse {
  double t = 0;             ///< where |n(t)| is smallest
  bool turns_over = false;  ///< whether the direction after is opposed to that before
};

struct Collapses {
  std::array<Collapse, 2> at;  ///< ascending in t
  std::size_t count = 0;
  bool everywhere = false;  ///< n is zero in the whole segment; count is 0
};

/// Finds where n(t) vanishes, or nearly, for t in (0, 1). Zeros so close together that |n(t)| stays below the share
/// between them are one. Cost: three dot products for most faces, the roots of a cubic for those that turn far.
[[nodiscard]] Collapses find_collapses(const ControlNormals& normals) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_COLLAPSE_H_
