// Evaluates Bernstein sums of degree 6. The seven products are added in pairs, so that each goes through at most three
// roundings.
#include "normals/curves/kernels/evaluate_path.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "normals/curves/kernels/evaluate_path.cpp"
#include <hwy/foreach_target.h>
// This header comes after highway.h, so that it is compiled for one instruction set at a time.
#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include "simd/intrinsics-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace chronormal::inline internal::HWY_NAMESPACE {

template <class Put>
HWY_INLINE void EvaluatePath(const float* blocks, std::size_t block_count, const PathWeights& weights, Put put) {
  const Floats w0 = hn::Set(kFloats, weights[0]), w1 = hn::Set(kFloats, weights[1]), w2 = hn::Set(kFloats, weights[2]),
               w3 = hn::Set(kFloats, weights[3]), w4 = hn::Set(kFloats, weights[4]), w5 = hn::Set(kFloats, weights[5]),
               w6 = hn::Set(kFloats, weights[6]);
  for (std::size_t b = 0; b < block_count; ++b) {
    // Measurements chose this distance: with a shorter one, or with prefetching left to the hardware, a pass over
    // memory takes a quarter longer.
    constexpr std::size_t kCacheLine = 16, kAhead = 6 * kPathBlock;  // floats
    for (std::size_t line = 0; line < kPathBlock; line += kCacheLine)
      hwy::Prefetch(blocks + b * kPathBlock + kAhead + line);
    for (std::size_t lane = 0; lane < kTile; lane += kLanes) {
      const float* const p = blocks + b * kPathBlock + lane;
      const auto term = [p](Floats w, std::size_t k) HWY_ATTR {
        const float* const c = p + 3 * k * kTile;
        return Lanes3{hn::Mul(w, hn::Load(kFloats, c)), hn::Mul(w, hn::Load(kFloats, c + kTile)),
                      hn::Mul(w, hn::Load(kFloats, c + 2 * kTile))};
      };
      const Lanes3 first = (term(w0, 0) + term(w1, 1)) + (term(w2, 2) + term(w3, 3));
      const Lanes3 last = (term(w4, 4) + term(w5, 5)) + term(w6, 6);
      put(Normalized(first + last), b * kTile + lane);
    }
  }
}

template <bool kStream>
HWY_INLINE void ToPacked(const float* blocks, std::size_t block_count, const PathWeights& weights, float* xyz) {
  EvaluatePath(blocks, block_count, weights,
               [xyz](const Lanes3& u, std::size_t i) HWY_ATTR { StorePacked<kStream>(u, xyz + 3 * i); });
}

void EvaluatePathPacked(const float* blocks, std::size_t block_count, const PathWeights& weights, PackedResult result) {
  if (result.access.stream)
    ToPacked<true>(blocks, block_count, weights, result.xyz);
  else
    ToPacked<false>(blocks, block_count, weights, result.xyz);
}

template <bool kStream>
HWY_INLINE void ToPlanes(const float* blocks, std::size_t block_count, const PathWeights& weights,
                         const PlanesResult& result) {
  EvaluatePath(blocks, block_count, weights,
               [x = result.x, y = result.y, z = result.z](const Lanes3& u, std::size_t i) HWY_ATTR {
                 StoreOne<kStream>(u.x, x + i);
                 StoreOne<kStream>(u.y, y + i);
                 StoreOne<kStream>(u.z, z + i);
               });
}

void EvaluatePathPlanes(const float* blocks, std::size_t block_count, const PathWeights& weights, PlanesResult result) {
  if (result.access.stream)
    ToPlanes<true>(blocks, block_count, weights, result);
  else
    ToPlanes<false>(blocks, block_count, weights, result);
}

}  // namespace chronormal::inline internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace chronormal::inline internal {

HWY_EXPORT(EvaluatePathPacked);
HWY_EXPORT(EvaluatePathPlanes);

void evaluate_path_blocks(const float* blocks, std::size_t block_count, const PathWeights& weights,
                          PackedResult result) noexcept {
  HWY_DYNAMIC_DISPATCH(EvaluatePathPacked)(blocks, block_count, weights, result);
}

void evaluate_path_blocks(const float* blocks, std::size_t block_count, const PathWeights& weights,
                          PlanesResult result) noexcept {
  HWY_DYNAMIC_DISPATCH(EvaluatePathPlanes)(blocks, block_count, weights, result);
}

}  // namespace chronormal::inline internal
#endif  // HWY_ONCE
