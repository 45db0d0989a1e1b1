/// Packs control normals into blocks. Finds the precision that the elements of a tile need, and writes a block of a
/// given kind.
#ifndef CHRONORMAL_NORMALS_CURVES_KERNELS_PACK_H_
#define CHRONORMAL_NORMALS_CURVES_KERNELS_PACK_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "normals/control/kernels/control_tile.h"
#include "normals/curves/kernels/curve_blocks.h"

namespace chronormal::inline internal {

/// The limits, for each precision, of how short n(t) may become if blocks are to keep a tolerance (docs/theory.md,
/// section 13). If a precision cannot keep the tolerance at all, its limit is 0.
struct PrecisionLimits {
  /// The largest M / |n(t)| for k11 and k16, where M is the largest absolute component of the control normals.
  double largest_ratio11 = 0, largest_ratio16 = 0;
  /// The largest sum w_k |c_k| / |n(t)| for kScaled16 and k32.
  double sum_ratio_scaled16 = 0, sum_ratio32 = 0;

  /// The largest `magnitude` / |n(t)|, where `magnitude` is at least the largest component. In tiles that were computed
  /// in double, rounding errors are below 2^-45 of the magnitude (12 u for a face, and u for each of up to 100 faces
  /// that are added, where u = 2^-53). With this limit, rounding errors turn n(t) by less than 2^-24 rad, and no
  /// control normal is below 2^-21 of the largest.
  double largest_magnitude = 0x1p21;

  /// The largest tolerance in radians. For larger tolerances, the difference between a chord and its angle would
  /// matter.
  static constexpr double kLargestTolerance = 0.2;
  [[nodiscard]] static PrecisionLimits for_tolerance(double radians) noexcept;
  /// Returns the limits for tiles that were computed in float32, where `magnitude` bounds the error of a component.
  /// This error may use up a small part of the tolerance; the rest is for the blocks. Returns no value if the
  /// tolerance, in radians, is too small for float32.
  [[nodiscard]] static std::optional<PrecisionLimits> for_float_tiles(double radians) noexcept;
};

/// The result of the quick test of a tile, in which float32 looks at all elements.
struct TileSummary {
  /// Bit i is set if the quick test could not settle element i, so that double must examine it.
  std::uint32_t uncertain = 0;
  std::uint32_t moving = 0;              ///< bit i is set if element i has degree 1 or 2
  std::uint32_t bending = 0;             ///< bit i is set if element i has degree 2
  Precision precision = Precision::k11;  ///< a precision that suffices for all elements that are not uncertain

  void set_degree(std::size_t lane, int degree) noexcept {
    const std::uint32_t bit = 1u << lane;
    moving = degree > 0 ? moving | bit : moving & ~bit;
    bending = degree > 1 ? bending | bit : bending & ~bit;
  }
};

/// Tests the elements of tiles with a few operations in float32. An element passes if all three control normals are
/// within about 70 degrees of n0 + 2 m + n1, or if eq. 11 of docs/theory.md holds for the curve, its halves or its
/// quarters. The element must also be well above the rounding errors of its products and within the range of float32.
/// Elements that do not pass are uncertain.
void summarize_tiles(std::span<const ControlTile> tiles, const PrecisionLimits& limits,
                     std::span<TileSummary> summaries) noexcept;

/// Writes one block of 16 elements for each tile. Preconditions: all numbers in the tiles are finite, and for kinds of
/// int16 no element is zero. blocks has 16 * bytes_of(kind) bytes for each tile, aligned to 64 bytes.
void pack_tiles(std::span<const ControlTile> tiles, BlockKind kind, std::byte* blocks) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CURVES_KERNELS_PACK_H_
