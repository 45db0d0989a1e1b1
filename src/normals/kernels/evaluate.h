/// The kernel of NormalCurves: blocks of one kind to unit normals.
#ifndef CHRONORMAL_NORMALS_KERNELS_EVALUATE_H_
#define CHRONORMAL_NORMALS_KERNELS_EVALUATE_H_

#include <cstddef>
#include <cstdint>

#include "chronormal/core/memory.h"
#include "normals/kernels/curve_blocks.h"

namespace chronormal {

/// Neighbouring blocks of one kind, the last of which may be filled in part.
struct BlockSpan {
  const std::byte* blocks = nullptr;
  BlockKind kind = BlockKind::kUnit;
  std::size_t elements = 0;
};

/// Where the bytes of a whole pass are, and so how a kernel goes about them; measured where a core has 1 MiB of its own
/// and 32 MiB are shared.
///
///     kCaches   results stay in the caches; blocks are asked for 2 KiB ahead
///     kShared   results go past the caches; blocks 16 KiB ahead, which is up to 1.2 times as fast there as 8
///     kMemory   results go past the caches; blocks 8 KiB ahead
enum class Reach { kCaches, kShared, kMemory };

/// For a pass over so many bytes of blocks that writes so many bytes.
constexpr Reach reach_of(std::size_t read, std::size_t written) noexcept {
  constexpr std::size_t kLargestShared = std::size_t{40} << 20;
  if (read + written <= kStreamFrom) return Reach::kCaches;
  return read <= kLargestShared ? Reach::kShared : Reach::kMemory;
}

/// Where the results of a span go: pointers to that of its first element, aligned to 64 bytes but in kCaches.
struct PackedResult {
  float* xyz;
  Reach reach;
};
struct PlanesResult {
  float *x, *y, *z;
  Reach reach;
};
struct OctahedralResult {
  std::uint32_t* bits;
  Reach reach;
};
struct Rgb10A2Result {
  std::uint32_t* bits;
  Reach reach;
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
