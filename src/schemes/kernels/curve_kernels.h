/// The formulas of schemes over blocks of elements, on the widest instruction set that the machine has, with the same
/// bits on all of them. formulas-inl.h describes what each formula computes, and from which planes.
///
/// An element is kept as one float per plane. Thirty-two elements make a block, and blocks lie one after the other:
///
///     plane 0 of elements 0 to 31, plane 1 of these elements, ..., their last plane, plane 0 of elements 32 to 63,
///     ...
///
/// so that an evaluation is one pass over memory. The last block is filled up with zeros, which every formula accepts.
#ifndef CHRONORMAL_SCHEMES_KERNELS_CURVE_KERNELS_H_
#define CHRONORMAL_SCHEMES_KERNELS_CURVE_KERNELS_H_

#include <array>
#include <cstddef>
#include <span>

#include "chronormal/core/views.h"
#include "chronormal/schemes/scheme.h"
#include "core/memory.h"

namespace chronormal::inline internal {

inline constexpr std::size_t kBlock = 32;

inline constexpr std::size_t kMaxLagrangeDegree = 64;      // the weights at equidistant nodes grow as 2^degree
inline constexpr std::size_t kMaxDeCasteljauNormals = 32;  // K (K - 1) / 2 slerps an evaluation

/// The values that all elements have in common at one t: t itself, or weights. The formula determines their meaning,
/// and how many of them count.
using SharedValues = std::array<float, kMaxLagrangeDegree + 1>;

enum class Formula {
  kSumOf2,
  kSumOf3,
  kSumOf4,
  kSum,
  kRational,
  kGreatArc,
  kCircleArc,
  kTimedCircleArc,
  kDeCasteljau,
};

/// Returns true if a formula adds up vectors by weights that all elements share.
[[nodiscard]] constexpr bool is_sum(Formula f) noexcept {
  return f == Formula::kSum || f == Formula::kSumOf2 || f == Formula::kSumOf3 || f == Formula::kSumOf4;
}

/// Returns the values that a formula other than a sum needs at one t: t itself, or the Bernstein weights of a quadratic
/// and of its square.
[[nodiscard]] SharedValues shared_values(Formula formula, double t) noexcept;

/// A reference to coefficients in blocks, aligned to 64 bytes, in memory of the caller.
struct CoefficientBlocks {
  const float* values = nullptr;
  std::size_t plane_count = 0;
  std::size_t element_count = 0;
};

/// Writes the unit normals of all elements at one t. core/memory.h explains stream_from. result must have as many
/// vectors as there are elements, and may have any layout
void evaluate_curves(Formula formula, const CoefficientBlocks& curves, const SharedValues& shared,
                     VectorView<float> result, std::size_t stream_from = kStreamFrom) noexcept;

/// Writes the unit normals of a state that is being played, and advances the state by a step. The state is stored in
/// blocks like the coefficients. The formula must be a sum of 2, 3 or 4, or an arc at uniform speed
void advance_curves(Formula formula, const CoefficientBlocks& curves, float* state, VectorView<float> result) noexcept;

/// Return the number of operations for one element with these coefficients. These functions run the same code as an
/// evaluation, instantiated with a scalar that counts.
[[nodiscard]] OperationCounts count_evaluation(Formula formula, std::span<const float> coefficients,
                                               const SharedValues& shared);
[[nodiscard]] OperationCounts count_advance(Formula formula, std::span<const float> coefficients,
                                            std::span<const float> state);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_SCHEMES_KERNELS_CURVE_KERNELS_H_
