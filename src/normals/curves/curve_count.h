/// Counts the bytes that NormalCurves take, and the number of their flagged elements (for which float32 is not accurate
/// enough), without building the curves.
///
///     CurveCount count = count_curves(segment, {0, 1024}, exact);
///     count.add(count_curves(segment, {1024, 1024}, exact));          // ... and so on to the last face
///     count.bytes(face_count) == NormalCurves::of_faces(segment).bytes()
///
/// Threads    pure; each call takes the memory of one chunk of elements.
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
  BlockKind first = BlockKind::kUnit, last = BlockKind::kUnit;  ///< the kinds of the first and of the last run

  [[nodiscard]] static CurveCount of(const CurveData& curves) noexcept;

  /// Adds the counts `next` of the elements that follow the elements of this object.
  void add(const CurveCount& next) noexcept;
  /// Returns the number of bytes that the curves of `size` elements take, as NormalCurves::bytes() counts them.
  [[nodiscard]] std::size_t bytes(std::size_t size) const noexcept;
};

/// The number of faces that are counted together. Each counted range must begin at a multiple of this number.
inline constexpr std::size_t kCountedTogether = 512;

/// Counts the sizes of the curves of some faces, for the default tolerance of NormalCurves. Also writes the control
/// normals of these faces and their longest edges, sixteen faces to an element of `exact`. Preconditions: faces.first
/// is a multiple of kCountedTogether; faces.end() is such a multiple, too, or the end of all faces, unless there are no
/// faces; exact has ceil(faces.count / 16) elements.
[[nodiscard]] CurveCount count_curves(const Segment& segment, IndexRange faces, std::span<EdgedTile> exact);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CURVES_CURVE_COUNT_H_
