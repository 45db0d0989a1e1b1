/// Proves for sixteen faces between two keyframes, with little work, that nothing unusual happens. The proof succeeds
/// for almost all faces.
#ifndef CHRONORMAL_ANALYSIS_SIGNS_KERNELS_FACE_GLANCE_H_
#define CHRONORMAL_ANALYSIS_SIGNS_KERNELS_FACE_GLANCE_H_

#include <cstdint>

#include "normals/control/kernels/exact_tile.h"

namespace chronormal::inline internal {

struct GlanceLimits {
  /// The least length of a normal at either end, per unit of the longest edge; below 0 if an end is not judged.
  double length_from = 0, length_to = 0;
  /// The square of the cosine of an angle between 0 and 90 degrees: faces must turn less.
  double square_of_cosine = 0;
};

/// Returns the faces, as bits, that are not certainly usual. A face is usual if the largest component of its normal is
/// above the limit at both ends, it turns less than the angle, and is_far_from_collapse() is true of it.
[[nodiscard]] std::uint32_t unusual_faces(const EdgedTile& tile, const GlanceLimits& limits) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_SIGNS_KERNELS_FACE_GLANCE_H_
