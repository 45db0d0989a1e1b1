/// Proves for sixteen faces at a time, with little work, that the normals of the faces are long at both keyframes, turn
/// little, and do not nearly vanish in between. The proof succeeds for almost all faces.
#ifndef CHRONORMAL_ANALYSIS_SIGNS_KERNELS_FACE_GLANCE_H_
#define CHRONORMAL_ANALYSIS_SIGNS_KERNELS_FACE_GLANCE_H_

#include <cstdint>

#include "normals/control/kernels/exact_tile.h"

namespace chronormal::inline internal {

struct GlanceLimits {
  /// The length that a normal must exceed at each end, divided by the length of the longest edge. A number below 0
  /// means that the length at this end is not judged.
  double length_from = 0, length_to = 0;
  /// The square of the cosine of an angle between 0 and 90 degrees. The normals of a face at both ends must differ by
  /// less than this angle.
  double square_of_cosine = 0;
};

/// Returns a number whose bits mark the faces that are not certainly usual. A face is usual if its normal is longer
/// than the limit at both ends, if the normal turns by less than the limit, and if is_far_from_collapse() is true for
/// the face.
[[nodiscard]] std::uint32_t unusual_faces(const EdgedTile& tile, const GlanceLimits& limits) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_SIGNS_KERNELS_FACE_GLANCE_H_
