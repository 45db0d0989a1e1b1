// Evaluates Bernstein sums of degree 6. The seven products are added in pairs, so that each goes through at most three
// roundings.
#include "normals/curves/kernels/evaluate_path.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "normals/curves/kernels/evaluate_path.cpp"
#include "simd/foreach_target-inl.h"
// This header comes after highway.h, so that it is compiled for one instruction set at a time.
#include "simd/highway-inl.h"

#include "simd/intrinsics-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace chronormal::inline internal::HWY_NAMESPACE {

template <class Put>
HWY_INLINE void EvaluatePath(const float* blocks, std::size_t block_count, const PathWeights& weights,
                             std::size_t ahead, Put put) {
  const Floats w0 = hn::Set(kFloats, weights[0]), w1 = hn::Set(kFloats, weights[1]), w2 = hn::Set(kFloats, weights[2]),
               w3 = hn::Set(kFloats, weights[3]), w4 = hn::Set(kFloats, weights[4]), w5 = hn::Set(kFloats, weights[5]),
               w6 = hn::Set(kFloats, weights[6]);
  for (std::size_t b = 0; b < block_count; ++b) {
    constexpr std::size_t kCacheLine = 16;  // floats
    if (ahead > 0)
      for (std::size_t line = 0; line < kPathBlock; line += kCacheLine)
        hwy::Prefetch(blocks + b * kPathBlock + ahead / sizeof(float) + line);
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
HWY_INLINE void ToPacked(const float* blocks, std::size_t block_count, const PathWeights& weights, std::size_t ahead,
                         float* xyz) {
  EvaluatePath(blocks, block_count, weights, ahead,
               [xyz](const Lanes3& u, std::size_t i) HWY_ATTR { StorePacked<kStream>(u, xyz + 3 * i); });
}

void EvaluatePathPacked(const float* blocks, std::size_t block_count, const PathWeights& weights, PackedResult result,
                        std::size_t ahead) {
  if (result.access.stream)
    ToPacked<true>(blocks, block_count, weights, ahead, result.xyz);
  else
    ToPacked<false>(blocks, block_count, weights, ahead, result.xyz);
}

template <bool kStream>
HWY_INLINE void ToPlanes(const float* blocks, std::size_t block_count, const PathWeights& weights, std::size_t ahead,
                         const PlanesResult& result) {
  EvaluatePath(blocks, block_count, weights, ahead,
               [x = result.x, y = result.y, z = result.z](const Lanes3& u, std::size_t i) HWY_ATTR {
                 StoreOne<kStream>(u.x, x + i);
                 StoreOne<kStream>(u.y, y + i);
                 StoreOne<kStream>(u.z, z + i);
               });
}

void EvaluatePathPlanes(const float* blocks, std::size_t block_count, const PathWeights& weights, PlanesResult result,
                        std::size_t ahead) {
  if (result.access.stream)
    ToPlanes<true>(blocks, block_count, weights, ahead, result);
  else
    ToPlanes<false>(blocks, block_count, weights, ahead, result);
}

}  // namespace chronormal::inline internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace chronormal::inline internal {

HWY_EXPORT(EvaluatePathPacked);
HWY_EXPORT(EvaluatePathPlanes);

namespace {

// Calls evaluate(blocks, their number, where its results go, how far ahead to prefetch) for parts of them all.
template <class Result, class Evaluate>
void at_best_distance(const float* blocks, std::size_t block_count, const Result& result, const Evaluate& evaluate) {
  constexpr std::size_t kBytesOfElement = kPathBlock / kTile * sizeof(float);
  prefetch_of_paths(result.access.working_set)
      .over(block_count * kTile, kBytesOfElement, [&](std::size_t first, std::size_t count, std::size_t ahead) {
        evaluate(blocks + first / kTile * kPathBlock, count / kTile, behind(result, first), ahead);
      });
}

}  // namespace

void evaluate_path_blocks(const float* blocks, std::size_t block_count, const PathWeights& weights,
                          PackedResult result) noexcept {
  at_best_distance(blocks, block_count, result,
                   [&](const float* some, std::size_t count, const PackedResult& to, std::size_t ahead) {
                     HWY_DYNAMIC_DISPATCH(EvaluatePathPacked)(some, count, weights, to, ahead);
                   });
}

void evaluate_path_blocks(const float* blocks, std::size_t block_count, const PathWeights& weights,
                          PlanesResult result) noexcept {
  at_best_distance(blocks, block_count, result,
                   [&](const float* some, std::size_t count, const PlanesResult& to, std::size_t ahead) {
                     HWY_DYNAMIC_DISPATCH(EvaluatePathPlanes)(some, count, weights, to, ahead);
                   });
}

}  // namespace chronormal::inline internal
#endif  // HWY_ONCE
