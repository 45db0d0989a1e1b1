/// Finds the instants inside a segment at which a normal nearly vanishes, so that its direction is practically
/// discontinuous when it is interpolated or rendered.
///
/// "Nearly" means that |n(t)| falls below kCollapseShare times the largest control normal. This limit is far above the
/// rounding of float32, so that faces that were made to collapse and then rounded are found. The limit is far below any
/// length that an author intends. The functions of analysis/signs.h decide exactly whether a normal vanishes.
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

/// The length, relative to the largest control normal, below which a normal nearly vanishes. This share is far above
/// the rounding of float32 positions, and far below any length that an author intends.
inline constexpr double kCollapseShare = 1e-6;

/// The distance in t from an end of the segment within which a collapse is not reported. Such a collapse belongs to the
/// keyframe at that end, in which the face has no area.
inline constexpr double kCollapseMargin = 1e-6;

struct NearCollapse {
  double t = 0;             ///< the time at which |n(t)| is smallest
  bool turns_over = false;  ///< true if the direction afterwards is opposite to the direction before
};

struct NearCollapses {
  std::array<NearCollapse, 2> at;  ///< the collapses, in ascending order of t
  std::size_t count = 0;
  bool everywhere = false;  ///< true if n is zero in the whole segment; count is then 0
};

/// Returns true if a quick test proves that a normal neither vanishes nor nearly vanishes. The test shows that all
/// control normals are in one half space. The test succeeds for almost every face. If the test fails, nothing is known,
/// and find_near_collapses() decides.
[[nodiscard]] inline bool is_far_from_collapse(const ControlNormals& c) noexcept {
  const Vec3d w = c.n0 + c.n1;
  const double least = std::min({dot(c.n0, w), dot(c.m, w), dot(c.n1, w)});
  const double most = std::max({max_abs(c.n0), max_abs(c.m), max_abs(c.n1)});
  return least > 2 * kCollapseShare * most * length_1(w);
}

/// Finds the times t in (0, 1) at which n(t) vanishes or nearly vanishes. Minima between which |n(t)| stays below the
/// limit count as one collapse. Cost: three dot products for most faces, and the roots of a cubic for faces that turn
/// far.
[[nodiscard]] NearCollapses find_near_collapses(const ControlNormals& normals) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_SIGNS_NEAR_COLLAPSE_H_
