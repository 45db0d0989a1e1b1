/// Packs control normals into blocks: finds the precision that a tile needs, and writes the block of a kind.
#ifndef CHRONORMAL_NORMALS_CURVES_KERNELS_PACK_H_
#define CHRONORMAL_NORMALS_CURVES_KERNELS_PACK_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "normals/control/kernels/control_tile.h"
#include "normals/curves/kernels/curve_blocks.h"

namespace chronormal::inline internal {

/// The limits, for each precision, of how short n(t) may get if the blocks are to keep a tolerance (docs/theory.md,
/// section 13). A precision that cannot keep the tolerance at all has a limit of 0.
struct PrecisionLimits {
  /// The limits of M / |n(t)| for k11 and k16, where M is the largest absolute component of the control normals.
  double largest_ratio11 = 0, largest_ratio16 = 0;
  /// The limits of sum w_k |c_k| / |n(t)| for kScaled16 and k32.
  double sum_ratio_scaled16 = 0, sum_ratio32 = 0;

  /// The limit of `magnitude` / |n(t)|, where `magnitude` is at least the largest component. In tiles that were
  /// computed in double, noise is below 2^-45 of the magnitude (12 u for a face, and u for each of up to 100 faces that
  /// are added). So noise turns n(t) by less than 2^-24, and no control normal is below 2^-21 of the largest.
  double largest_magnitude = 0x1p21;

  /// The largest tolerance in radians. Above it, the difference between a chord and its angle would matter.
  static constexpr double kLargestTolerance = 0.2;
  [[nodiscard]] static PrecisionLimits for_tolerance(double radians) noexcept;
  /// Returns the limits for tiles that were computed in float32, where `magnitude` is a bound on the error of a
  /// component. That error may take a small part of the tolerance, and the blocks get the rest. Returns nothing if the
  /// tolerance is too small for float32.
  [[nodiscard]] static std::optional<PrecisionLimits> for_float_tiles(double radians) noexcept;
};

/// The result of the quick test of a tile.
struct TileSummary {
  std::uint32_t uncertain = 0;           ///< bit i is set if element i must be examined in double
  std::uint32_t moving = 0;              ///< bit i is set if element i has degree 1 or 2
  std::uint32_t bending = 0;             ///< bit i is set if element i has degree 2
  Precision precision = Precision::k11;  ///< a precision that suffices for all other elements

  void set_degree(std::size_t lane, int degree) noexcept {
    const std::uint32_t bit = 1u << lane;
    moving = degree > 0 ? moving | bit : moving & ~bit;
    bending = degree > 1 ? bending | bit : bending & ~bit;
  }
};

/// Finds the elements for which some operations in float32 show that they stay long enough: all three control normals
/// are within about 70 degrees of n0 + 2 m + n1, or eq. 11 holds for the curve, its halves or its quarters. The
/// elements must also be well above the noise of their products and within the range of float32.
void summarize_tiles(std::span<const ControlTile> tiles, const PrecisionLimits& limits,
                     std::span<TileSummary> summaries) noexcept;

/// Writes one block of 16 elements for each tile. The tiles must be finite; for kinds of int16 no element may be zero.
/// blocks must have 16 * bytes_of(kind) bytes for each tile, aligned to 64
void pack_tiles(std::span<const ControlTile> tiles, BlockKind kind, std::byte* blocks) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CURVES_KERNELS_PACK_H_
