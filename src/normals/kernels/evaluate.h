/// The kernel of NormalCurves: blocks of one kind to unit normals.
#ifndef CHRONORMAL_NORMALS_KERNELS_EVALUATE_H_
#define CHRONORMAL_NORMALS_KERNELS_EVALUATE_H_

#include <cstddef>
#include <cstdint>

#include "normals/kernels/curve_blocks.h"

namespace chronormal {

/// Neighbouring blocks of one kind, the last of which may be filled in part.
struct BlockSpan {
  const std::byte* blocks = nullptr;
  BlockKind kind = BlockKind::kUnit;
  std::size_t elements = 0;
};

/// Where the results of a span go: pointers to that of its first element. With `stream` past the caches, for results
/// that are larger than these: then packed and octahedral results must be aligned to 64 bytes.
struct PackedResult {
  float* xyz;
  bool stream;
};
struct PlanesResult {
  float *x, *y, *z;
};
struct OctahedralResult {
  std::uint32_t* bits;
  bool stream;
};
struct Rgb10A2Result {
  std::uint32_t* bits;
};

/// Writes the unit normals of all elements of a span, at the t of the weights.
void evaluate_blocks(const BlockSpan& span, const CurveWeights& weights, PackedResult result) noexcept;
void evaluate_blocks(const BlockSpan& span, const CurveWeights& weights, PlanesResult result) noexcept;
void evaluate_blocks(const BlockSpan& span, const CurveWeights& weights, OctahedralResult result) noexcept;
void evaluate_blocks(const BlockSpan& span, const CurveWeights& weights, Rgb10A2Result result) noexcept;

/// Makes what this thread has streamed visible to the others: once, after the last span, for it waits for the memory.
void flush_stream() noexcept;

}  // namespace chronormal

#endif  // CHRONORMAL_NORMALS_KERNELS_EVALUATE_H_
