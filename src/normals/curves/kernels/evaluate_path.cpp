// A Bernstein sum of degree 6. Its seven products are added in pairs: no path from a product to the sum has more than three
// roundings.
#include "normals/curves/kernels/evaluate_path.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "normals/curves/kernels/evaluate_path.cpp"
#include <hwy/foreach_target.h>
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

void EvaluatePathPacked(const float* blocks, std::size_t block_count, const PathWeights& weights, PackedResult result) {
  EvaluatePath(blocks, block_count, weights,
               [result](const Lanes3& u, std::size_t i) HWY_ATTR { StorePacked<false>(u, result.xyz + 3 * i); });
}

void EvaluatePathPlanes(const float* blocks, std::size_t block_count, const PathWeights& weights, PlanesResult result) {
  EvaluatePath(blocks, block_count, weights, [result](const Lanes3& u, std::size_t i) HWY_ATTR {
    hn::StoreU(u.x, kFloats, result.x + i);
    hn::StoreU(u.y, kFloats, result.y + i);
    hn::StoreU(u.z, kFloats, result.z + i);
  });
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
