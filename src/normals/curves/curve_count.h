/// Counts how many bytes NormalCurves take, and how many of their elements are flagged, without building them.
///
///     CurveCount count = count_curves(segment, {0, 1024}, exact);
///     count.add(count_curves(segment, {1024, 1024}, exact));          // ... and so on to the last face
///     count.bytes(face_count) == NormalCurves::of_faces(segment).bytes()
///
/// Threads    pure; each call takes the memory of a chunk.
#ifndef CHRONORMAL_NORMALS_CURVES_CURVE_COUNT_H_
#define CHRONORMAL_NORMALS_CURVES_CURVE_COUNT_H_

#include <cstddef>
#include <span>

#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"
#include "normals/control/kernels/exact_tile.h"
#include "normals/curves/curve_data.h"

namespace chronormal::inline internal {

/// The sizes of the curves of some neighbouring elements.
struct CurveCount {
  std::size_t block_bytes = 0, runs = 0, flagged = 0, exact = 0, digits = 0;
  bool has_exponents = false;
  BlockKind first = BlockKind::kUnit, last = BlockKind::kUnit;  ///< kinds of runs

  [[nodiscard]] static CurveCount of(const CurveData& curves) noexcept;

  /// Adds the elements that follow.
  void add(const CurveCount& next) noexcept;
  /// Returns how many bytes the curves of `size` elements take in all, as NormalCurves::bytes() counts them.
  [[nodiscard]] std::size_t bytes(std::size_t size) const noexcept;
};

/// The alignment of ranges of elements that are counted together: each begins at a multiple of this number.
inline constexpr std::size_t kCountedTogether = 512;

/// Counts the sizes of exact curves of some faces, and writes their control normals and longest edges, sixteen faces
/// each. faces.first must be a multiple of kCountedTogether. faces.end() must also be such a multiple or the end of all
/// faces, unless there are no faces. exact must have ceil(faces.count / 16) elements
[[nodiscard]] CurveCount count_curves(const Segment& segment, IndexRange faces, std::span<EdgedTile> exact);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CURVES_CURVE_COUNT_H_
