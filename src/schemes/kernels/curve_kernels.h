/// Evaluates the formulas of schemes over blocks of elements, on the widest instruction set that the machine has. The
/// bits are the same on all instruction sets. formulas-inl.h describes what each formula computes, and from which
/// planes.
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

// A larger degree of the scheme lagrange is useless, since the weights at equidistant nodes grow like 2^degree.
inline constexpr std::size_t kMaxLagrangeDegree = 64;
inline constexpr std::size_t kMaxDeCasteljauNormals = 32;  // an evaluation with K normals takes K (K - 1) / 2 slerps

/// The values that all elements have in common at one t: t itself, or weights. The formula determines what they mean,
/// and how many of them it uses.
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

/// Returns the values that a formula other than a sum needs at one t. The values are t itself, or the Bernstein weights
/// of a quadratic and of its square.
[[nodiscard]] SharedValues shared_values(Formula formula, double t) noexcept;

/// A reference to coefficients in blocks. The memory belongs to the caller and is aligned to 64 bytes.
struct CoefficientBlocks {
  const float* values = nullptr;
  std::size_t plane_count = 0;
  std::size_t element_count = 0;
};

/// Writes the unit normals of all elements at one t. If more than stream_from bytes are read and written, results
/// bypass the caches (core/memory.h). Precondition: result has as many vectors as there are elements; it may have any
/// layout.
void evaluate_curves(Formula formula, const CoefficientBlocks& curves, const SharedValues& shared,
                     VectorView<float> result, std::size_t stream_from = kStreamFrom) noexcept;

/// Writes the unit normals of a state that is being played, and advances the state by one step. The state is stored in
/// blocks like the coefficients. Precondition: the formula is a sum of 2, 3 or 4 vectors, or an arc at uniform speed.
void advance_curves(Formula formula, const CoefficientBlocks& curves, float* state, VectorView<float> result) noexcept;

/// Return the number of operations for one element with the given coefficients. The functions run the same code as an
/// evaluation, with a scalar that counts.
[[nodiscard]] OperationCounts count_evaluation(Formula formula, std::span<const float> coefficients,
                                               const SharedValues& shared);
[[nodiscard]] OperationCounts count_advance(Formula formula, std::span<const float> coefficients,
                                            std::span<const float> state);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_SCHEMES_KERNELS_CURVE_KERNELS_H_
