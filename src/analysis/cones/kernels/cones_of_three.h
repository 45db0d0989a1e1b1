/// The kernel of normal cones. Finds the smallest circular cone around three vectors, for many elements at a time.
#ifndef CHRONORMAL_ANALYSIS_CONES_KERNELS_CONES_OF_THREE_H_
#define CHRONORMAL_ANALYSIS_CONES_KERNELS_CONES_OF_THREE_H_

#include <cstddef>
#include <cstdint>

#include "chronormal/analysis/cones.h"
#include "chronormal/normals/control_normals.h"

namespace chronormal::inline internal {

/// The largest relative error of a control normal, measured by its largest component or by its length. An error of
/// 2^-26 in each component is at most sqrt(3) / 2 of this number; the rest is for rounding.
inline constexpr double kNormalShare = 0x1p-25;

/// The largest relative error of a restricted control normal for which float32 finds the cone. An element with a larger
/// error is flagged.
inline constexpr double kLargestUnknown = 0x1p-10;

/// The largest error that underflow causes in products of tiny control normals.
inline constexpr double kUnderflow = 0x1p-1060;

/// The weights that restrict control normals to the part [t0, t1] of a segment. The control normals of the part are
/// convex combinations of those of the whole segment: row k has the weights of n0, m and n1. The error of each weight
/// is at most 5 roundings.
struct Restriction {
  double weights[3][3];

  [[nodiscard]] static Restriction to(double t0, double t1) noexcept {
    const double s0 = 1 - t0, s1 = 1 - t1;
    return {{{s0 * s0, 2 * t0 * s0, t0 * t0}, {s0 * s1, s0 * t1 + t0 * s1, t0 * t1}, {s1 * s1, 2 * t1 * s1, t1 * t1}}};
  }
};

/// The number of elements whose flags share one number, with one bit for each element.
inline constexpr std::size_t kConesPerFlags = 16;

/// Writes the cone around the three control normals of each element. The error of each vector is at most `share` times
/// its length. Flags the elements with a vector that is zero, not finite, or below 2^-1022 or above 2^1023 in size; the
/// cones of these elements have no meaning. Bit i of flags[b] is the flag of element 16 b + i. Precondition: `result`
/// has room for `count` cones, and `flags` for one number per 16 elements, rounded up.
void cones_of_three(const ControlNormals* normals, std::size_t count, double share, NormalCone* result,
                    std::uint16_t* flags) noexcept;

/// Writes the cones of parts of segments like cones_of_three(). Also flags elements with a restricted control normal
/// whose relative error is above kLargestUnknown.
void cones_of_parts(const ControlNormals* normals, std::size_t count, const Restriction& part, NormalCone* result,
                    std::uint16_t* flags) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_CONES_KERNELS_CONES_OF_THREE_H_
