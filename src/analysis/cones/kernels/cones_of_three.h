/// The kernel of normal cones: the smallest circular cone around three vectors, many elements at a time.
#ifndef CHRONORMAL_ANALYSIS_CONES_KERNELS_CONES_OF_THREE_H_
#define CHRONORMAL_ANALYSIS_CONES_KERNELS_CONES_OF_THREE_H_

#include <cstddef>
#include <cstdint>

#include "chronormal/analysis/cones.h"
#include "chronormal/normals/control_normals.h"

namespace chronormal::inline internal {

/// How far a control normal may be off, in any norm between its largest component and its length: 2^-26 in each
/// component is sqrt(3) / 2 of this, and the rest is for rounding.
inline constexpr double kNormalShare = 0x1p-25;

/// The largest share of a restricted control normal that may be unknown; beyond it the element is flagged.
inline constexpr double kLargestUnknown = 0x1p-10;

/// For underflow: what products of tiny control normals may lose.
inline constexpr double kUnderflow = 0x1p-1060;

/// The control normals of the part [t0, t1] of a segment, as convex combinations of those of the whole: row k has the
/// weights of n0, m and n1. Each is within 5 rounding errors of itself.
struct Restriction {
  double weights[3][3];

  [[nodiscard]] static Restriction to(double t0, double t1) noexcept {
    const double s0 = 1 - t0, s1 = 1 - t1;
    return {{{s0 * s0, 2 * t0 * s0, t0 * t0}, {s0 * s1, s0 * t1 + t0 * s1, t0 * t1}, {s1 * s1, 2 * t1 * s1, t1 * t1}}};
  }
};

/// How many elements share a number of flags.
inline constexpr std::size_t kConesPerFlags = 16;

/// Writes the cone around the three vectors of each element, of which each is within `share` of its length, and flags
/// those of which a vector is zero, not finite, or below 2^-1022 or above 2^1023: their cones mean nothing. Bit i of
/// flags[b] is element 16 b + i.
/// result must have room for `count` cones, flags for a number for every 16 begun
void cones_of_three(const ControlNormals* normals, std::size_t count, double share, NormalCone* result,
                    std::uint16_t* flags) noexcept;

/// The same for parts of segments; also flags elements of which a restricted control normal is unknown by more than
/// kLargestUnknown.
void cones_of_parts(const ControlNormals* normals, std::size_t count, const Restriction& part, NormalCone* result,
                    std::uint16_t* flags) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_CONES_KERNELS_CONES_OF_THREE_H_
