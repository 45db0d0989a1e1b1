/// The kernel of NormalCurves, which computes unit normals from blocks of one kind.
#ifndef CHRONORMAL_NORMALS_CURVES_KERNELS_EVALUATE_H_
#define CHRONORMAL_NORMALS_CURVES_KERNELS_EVALUATE_H_

#include <cstddef>
#include <cstdint>

#include "core/memory.h"
#include "normals/curves/kernels/curve_blocks.h"
#include "normals/curves/kernels/prefetch.h"

namespace chronormal::inline internal {

/// Neighbouring blocks of one kind. The last block may be only partly filled.
struct BlockSpan {
  const std::byte* blocks = nullptr;
  BlockKind kind = BlockKind::kUnit;
  std::size_t elements = 0;
};

/// The way in which a kernel uses memory. PrefetchRule decides, by the working set, how early blocks are prefetched. If
/// `stream` is true, results bypass the caches; all arrays of results must then be aligned to 64 bytes.
struct MemoryAccess {
  WorkingSet working_set = WorkingSet::kSmall;
  bool stream = false;
};

/// Returns the way in which a pass should use memory if it reads `read` bytes and writes `written` bytes, and its
/// results are aligned.
constexpr MemoryAccess access_of_pass(std::size_t read, std::size_t written) noexcept {
  constexpr std::size_t kMiB = std::size_t{1} << 20;
  const std::size_t all = read + written;
  const WorkingSet set = all <= kMiB         ? WorkingSet::kSmall
                         : all <= 8 * kMiB   ? WorkingSet::kMedium
                         : read <= 40 * kMiB ? WorkingSet::kSharedCache
                                             : WorkingSet::kMemory;
  return {set, all > kStreamFrom};
}

/// The memory for the results of a span. The pointers point to the result of the first element of the span.
struct PackedResult {
  float* xyz;
  MemoryAccess access = {};
};
struct PlanesResult {
  float *x, *y, *z;
  MemoryAccess access = {};
};
struct OctahedralResult {
  std::uint32_t* bits;
  MemoryAccess access = {};
};
struct Rgb10A2Result {
  std::uint32_t* bits;
  MemoryAccess access = {};
};

/// Returns the memory for the results of the elements from `count` on.
inline PackedResult behind(const PackedResult& result, std::size_t count) {
  return {result.xyz + 3 * count, result.access};
}
inline PlanesResult behind(const PlanesResult& result, std::size_t count) {
  return {result.x + count, result.y + count, result.z + count, result.access};
}
inline OctahedralResult behind(const OctahedralResult& result, std::size_t count) {
  return {result.bits + count, result.access};
}
inline Rgb10A2Result behind(const Rgb10A2Result& result, std::size_t count) {
  return {result.bits + count, result.access};
}

/// Write the unit normals of all elements of a span, at the t for which the weights were made. Write nothing for kNone.
void evaluate_blocks(const BlockSpan& span, const CurveWeights& weights, PackedResult result) noexcept;
void evaluate_blocks(const BlockSpan& span, const CurveWeights& weights, PlanesResult result) noexcept;
void evaluate_blocks(const BlockSpan& span, const CurveWeights& weights, OctahedralResult result) noexcept;
void evaluate_blocks(const BlockSpan& span, const CurveWeights& weights, Rgb10A2Result result) noexcept;

/// Makes the results that this thread has streamed visible to other threads. Call this function once, after the last
/// span, since the call waits for the memory.
void flush_stream() noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CURVES_KERNELS_EVALUATE_H_
