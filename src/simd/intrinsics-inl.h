// The special cases of instruction sets. Every raw intrinsic that kernels use is in this file, beside the operations of
// Highway that give the same bits on all other targets. Today all special cases are for AVX-512, whose permutations and
// masked loads need fewer instructions than Highway's general shuffles.
//
// This file is included once for each instruction set, like lanes-inl.h.

#include "simd/highway-inl.h"

#include <cstddef>
#include <cstdint>

#include "simd/lanes-inl.h"
#include "simd/rows-inl.h"

#if defined(CHRONORMAL_SIMD_INTRINSICS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CHRONORMAL_SIMD_INTRINSICS_INL_H_
#undef CHRONORMAL_SIMD_INTRINSICS_INL_H_
#else
#define CHRONORMAL_SIMD_INTRINSICS_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace chronormal::inline internal::HWY_NAMESPACE {

// Return the larger and the smaller of the absolute values of two numbers, neither of which may be NaN.
#if HWY_TARGET == HWY_AVX3
HWY_INLINE Floats LargerAbs(Floats a, Floats b) { return Floats{_mm512_range_ps(a.raw, b.raw, 0b1011)}; }
HWY_INLINE Doubles LargerAbs(Doubles a, Doubles b) { return Doubles{_mm512_range_pd(a.raw, b.raw, 0b1011)}; }
HWY_INLINE Doubles SmallerAbs(Doubles a, Doubles b) { return Doubles{_mm512_range_pd(a.raw, b.raw, 0b1010)}; }
#else
template <class V>
HWY_INLINE V LargerAbs(V a, V b) {
  return hn::Max(hn::Abs(a), hn::Abs(b));
}
template <class V>
HWY_INLINE V SmallerAbs(V a, V b) {
  return hn::Min(hn::Abs(a), hn::Abs(b));
}
#endif

// Returns a number whose bits are the lanes of a mask, with the first lane in the lowest bit.
template <class Tag>
HWY_INLINE std::uint32_t BitsOf(Tag tag, hn::Mask<Tag> mask) {
#if HWY_TARGET == HWY_AVX3
  (void)tag;
  return mask.raw;
#else
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(tag, mask, bits);
  return (static_cast<std::uint32_t>(bits[1]) << 8 | bits[0]) & ((1U << hn::MaxLanes(tag)) - 1);
#endif
}

