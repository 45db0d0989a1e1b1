// The parts that kernels share: vectors of lanes with their operations, and blocks of 16 elements, whatever the number
// of lanes.
//
// This file is included once for each instruction set, outside of any namespace; evaluate.cpp shows the outline of a
// kernel file. Every operation here is one IEEE operation or a selection, so that all instruction sets give the same
// bits. There is no fused multiply-add and no approximate reciprocal, and sums are in a fixed order.

#include "simd/highway-inl.h"

#include <cstddef>
#include <cstdint>

#if defined(CHRONORMAL_SIMD_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CHRONORMAL_SIMD_LANES_INL_H_
#undef CHRONORMAL_SIMD_LANES_INL_H_
#else
#define CHRONORMAL_SIMD_LANES_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace chronormal::inline internal::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Vectors have at most 16 floats, so that a block of 16 elements is a whole number of vectors on every machine.
using FloatTag = hn::CappedTag<float, 16>;
using IntTag = hn::RebindToSigned<FloatTag>;
using Floats = hn::Vec<FloatTag>;
using Ints = hn::Vec<IntTag>;

inline constexpr FloatTag kFloats;
inline constexpr IntTag kInts;
inline constexpr std::size_t kLanes = hn::MaxLanes(FloatTag());

// A vector of three components in each lane. V is Floats, or Doubles of rows-inl.h.
template <class V>
struct LanesOf3 {
  V x, y, z;
};

using Lanes3 = LanesOf3<Floats>;

template <class V>
HWY_INLINE LanesOf3<V> operator+(const LanesOf3<V>& a, const LanesOf3<V>& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
template <class V>
HWY_INLINE LanesOf3<V> operator-(const LanesOf3<V>& a, const LanesOf3<V>& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
template <class V>
HWY_INLINE LanesOf3<V> Scale(V s, const LanesOf3<V>& a) {
  return {hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z)};
}

template <class V>
HWY_INLINE V Dot(const LanesOf3<V>& a, const LanesOf3<V>& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}

template <class V>
HWY_INLINE LanesOf3<V> Cross(const LanesOf3<V>& a, const LanesOf3<V>& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}

// Returns v scaled to length 1. The result has the same bits as that of normalized() in
// normals/curves/curve_elements.h. Precondition: v is not zero.
HWY_INLINE Lanes3 Normalized(const Lanes3& v) { return Scale(hn::Div(hn::Set(kFloats, 1.0f), hn::Sqrt(Dot(v, v))), v); }

// Returns the nearest integer in each lane, and the even one if two are equally near. Adding 1.5 * 2^23 leaves the
// integer in the lowest bits. Precondition: |v| < 2^22.
HWY_INLINE Ints RoundToInt(Floats v) {
  const Floats large = hn::Set(kFloats, 12582912.0f);
  return hn::Sub(hn::BitCast(kInts, hn::Add(v, large)), hn::BitCast(kInts, large));
}

// Stores a vector. With kStream the store bypasses the caches, and `to` must be aligned to the size of a vector.
template <bool kStream>
HWY_INLINE void StoreOne(Floats v, float* to) {
  if constexpr (kStream) {
    hn::Stream(v, kFloats, to);
  } else {
    hn::StoreU(v, kFloats, to);
  }
}

}  // namespace chronormal::inline internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // CHRONORMAL_SIMD_LANES_INL_H_
