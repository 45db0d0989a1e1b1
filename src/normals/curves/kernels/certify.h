/// The proofs of certificate.h for sixteen elements at a time: what those get that a glance in float32 does not settle.
#ifndef CHRONORMAL_NORMALS_CURVES_KERNELS_CERTIFY_H_
#define CHRONORMAL_NORMALS_CURVES_KERNELS_CERTIFY_H_

#include <cstddef>
#include <cstdint>

#include "normals/control/kernels/exact_tile.h"
#include "normals/curves/kernels/curve_blocks.h"
#include "normals/curves/kernels/flagged_normals.h"
#include "normals/curves/kernels/pack.h"

namespace chronormal::inline internal {

/// What is known of the elements of a tile that were asked for. Bit i of each set stands for element i.
struct TileCertificates {
  FlaggedTile scaled;             ///< the flagged ones, as FlaggedNormals; other lanes have anything
  std::int16_t exponents[kTile];  ///< of the flagged ones, as FlaggedNormals has one
  std::uint32_t known = 0;  ///< the others must be examined one by one: they are huge, tiny, or hardly more than noise
  std::uint32_t flagged = 0;             ///< of the known ones: float32 cannot carry them
  std::uint32_t needs_exact = 0;         ///< of the flagged ones: double cannot carry them at every t
  Precision precision = Precision::k11;  ///< that suffices for all others that are known

  /// Knows nothing more.
  void clear() noexcept {
    known = flagged = needs_exact = 0;
    precision = Precision::k11;
  }
};

/// Decides as precision_for(), smallest_certain() and stays_certain() do. `asked` are the elements in question, as bits.
void certify_tile(const BoundedTile& tile, const PrecisionLimits& limits, std::uint32_t asked,
                  TileCertificates& result) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CURVES_KERNELS_CERTIFY_H_
