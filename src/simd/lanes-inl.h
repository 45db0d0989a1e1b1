// What kernels share: vectors of lanes with their few operations, and blocks of 16 elements whatever the lanes.
//
// Included once for each instruction set, inside no namespace; see evaluate.cpp for the frame of a kernel file. Every
// operation here is one IEEE operation or a selection, so that all instruction sets give the same bits: no fused
// multiply-add, no approximate reciprocal, and sums in a fixed order.

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>

#if defined(CHRONORMAL_SIMD_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CHRONORMAL_SIMD_LANES_INL_H_
#undef CHRONORMAL_SIMD_LANES_INL_H_
#else
#define CHRONORMAL_SIMD_LANES_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace chronormal::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// At most 16 floats, so that a block of 16 elements is a whole number of vectors on every machine.
using FloatTag = hn::CappedTag<float, 16>;
using IntTag = hn::RebindToSigned<FloatTag>;
using Floats = hn::Vec<FloatTag>;
using Ints = hn::Vec<IntTag>;

inline constexpr FloatTag kFloats;
inline constexpr IntTag kInts;
inline constexpr std::size_t kLanes = hn::MaxLanes(FloatTag());

// Three-component vectors, one a lane.
struct Lanes3 {
  Floats x, y, z;
};

HWY_INLINE Lanes3 operator+(const Lanes3& a, const Lanes3& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE Lanes3 operator-(const Lanes3& a, const Lanes3& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE Lanes3 Scale(Floats s, const Lanes3& a) { return {hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z)}; }

HWY_INLINE Floats Dot(const Lanes3& a, const Lanes3& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}

HWY_INLINE Lanes3 Cross(const Lanes3& a, const Lanes3& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}

// v scaled to length 1, bit for bit as normalized() in normals/curves/curve_elements.h. v must not be zero.
HWY_INLINE Lanes3 Normalized(const Lanes3& v) { return Scale(hn::Div(hn::Set(kFloats, 1.0f), hn::Sqrt(Dot(v, v))), v); }

// The nearest integers, the even one of two: adding 1.5 * 2^23 leaves them in the lowest bits. |v| < 2^22.
HWY_INLINE Ints RoundToInt(Floats v) {
  const Floats large = hn::Set(kFloats, 12582912.0f);
  return hn::Sub(hn::BitCast(kInts, hn::Add(v, large)), hn::BitCast(kInts, large));
}

// Stores a vector; with kStream past the caches, where `to` must be aligned to a vector.
template <bool kStream>
HWY_INLINE void StoreOne(Floats v, float* to) {
  if constexpr (kStream) {
    hn::Stream(v, kFloats, to);
  } else {
    hn::StoreU(v, kFloats, to);
  }
}

// Writes x0 y0 z0 x1 y1 z1 ... : 3 * kLanes floats.
template <bool kStream>
HWY_INLINE void StorePacked(const Lanes3& v, float* to) {
#if HWY_TARGET == HWY_AVX3
  // Two permutations a vector instead of the generic ones by 128-bit pieces.
  const auto index = [](int a0, int a1, int a2, int b0, int b1, int b2, int c0, int c1, int c2, int d0, int d1, int d2,
                        int e0, int e1, int e2, int f0) HWY_ATTR {
    return _mm512_setr_epi32(a0, a1, a2, b0, b1, b2, c0, c1, c2, d0, d1, d2, e0, e1, e2, f0);
  };
  // The lanes of x and y first (y counts from 16), then those of z into the gaps (z counts from 16).
  const __m512i xy0 = index(0, 16, 0, 1, 17, 0, 2, 18, 0, 3, 19, 0, 4, 20, 0, 5);
  const __m512i xy1 = index(21, 0, 6, 22, 0, 7, 23, 0, 8, 24, 0, 9, 25, 0, 10, 26);
  const __m512i xy2 = index(0, 11, 27, 0, 12, 28, 0, 13, 29, 0, 14, 30, 0, 15, 31, 0);
  const __m512i z0 = index(0, 1, 16, 3, 4, 17, 6, 7, 18, 9, 10, 19, 12, 13, 20, 15);
  const __m512i z1 = index(0, 21, 2, 3, 22, 5, 6, 23, 8, 9, 24, 11, 12, 25, 14, 15);
  const __m512i z2 = index(26, 1, 2, 27, 4, 5, 28, 7, 8, 29, 10, 11, 30, 13, 14, 31);
  const auto place = [&](__m512i xy, __m512i z) HWY_ATTR {
    return Floats{_mm512_permutex2var_ps(_mm512_permutex2var_ps(v.x.raw, xy, v.y.raw), z, v.z.raw)};
  };
  StoreOne<kStream>(place(xy0, z0), to);
  StoreOne<kStream>(place(xy1, z1), to + 16);
  StoreOne<kStream>(place(xy2, z2), to + 32);
#else
  if constexpr (kStream && kLanes > 1) {
    alignas(64) float packed[3 * kLanes];
    hn::StoreInterleaved3(v.x, v.y, v.z, kFloats, packed);
    for (std::size_t i = 0; i < 3; ++i) hn::Stream(hn::Load(kFloats, packed + i * kLanes), kFloats, to + i * kLanes);
  } else {
    hn::StoreInterleaved3(v.x, v.y, v.z, kFloats, to);
  }
#endif
}

}  // namespace chronormal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // CHRONORMAL_SIMD_LANES_INL_H_
