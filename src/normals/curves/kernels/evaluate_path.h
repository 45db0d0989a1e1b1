/// The kernel of PathCurves, which turns seven control normals in float32 into unit normals.
#ifndef CHRONORMAL_NORMALS_CURVES_KERNELS_EVALUATE_PATH_H_
#define CHRONORMAL_NORMALS_CURVES_KERNELS_EVALUATE_PATH_H_

#include <array>
#include <cstddef>

#include "normals/curves/kernels/evaluate.h"

namespace chronormal::inline internal {

inline constexpr std::size_t kPathControls = 7;
/// The floats of a block of 16 elements: 16 x, 16 y, 16 z of each control normal in turn.
inline constexpr std::size_t kPathBlock = kPathControls * 3 * kTile;

using PathWeights = std::array<float, kPathControls>;

/// Writes the unit normals of whole blocks. Blocks must be aligned to 64 bytes, and no n(t) may be shorter than 2^-60.
void evaluate_path_blocks(const float* blocks, std::size_t block_count, const PathWeights& weights,
                          PackedResult result) noexcept;
void evaluate_path_blocks(const float* blocks, std::size_t block_count, const PathWeights& weights,
                          PlanesResult result) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CURVES_KERNELS_EVALUATE_PATH_H_