// Writes the vectors of all lanes one after the other, x0 y0 z0 x1 y1 z1 ..., which are 3 * kLanes floats.
template <bool kStream>
HWY_INLINE void StorePacked(const Lanes3& v, float* to) {
#if HWY_TARGET == HWY_AVX3
  // Each vector takes two permutations here, and more with the general code below, which permutes pieces of 128 bits.
  const auto index = [](int a0, int a1, int a2, int b0, int b1, int b2, int c0, int c1, int c2, int d0, int d1, int d2,
                        int e0, int e1, int e2, int f0) HWY_ATTR {
    return _mm512_setr_epi32(a0, a1, a2, b0, b1, b2, c0, c1, c2, d0, d1, d2, e0, e1, e2, f0);
  };
  // The first permutation places the lanes of x and y; the numbers of y's lanes begin at 16. The second permutation
  // places the lanes of z into the gaps; their numbers begin at 16, too.
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

#if HWY_TARGET != HWY_SCALAR

// Loads four floats for each 128 bits of a vector. address(b) points to the floats for the b-th 128 bits.
template <class AddressOf>
HWY_INLINE Floats LoadBlocks(const AddressOf& address) {
#if HWY_TARGET == HWY_AVX3
  // A masked load writes four floats to some of the lanes, and needs no permutation. An insertion would need a
  // permutation.
  __m512 blocks = _mm512_castps128_ps512(_mm_loadu_ps(address(0)));
  blocks = _mm512_mask_broadcast_f32x4(blocks, 0x00F0, _mm_loadu_ps(address(1)));
  blocks = _mm512_mask_broadcast_f32x4(blocks, 0x0F00, _mm_loadu_ps(address(2)));
  return Floats{_mm512_mask_broadcast_f32x4(blocks, 0xF000, _mm_loadu_ps(address(3)))};
#else
  return Blocks([&address](std::size_t block) HWY_ATTR { return LoadRow(address(block)); });
#endif
}

// Return those 128 bits of two vectors that are in even places, and those that are in odd places. Vectors have four
// doubles, or eight on AVX-512.
HWY_INLINE Doubles EvenPairs(Doubles a, Doubles b) {
#if HWY_TARGET == HWY_AVX3
  return Doubles{_mm512_shuffle_f64x2(a.raw, b.raw, 0b10001000)};
#else
  return hn::ConcatLowerLower(kDoubles, b, a);
#endif
}
HWY_INLINE Doubles OddPairs(Doubles a, Doubles b) {
#if HWY_TARGET == HWY_AVX3
  return Doubles{_mm512_shuffle_f64x2(a.raw, b.raw, 0b11011101)};
#else
  return hn::ConcatUpperUpper(kDoubles, b, a);
#endif
}

// Loads the rows of four doubles at row(i) into four vectors, and returns the k-th of these vectors. To turn the rows
// into columns, with row i in lane i, callers interleave neighbouring vectors and pass the results to EvenPairs() and
// OddPairs(). Vectors have four doubles, or eight on AVX-512.
template <class RowOf>
HWY_INLINE Doubles LoadTransposable(const RowOf& row, std::size_t k) {
#if HWY_TARGET == HWY_AVX3
  const std::size_t first = k < 2 ? k : k + 2;
  const __m512d lower = _mm512_castpd256_pd512(_mm256_loadu_pd(row(first)));
  return Doubles{_mm512_insertf64x4(lower, _mm256_loadu_pd(row(first + 2)), 1)};
#else
  return hn::LoadU(kDoubles, row(k));
#endif
}

// Stores each 128 bits of a vector to a row of its own.
template <class V>
HWY_INLINE void StorePairs(V v, double* to, std::size_t stride) {
  constexpr std::size_t kPairs = sizeof(V) / 16;
  if constexpr (kPairs == 1) {
    hn::StoreU(v, hn::FixedTag<double, 2>(), to);
  } else {
    StorePairs(hn::LowerHalf(v), to, stride);
    StorePairs(hn::UpperHalf(hn::Half<hn::FixedTag<double, 2 * kPairs> >(), v), to + kPairs / 2 * stride, stride);
  }
}

// Stores lane i of a and lane i of b to row i, which begins at to + i * stride.
HWY_INLINE void StoreTwoColumns(Doubles a, Doubles b, double* to, std::size_t stride) {
  StorePairs(hn::InterleaveLower(kDoubles, a, b), to, 2 * stride);
  StorePairs(hn::InterleaveUpper(kDoubles, a, b), to + stride, 2 * stride);
}

// Stores lane i of column(0) ... column(7) to row i, which begins at to + i * stride.
template <class ColumnOf>
HWY_INLINE void StoreEightColumns(const ColumnOf& column, double* to, std::size_t stride) {
#if HWY_TARGET == HWY_AVX3
  // Neighbouring columns are joined to pairs, then to groups of four, and then to groups of eight.
  __m512d even[4], odd[4];  // the columns 2 i and 2 i + 1 of rows 0 2 4 6, and of rows 1 3 5 7
  for (std::size_t i = 0; i < 4; ++i) {
    even[i] = _mm512_unpacklo_pd(column(2 * i).raw, column(2 * i + 1).raw);
    odd[i] = _mm512_unpackhi_pd(column(2 * i).raw, column(2 * i + 1).raw);
  }
  std::size_t first = 0;
  for (const __m512d* const pairs : {even, odd}) {
    const __m512d lower02 = _mm512_shuffle_f64x2(pairs[0], pairs[1], 0b10001000);  // rows 0 4, 0 4
    const __m512d upper02 = _mm512_shuffle_f64x2(pairs[0], pairs[1], 0b11011101);  // rows 2 6, 2 6
    const __m512d lower46 = _mm512_shuffle_f64x2(pairs[2], pairs[3], 0b10001000);
    const __m512d upper46 = _mm512_shuffle_f64x2(pairs[2], pairs[3], 0b11011101);
    double* const row = to + first * stride;
    _mm512_storeu_pd(row, _mm512_shuffle_f64x2(lower02, lower46, 0b10001000));
    _mm512_storeu_pd(row + 2 * stride, _mm512_shuffle_f64x2(upper02, upper46, 0b10001000));
    _mm512_storeu_pd(row + 4 * stride, _mm512_shuffle_f64x2(lower02, lower46, 0b11011101));
    _mm512_storeu_pd(row + 6 * stride, _mm512_shuffle_f64x2(upper02, upper46, 0b11011101));
    ++first;
  }
#else
  for (std::size_t k = 0; k < 8; k += 2) StoreTwoColumns(column(k), column(k + 1), to + k, stride);
#endif
}

#endif  // HWY_TARGET != HWY_SCALAR

// Loads element c of row i into lane i of column[c]. Row i begins at from + i * kStride. Precondition: kStride is at
// least 8.
template <std::size_t kStride>
HWY_INLINE void LoadColumns(const double* from, Doubles (&column)[kStride]) {
#if HWY_TARGET == HWY_AVX3
  // Eight columns are built from pairs of rows, then groups of four and groups of eight, as in StoreEightColumns. The
  // other columns are built one by one.
  __m512d even[4], odd[4];  // the columns 0 2 4 6 of rows 2 i and 2 i + 1, and the columns 1 3 5 7
  for (std::size_t i = 0; i < 4; ++i) {
    const __m512d first = _mm512_loadu_pd(from + 2 * i * kStride),
                  second = _mm512_loadu_pd(from + (2 * i + 1) * kStride);
    even[i] = _mm512_unpacklo_pd(first, second);
    odd[i] = _mm512_unpackhi_pd(first, second);
  }
  std::size_t c = 0;
  for (const __m512d* const pairs : {even, odd}) {
    const __m512d lower04 = _mm512_shuffle_f64x2(pairs[0], pairs[1], 0b10001000);  // rows 0 to 3 of columns 0, 4
    const __m512d upper04 = _mm512_shuffle_f64x2(pairs[2], pairs[3], 0b10001000);  // rows 4 to 7
    const __m512d lower26 = _mm512_shuffle_f64x2(pairs[0], pairs[1], 0b11011101);
    const __m512d upper26 = _mm512_shuffle_f64x2(pairs[2], pairs[3], 0b11011101);
    column[c] = Doubles{_mm512_shuffle_f64x2(lower04, upper04, 0b10001000)};
    column[c + 4] = Doubles{_mm512_shuffle_f64x2(lower04, upper04, 0b11011101)};
    column[c + 2] = Doubles{_mm512_shuffle_f64x2(lower26, upper26, 0b10001000)};
    column[c + 6] = Doubles{_mm512_shuffle_f64x2(lower26, upper26, 0b11011101)};
    ++c;
  }
  constexpr std::size_t kFirst = 8;
#else
  constexpr std::size_t kFirst = 0;
#endif
  for (std::size_t k = kFirst; k < kStride; ++k) {
    alignas(64) double lanes[kDoubleLanes];
    for (std::size_t i = 0; i < kDoubleLanes; ++i) lanes[i] = from[i * kStride + k];
    column[k] = hn::Load(kDoubles, lanes);
  }
}

}  // namespace chronormal::inline internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // CHRONORMAL_SIMD_INTRINSICS_INL_H_
