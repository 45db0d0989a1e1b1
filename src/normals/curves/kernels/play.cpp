#include "normals/curves/kernels/play.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "normals/curves/kernels/play.cpp"
#include "simd/foreach_target-inl.h"
#include "simd/highway-inl.h"

#include "simd/intrinsics-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace chronormal::inline internal::HWY_NAMESPACE {

HWY_INLINE Lanes3 LoadState(const float* p) {
  return {hn::Load(kFloats, p), hn::Load(kFloats, p + kTile), hn::Load(kFloats, p + 2 * kTile)};
}

HWY_INLINE void StoreState(const Lanes3& v, float* p) {
  hn::Store(v.x, kFloats, p);
  hn::Store(v.y, kFloats, p + kTile);
  hn::Store(v.z, kFloats, p + 2 * kTile);
}

template <int kDegree, class Put>
HWY_INLINE void Play(float* state, std::size_t block_count, Put put) {
  constexpr std::size_t kVector = 3 * kTile;
  for (std::size_t b = 0; b < block_count; ++b) {
    for (std::size_t lane = 0; lane < kTile; lane += kLanes) {
      float* const p = state + b * (kDegree + 1) * kVector + lane;
      const Lanes3 n = LoadState(p), first = LoadState(p + kVector);
      StoreState(n + first, p);
      if constexpr (kDegree == 2) StoreState(first + LoadState(p + 2 * kVector), p + kVector);
      put(Normalized(n), b * kTile + lane);
    }
  }
}

void PlayPacked(float* state, std::size_t block_count, int degree, PackedResult result) {
  const auto put = [result](const Lanes3& u, std::size_t i) HWY_ATTR { StorePacked<false>(u, result.xyz + 3 * i); };
  if (degree == 2) {
    Play<2>(state, block_count, put);
  } else {
    Play<1>(state, block_count, put);
  }
}

void PlayPlanes(float* state, std::size_t block_count, int degree, PlanesResult result) {
  const auto put = [result](const Lanes3& u, std::size_t i) HWY_ATTR {
    hn::StoreU(u.x, kFloats, result.x + i);
    hn::StoreU(u.y, kFloats, result.y + i);
    hn::StoreU(u.z, kFloats, result.z + i);
  };
  if (degree == 2) {
    Play<2>(state, block_count, put);
  } else {
    Play<1>(state, block_count, put);
  }
}

}  // namespace chronormal::inline internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace chronormal::inline internal {

HWY_EXPORT(PlayPacked);
HWY_EXPORT(PlayPlanes);

void play_blocks(float* state, std::size_t block_count, int degree, PackedResult result) noexcept {
  HWY_DYNAMIC_DISPATCH(PlayPacked)(state, block_count, degree, result);
}

void play_blocks(float* state, std::size_t block_count, int degree, PlanesResult result) noexcept {
  HWY_DYNAMIC_DISPATCH(PlayPlanes)(state, block_count, degree, result);
}

}  // namespace chronormal::inline internal
#endif  // HWY_ONCE
