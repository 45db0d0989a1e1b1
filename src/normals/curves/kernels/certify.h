/// The proofs of certificate.h for sixteen elements at a time, for elements that the quick test in float32 did not
/// settle.
#ifndef CHRONORMAL_NORMALS_CURVES_KERNELS_CERTIFY_H_
#define CHRONORMAL_NORMALS_CURVES_KERNELS_CERTIFY_H_

#include <cstddef>
#include <cstdint>

#include "normals/control/kernels/exact_tile.h"
#include "normals/curves/kernels/curve_blocks.h"
#include "normals/curves/kernels/flagged_normals.h"
#include "normals/curves/kernels/pack.h"

namespace chronormal::inline internal {

/// The knowledge about the requested elements of a tile. Bit i of each set stands for element i.
struct TileCertificates {
  FlaggedTile scaled;                    ///< the flagged elements, as in FlaggedNormals; other lanes hold anything
  std::int16_t exponents[kTile];         ///< exponents of the flagged elements, as in FlaggedNormals
  std::uint32_t known = 0;               ///< decided elements; the others are huge, tiny, or mostly noise
  std::uint32_t flagged = 0;             ///< the known elements for which float32 does not suffice
  std::uint32_t needs_exact = 0;         ///< the flagged elements for which double does not suffice at every t
  Precision precision = Precision::k11;  ///< the precision of all known elements that are not flagged

  /// Forgets all knowledge about the elements.
  void clear() noexcept {
    known = flagged = needs_exact = 0;
    precision = Precision::k11;
  }
};

/// Decides as precision_for(), smallest_certain() and stays_certain() do. The bits of `asked` are the elements in
/// question.
void certify_tile(const BoundedTile& tile, const PrecisionLimits& limits, std::uint32_t asked,
                  TileCertificates& result) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CURVES_KERNELS_CERTIFY_H_
