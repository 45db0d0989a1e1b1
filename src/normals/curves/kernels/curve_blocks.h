/// The layout of NormalCurves. Elements are in blocks of 16, each block is of one kind, and neighbouring blocks of one
/// kind form runs.
///
/// A block is a few planes of 16 numbers, with element i in lane i. c(k) are the control normals, M is the largest
/// absolute component of an element, and q is the integer that is stored. "int16 pairs" are 16 words of 32 bits. A word
/// has two numbers of 16 bits, the first in the low half.
///
///     kUnit           u.x u.y u.z                               float32, length 1
///     kUnitLength     u.x u.y u.z |n|                           float32
///     kLinear32       n0.x n0.y n0.z n1.x n1.y n1.z             float32
///     kQuadratic32    n0.x n0.y n0.z m.x ... n1.z               float32
///     kLinear16       (n0.x, n1.x) (n0.y, n1.y) (n0.z, n1.z)    int16 pairs: c = q M / 32767
///     kQuadratic16    (n0.x, n1.x) (n0.y, n1.y) (n0.z, n1.z)
///                     (m.x, m.y) (m.z, 0)                       int16 pairs: c = q M / 32767
///     kScaled16       as kQuadratic16, but each control normal has its own scale, and the 0 is replaced by three
///                     exponents of 5 bits, n0's in the lowest: c(k) = q 2^-e(k) M / 32767
///     kQuadratic11    16 words for x, for y, for z; from the lowest bit up: 5 low bits of m, 11 bits of n0, 5 high
///                     bits of m, 11 bits of n1; c = q M / 1023 for the ends, m = (32 high + low + 16) 2 M / 1023, with
///                     both halves signed, from -16 to 15
///     kNone           nothing: all elements are flagged (curve_data.h)
///
/// Pairs suit the instruction that multiplies two numbers by two weights and adds up the products (pmaddwd).
#ifndef CHRONORMAL_NORMALS_CURVES_KERNELS_CURVE_BLOCKS_H_
#define CHRONORMAL_NORMALS_CURVES_KERNELS_CURVE_BLOCKS_H_

#include <cstddef>
#include <cstdint>

#include "chronormal/motion/motion.h"
#include "normals/control/kernels/control_tile.h"

namespace chronormal::inline internal {

enum class BlockKind : int {
  kUnit,
  kUnitLength,
  kLinear16,
  kQuadratic11,
  kQuadratic16,
  kScaled16,
  kLinear32,
  kQuadratic32,
  kNone,
};

/// Returns the number of bytes per element of a block.
[[nodiscard]] constexpr std::size_t bytes_of(BlockKind kind) {
  constexpr std::size_t bytes[] = {12, 16, 12, 12, 20, 20, 24, 36, 0};
  return bytes[static_cast<int>(kind)];
}

/// The precision with which a block stores its elements, whatever their degree.
enum class Precision : std::uint8_t { k11, k16, kScaled16, k32 };

/// The degree of a block whose elements are all flagged.
inline constexpr int kNoDegree = -1;

/// Returns the kind of a block for elements of a degree. If with_lengths is true, blocks of degree 0 also store the
/// lengths of the normals.
[[nodiscard]] constexpr BlockKind kind_for(Precision precision, int degree, bool with_lengths) {
  if (degree == kNoDegree) return BlockKind::kNone;
  if (degree == 0) return with_lengths ? BlockKind::kUnitLength : BlockKind::kUnit;
  switch (precision) {
    case Precision::k11:
      return degree == 1 ? BlockKind::kLinear16 : BlockKind::kQuadratic11;
    case Precision::k16:
      return degree == 1 ? BlockKind::kLinear16 : BlockKind::kQuadratic16;
    case Precision::kScaled16:
      return BlockKind::kScaled16;
    case Precision::k32:
      break;
  }
  return degree == 1 ? BlockKind::kLinear32 : BlockKind::kQuadratic32;
}

// The range to which blocks are scaled. No component is above 2^50, and no n0 or n1 of an element in float32 is below
// 2^-52. |n(t)|^2 then stays in the range of float32, since the smallest |n(t)| is 2^-53 / 64.
inline constexpr int kLargestExponent = 50;
inline constexpr double kLargestComponent = 0x1p50;
inline constexpr double kSmallestEnd = 0x1p-52;

inline constexpr int kMaxScaleExponent = 31;

/// The weights that all elements share at one t, in the form that each kind of block needs.
struct CurveWeights {
  float linear[2];              ///< weights of n0 and n1 of a linear curve
  float quadratic[3];           ///< weights of n0, m and n1 of a quadratic
  std::int32_t linear16 = 0;    ///< int16 pair: weights of n0 and n1 of a linear curve, as multiples of a common unit
  std::int32_t ends16 = 0;      ///< int16 pair: weights of n0 and n1 of a quadratic, as multiples of a common unit
  std::int32_t middle16 = 0;    ///< weight of m of a quadratic, as a multiple of the unit of ends16
  std::int32_t middle_low = 0;  ///< weight of the low part of m in kQuadratic11: middle16 / 32, rounded

  /// Returns the weights at a time. If `compact` is false, the integer weights stay 0, which saves a tenth of a
  /// microsecond.
  [[nodiscard]] static CurveWeights at(const LocalTime& time, bool compact) noexcept;
};

/// An upper bound, for every t, of the sum of the absolute errors of the int16 weights divided by the sum of the
/// weights.
inline constexpr double kWeightError = 1.5 / 32767;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CURVES_KERNELS_CURVE_BLOCKS_H_
