/// The data of NormalCurves. Elements are in blocks of 16, and neighbouring blocks of one kind form runs. Elements for
/// which float32 does not suffice are stored separately.
///
///     build_curves (curve_builder.h) --CurveData--> NormalCurves, MeshNormals
#ifndef CHRONORMAL_NORMALS_CURVES_CURVE_DATA_H_
#define CHRONORMAL_NORMALS_CURVES_CURVE_DATA_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "chronormal/core/views.h"
#include "chronormal/normals/control_normals.h"
#include "core/memory.h"
#include "normals/curves/flagged_elements.h"
#include "normals/curves/kernels/curve_blocks.h"

namespace chronormal::inline internal {

struct CurveData {
  /// A run of neighbouring blocks of one kind.
  struct Run {
    std::size_t first_block = 0;
    std::size_t block_count = 0;
    std::size_t offset = 0;  ///< place in `blocks` at which the first block begins, in bytes
    BlockKind kind = BlockKind::kUnit;

    /// Returns the elements of the run. `count` is the number of elements of all curves, which may end within the last
    /// block.
    [[nodiscard]] IndexRange elements(std::size_t count) const noexcept {
      const std::size_t first = first_block * kTile, end = first + block_count * kTile;
      return {first, (end < count ? end : count) - first};
    }
  };

  std::size_t size = 0;
  bool keeps_lengths = true;
  std::array<std::size_t, 3> degree_counts{};
  AlignedBytes blocks;
  std::vector<Run> runs;
  /// Block b has the control normals of its elements times 2^-exponents[b]. The list is empty if all exponents are 0.
  std::vector<std::int16_t> exponents;
  FlaggedElements flagged;  ///< the elements that are evaluated in double
  /// A flagged element for which double does not suffice at every t. The list `exact` is in ascending order of
  /// `element`. `digits` is the place in exact_digits at which the ExactCurve of the element begins.
  struct ExactElement {
    std::size_t element = 0;
    std::size_t digits = 0;
  };
  std::vector<ExactElement> exact;
  std::vector<std::int32_t> exact_digits;
  AlignedArray<float> scratch;  ///< memory for preparing curves, kept for the next segment

  /// Removes all elements, but keeps their memory.
  void clear() noexcept {
    size = 0;
    degree_counts = {};
    blocks.resize(0);
    runs.clear();
    exponents.clear();
    flagged.clear();
    exact.clear();
    exact_digits.clear();
  }
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CURVES_CURVE_DATA_H_
