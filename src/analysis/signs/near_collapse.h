/// Finds the instants inside a segment at which a normal nearly vanishes, so that its direction is practically
/// discontinuous when it is interpolated or rendered.
///
/// "Nearly" means that |n(t)| falls below kCollapseShare of the largest control normal: far above the rounding of
/// float32, so that faces that were made to collapse and then rounded are found, and far below any intended length. The
/// functions of analysis/signs.h decide exactly whether a normal vanishes.
///
/// Source     docs/theory.md, section 3; the minima of |n(t)| are the roots of a cubic (core/polynomial.h).
/// Threads    pure: no allocation, no throw.
#ifndef CHRONORMAL_ANALYSIS_SIGNS_NEAR_COLLAPSE_H_
#define CHRONORMAL_ANALYSIS_SIGNS_NEAR_COLLAPSE_H_

#include <algorithm>
#include <array>
#include <cstddef>

#include "analysis/signs/length_1.h"
#include "chronormal/normals/control_normals.h"

namespace chronormal::inline internal {

/// The share of the largest control normal below which a normal nearly vanishes: far above the rounding of float32
/// positions, and far below any intended length.
inline constexpr double kCollapseShare = 1e-6;

/// The distance from an end of the segment, in t, within which a collapse belongs to the keyframe there, whose face has
/// no area.
inline constexpr double kCollapseMargin = 1e-6;

struct NearCollapse {
  double t = 0;             ///< |n(t)| is smallest here
  bool turns_over = false;  ///< true if the direction afterwards is opposite to the direction before
};

struct NearCollapses {
  std::array<NearCollapse, 2> at;  ///< ascending in t
  std::size_t count = 0;
  bool everywhere = false;  ///< n is zero in the whole segment; count is 0
};

/// Tells whether a half space proves at a glance that a normal neither nearly vanishes nor vanishes (find_collapses()).
/// The test succeeds for almost every face; if it fails, nothing is known.
[[nodiscard]] inline bool is_far_from_collapse(const ControlNormals& c) noexcept {
  const Vec3d w = c.n0 + c.n1;
  const double least = std::min({dot(c.n0, w), dot(c.m, w), dot(c.n1, w)});
  const double most = std::max({max_abs(c.n0), max_abs(c.m), max_abs(c.n1)});
  return least > 2 * kCollapseShare * most * length_1(w);
}

/// Finds where n(t) vanishes, or nearly, for t in (0, 1). Zeros between which |n(t)| stays below the share count as
/// one. Cost: three dot products for most faces, the roots of a cubic for faces that turn far.
[[nodiscard]] NearCollapses find_near_collapses(const ControlNormals& normals) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_SIGNS_NEAR_COLLAPSE_H_
