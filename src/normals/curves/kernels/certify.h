/// Does the proofs of certificate.h for sixteen elements at a time. The proofs are for elements that the quick test in
/// float32 did not settle.
#ifndef CHRONORMAL_NORMALS_CURVES_KERNELS_CERTIFY_H_
#define CHRONORMAL_NORMALS_CURVES_KERNELS_CERTIFY_H_

#include <cstddef>
#include <cstdint>

#include "normals/control/kernels/exact_tile.h"
#include "normals/curves/kernels/curve_blocks.h"
#include "normals/curves/kernels/flagged_normals.h"
#include "normals/curves/kernels/pack.h"

namespace chronormal::inline internal {

/// The results for those elements of a tile that certify_tile() was asked to examine. Each number is a set of elements,
/// in which bit i is element i.
struct TileCertificates {
  /// The control normals of the flagged elements, as in FlaggedNormals. The lanes of all other elements have no
  /// meaning.
  FlaggedTile scaled;
  std::int16_t exponents[kTile];  ///< exponents of the flagged elements, as in FlaggedNormals
  std::uint32_t known = 0;        ///< elements that were decided; the others are huge, tiny, or mostly noise
  std::uint32_t flagged = 0;      ///< known elements for which float32 does not suffice
  std::uint32_t needs_exact = 0;  ///< flagged elements for which double does not suffice at every t
  /// The lowest precision that suffices for all known elements that are not flagged.
  Precision precision = Precision::k11;

  void clear() noexcept {
    known = flagged = needs_exact = 0;
    precision = Precision::k11;
  }
};

/// Decides for some elements what precision_for(), smallest_certain() and stays_certain() would decide. The elements
/// are those whose bits are set in `asked`.
void certify_tile(const BoundedTile& tile, const PrecisionLimits& limits, std::uint32_t asked,
                  TileCertificates& result) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CURVES_KERNELS_CERTIFY_H_
