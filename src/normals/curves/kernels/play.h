/// The kernel of NormalPlayback: forward differences, block by block.
#ifndef CHRONORMAL_NORMALS_CURVES_KERNELS_PLAY_H_
#define CHRONORMAL_NORMALS_CURVES_KERNELS_PLAY_H_

#include <cstddef>

#include "normals/curves/kernels/evaluate.h"

namespace chronormal::inline internal {

/// The state of 16 elements that are played: as many vectors as the degree and one, n first, then its differences, each
/// as 16 x, 16 y, 16 z. Writes the unit normals of n and moves the state on by a step.
/// degree is 1 or 2; state must be aligned to 64 bytes; results are for whole blocks
void play_blocks(float* state, std::size_t block_count, int degree, PackedResult result) noexcept;
void play_blocks(float* state, std::size_t block_count, int degree, PlanesResult result) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CURVES_KERNELS_PLAY_H_
