// Control normals of sixteen triangles at a time, in double.
//
// Included once for each instruction set, as lanes-inl.h. The operations are those of polygon_control_normals() in the
// same order, so that the values have the same bits.
//
// Positions in rows, as (n, 3), are loaded by the point, 16 bytes each, and transposed in registers. The 16 bytes of
// the last point would end beyond its array, so triangles with that point are loaded in another way.

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "chronormal/motion/motion.h"
#include "normals/control/kernels/control_tile.h"
#include "normals/control/kernels/exact_tile.h"
#include "simd/lanes-inl.h"
#include "simd/rows-inl.h"

#if defined(CHRONORMAL_NORMALS_CONTROL_KERNELS_TRIANGLES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CHRONORMAL_NORMALS_CONTROL_KERNELS_TRIANGLES_INL_H_
#undef CHRONORMAL_NORMALS_CONTROL_KERNELS_TRIANGLES_INL_H_
#else
#define CHRONORMAL_NORMALS_CONTROL_KERNELS_TRIANGLES_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace chronormal::HWY_NAMESPACE {

// The larger and the smaller of two absolute values; neither may be NaN.
#if HWY_TARGET == HWY_AVX3
HWY_INLINE Floats LargerAbs(Floats a, Floats b) { return Floats{_mm512_range_ps(a.raw, b.raw, 0b1011)}; }
HWY_INLINE Doubles LargerAbs(Doubles a, Doubles b) { return Doubles{_mm512_range_pd(a.raw, b.raw, 0b1011)}; }
HWY_INLINE Doubles SmallerAbs(Doubles a, Doubles b) { return Doubles{_mm512_range_pd(a.raw, b.raw, 0b1010)}; }
#else
HWY_INLINE Floats LargerAbs(Floats a, Floats b) { return hn::Max(hn::Abs(a), hn::Abs(b)); }
HWY_INLINE Doubles LargerAbs(Doubles a, Doubles b) { return hn::Max(hn::Abs(a), hn::Abs(b)); }
HWY_INLINE Doubles SmallerAbs(Doubles a, Doubles b) { return hn::Min(hn::Abs(a), hn::Abs(b)); }
#endif

template <class V>
HWY_INLINE auto MaxAbs(const V& v) {
  return LargerAbs(LargerAbs(v.x, v.y), v.z);
}
template <class V>
HWY_INLINE auto MaxAbs(const V& a, const V& b) {
  return LargerAbs(MaxAbs(a), MaxAbs(b));
}
template <class V>
HWY_INLINE auto MaxAbs(const V& a, const V& b, const V& c) {
  return LargerAbs(MaxAbs(a, b), MaxAbs(c));
}
HWY_INLINE Doubles MinAbs(const Doubles3& v) { return SmallerAbs(SmallerAbs(v.x, v.y), v.z); }

// The lower (0) or upper (1) half of the lanes.
template <int kHalf>
HWY_INLINE Doubles ToDouble(Floats v) {
#if HWY_TARGET == HWY_SCALAR
  return hn::PromoteTo(kDoubles, v);
#else
  if constexpr (kHalf == 0) return hn::PromoteTo(kDoubles, hn::LowerHalf(v));
  if constexpr (kHalf == 1) return hn::PromoteTo(kDoubles, hn::UpperHalf(HalfFloatTag(), v));
#endif
}
template <int kHalf>
HWY_INLINE Doubles3 ToDouble(const Lanes3& v) {
  return {ToDouble<kHalf>(v.x), ToDouble<kHalf>(v.y), ToDouble<kHalf>(v.z)};
}
// Plain C++ in Highway rounds what is beyond the range of float to the largest float, where all others and
// static_cast give infinity.
#undef CHRONORMAL_DEMOTE_CLAMPS
#if HWY_TARGET == HWY_SCALAR || HWY_TARGET == HWY_EMU128
#define CHRONORMAL_DEMOTE_CLAMPS 1
#else
#define CHRONORMAL_DEMOTE_CLAMPS 0
#endif

// kLanes doubles in memory.
HWY_INLINE Floats ToFloat(const double* from) {
#if CHRONORMAL_DEMOTE_CLAMPS
  float rounded[kLanes];
  for (std::size_t i = 0; i < kLanes; ++i) rounded[i] = static_cast<float>(from[i]);
  return hn::LoadU(kFloats, rounded);
#else
  const HalfFloatTag half;
  return hn::Combine(kFloats, hn::DemoteTo(half, hn::Load(kDoubles, from + kDoubleLanes)),
                     hn::DemoteTo(half, hn::Load(kDoubles, from)));
#endif
}

// How points are loaded: 16 bytes of a row whose first three floats are x y z; 12 bytes of it; or one coordinate after
// the other, whatever the layout.
enum class PointAccess { kRow, kLastRow, kAny };

template <PointAccess kAccess>
HWY_INLINE Row LoadPoint(const VectorView<const float>& points, std::uint32_t vertex) {
  const std::size_t at = vertex * points.stride;
  if constexpr (kAccess == PointAccess::kRow) {
    return LoadRow(points.x + at);
  } else {
    const float point[4] = {points.x[at], points.y[at], points.z[at], 0};
    return LoadRow(point);
  }
}

// Where the triangles of one vector of lanes are at both ends.
struct TriangleLanes {
  Lanes3 a0, b0, c0, a1, b1, c1;
};

// corners: three for each lane, of which the first counts. Both ends at once, so that no index is kept in between.
template <PointAccess kAccess>
HWY_INLINE void LoadCorners(const Segment& segment, const std::uint32_t* corners, Lanes3& from, Lanes3& to) {
#if HWY_TARGET == HWY_SCALAR
  from = LoadPoint<kAccess>(segment.from, corners[0]).xyz();
  to = LoadPoint<kAccess>(segment.to, corners[0]).xyz();
#else
  Floats from_rows[4], to_rows[4];
#if HWY_TARGET == HWY_AVX3
  if constexpr (kAccess == PointAccess::kRow) {
    const auto put = [](Floats& into, const float* point, __mmask16 lanes)
                         HWY_ATTR { into.raw = _mm512_mask_broadcast_f32x4(into.raw, lanes, _mm_loadu_ps(point)); };
    for (std::size_t k = 0; k < 4; ++k) {
      for (std::size_t block = 0; block < 4; ++block) {
        const std::size_t vertex = corners[3 * (4 * block + k)];
        const float* const from_point = segment.from.x + vertex * segment.from.stride;
        const float* const to_point = segment.to.x + vertex * segment.to.stride;
        if (block == 0) {
          from_rows[k].raw = _mm512_castps128_ps512(_mm_loadu_ps(from_point));
          to_rows[k].raw = _mm512_castps128_ps512(_mm_loadu_ps(to_point));
        } else {
          const auto lanes = static_cast<__mmask16>(0xF << 4 * block);
          put(from_rows[k], from_point, lanes);
          put(to_rows[k], to_point, lanes);
        }
      }
    }
    from = Transposed(from_rows).xyz();
    to = Transposed(to_rows).xyz();
    return;
  }
#endif
  for (std::size_t k = 0; k < 4; ++k) {
    Row f[kLanes / 4], t[kLanes / 4];
    for (std::size_t block = 0; block < kLanes / 4; ++block) {
      const std::uint32_t vertex = corners[3 * (4 * block + k)];
      f[block] = LoadPoint<kAccess>(segment.from, vertex);
      t[block] = LoadPoint<kAccess>(segment.to, vertex);
    }
    from_rows[k] = Blocks([&f](std::size_t block) HWY_ATTR { return f[block]; });
    to_rows[k] = Blocks([&t](std::size_t block) HWY_ATTR { return t[block]; });
  }
  from = Transposed(from_rows).xyz();
  to = Transposed(to_rows).xyz();
#endif
}

template <PointAccess kAccess>
HWY_INLINE TriangleLanes LoadTriangles(const Segment& segment, const std::uint32_t* corners) {
  TriangleLanes p;
  LoadCorners<kAccess>(segment, corners, p.a0, p.a1);
  LoadCorners<kAccess>(segment, corners + 1, p.b0, p.b1);
  LoadCorners<kAccess>(segment, corners + 2, p.c0, p.c1);
  return p;
}

HWY_INLINE bool IsRows(const VectorView<const float>& points) {
  return points.stride >= 3 && points.y == points.x + 1 && points.z == points.x + 2;
}

// Not less than the sum of the absolute products in any component of e x f, whichever ends e and f belong to.
HWY_INLINE Floats MagnitudeAbove(const TriangleLanes& p) {
  const Floats e = MaxAbs(p.b0 - p.a0, p.b1 - p.a1);
  const Floats f = MaxAbs(p.c0 - p.a0, p.c1 - p.a1);
  // A little more than twice the product, for its rounding, and something where it underflows.
  const Floats tiny = hn::Min(hn::Min(e, f), hn::Set(kFloats, std::numeric_limits<float>::min()));
  return hn::Add(hn::Mul(hn::Set(kFloats, 2.0f + 0x1p-19f), hn::Mul(e, f)), tiny);
}

// Of half of the lanes, into tile. Whether one of the values may be noise, or a zero.
template <int kHalf>
HWY_INLINE bool HalfOfTriangles(const TriangleLanes& p, Floats magnitude, std::size_t lane, ExactTile& tile) {
  const Doubles3 a0 = ToDouble<kHalf>(p.a0), a1 = ToDouble<kHalf>(p.a1);
  const Doubles3 e0 = ToDouble<kHalf>(p.b0) - a0, e1 = ToDouble<kHalf>(p.b1) - a1;
  const Doubles3 f0 = ToDouble<kHalf>(p.c0) - a0, f1 = ToDouble<kHalf>(p.c1) - a1;
  const Doubles3 n0 = Cross(e0, f0), n1 = Cross(e1, f1);
  const Doubles3 m = Scale(hn::Set(kDoubles, 0.5), Cross(e0, f1) + Cross(e1, f0));
  double* const to = &tile.normals[0][lane + kHalf * kDoubleLanes];
  std::size_t k = 0;
  for (const Doubles3* v : {&n0, &m, &n1}) {
    hn::Store(v->x, kDoubles, to + k * kTile);
    hn::Store(v->y, kDoubles, to + (k + 1) * kTile);
    hn::Store(v->z, kDoubles, to + (k + 2) * kTile);
    k += 3;
  }
  const Doubles smallest = SmallerAbs(SmallerAbs(MinAbs(n0), MinAbs(m)), MinAbs(n1));
  const Doubles noise = hn::Mul(hn::Set(kDoubles, kNoiseAbove), ToDouble<kHalf>(magnitude));
  return !hn::AllTrue(kDoubles, hn::Gt(smallest, noise));
}

// Makes -0 a 0, and asks for every triangle with a component that may be noise in another way.
HWY_NOINLINE inline void SettleNoise(const Segment& segment, const std::uint32_t* corners, ExactTile& tile) {
  const Doubles zero = hn::Zero(kDoubles);
  for (std::size_t lane = 0; lane < kTile; lane += kDoubleLanes) {
    const auto magnitude = hn::PromoteTo(kDoubles, hn::LoadU(HalfFloatTag(), tile.magnitude + lane));
    const Doubles noise = hn::Mul(hn::Set(kDoubles, kNoiseAbove), magnitude);
    auto settled = hn::Lt(noise, hn::Set(kDoubles, std::numeric_limits<double>::infinity()));
    for (auto& plane : tile.normals) {
      const Doubles v = hn::Load(kDoubles, plane + lane);
      hn::Store(hn::Add(v, zero), kDoubles, plane + lane);
      settled = hn::And(settled, hn::Or(hn::Eq(v, zero), hn::Gt(hn::Abs(v), noise)));
    }
    if (hn::AllTrue(kDoubles, settled)) continue;
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(kDoubles, settled, bits);
    for (std::size_t i = 0; i < kDoubleLanes; ++i) {
      if ((bits[0] >> i & 1) == 0) set_without_noise(segment, corners + 3 * (lane + i), lane + i, tile);
    }
  }
}

template <PointAccess kAccess>
void TriangleTile(const Segment& segment, const std::uint32_t* corners, ExactTile& tile) {
  bool noise = false;
  for (std::size_t lane = 0; lane < kTile; lane += kLanes) {
    const TriangleLanes p = LoadTriangles<kAccess>(segment, corners + 3 * lane);
    const Floats magnitude = MagnitudeAbove(p);
    hn::Store(magnitude, kFloats, tile.magnitude + lane);
    noise |= HalfOfTriangles<0>(p, magnitude, lane, tile);
    if constexpr (kLanes > 1) noise |= HalfOfTriangles<1>(p, magnitude, lane, tile);
  }
  if (noise) SettleNoise(segment, corners, tile);
}

// Asks for both ends of `count` vertices of (n, 3) positions before they are loaded.
HWY_INLINE void PrefetchPoints(const Segment& segment, const std::uint32_t* vertices, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t vertex = vertices[i];
    hwy::Prefetch(segment.from.x + vertex * segment.from.stride);
    hwy::Prefetch(segment.to.x + vertex * segment.to.stride);
  }
}

// Sixteen triangles; corners: their 48 vertices. Whether those are far from each other in memory.
HWY_INLINE bool TriangleTile(const Segment& segment, bool rows, const std::uint32_t* corners, ExactTile& tile) {
  if (!rows) {
    TriangleTile<PointAccess::kAny>(segment, corners, tile);
    return false;
  }
  constexpr std::uint32_t kFar = 1u << 14;  // positions: more than a cache near the core holds
  const hn::RebindToUnsigned<FloatTag> tag;
  auto highest = hn::LoadU(tag, corners), lowest = highest;
  for (std::size_t i = kLanes; i < 3 * kTile; i += kLanes) {
    highest = hn::Max(highest, hn::LoadU(tag, corners + i));
    lowest = hn::Min(lowest, hn::LoadU(tag, corners + i));
  }
  const auto last = hn::Set(tag, static_cast<std::uint32_t>(segment.from.count - 1));
  if (HWY_LIKELY(hn::AllFalse(tag, hn::Eq(highest, last)))) {
    TriangleTile<PointAccess::kRow>(segment, corners, tile);
  } else {
    TriangleTile<PointAccess::kLastRow>(segment, corners, tile);
  }
  const auto far_bits = hn::And(hn::Sub(highest, lowest), hn::Set(tag, ~(kFar - 1)));
  return !hn::AllTrue(tag, hn::Eq(far_bits, hn::Zero(tag)));
}

// The faces first ... first + 15; those from `end` on repeat the one before. first < end
HWY_INLINE void FaceTile(const Segment& segment, bool rows, std::size_t first, std::size_t end, ExactTile& tile) {
  constexpr std::size_t kAhead = 2;  // tiles
  const Topology& topology = *segment.topology;
  if (!topology.all_triangles()) {
    for (std::size_t i = 0; i < kTile; ++i) set_polygon(segment, std::min(first + i, end - 1), i, tile);
    return;
  }
  const std::uint32_t* const corners = topology.corners().data() + 3 * first;
  if (HWY_LIKELY(first + kTile <= end)) {
    const bool far = TriangleTile(segment, rows, corners, tile);
    if (far && first + (kAhead + 1) * kTile <= topology.face_count())
      PrefetchPoints(segment, corners + 3 * kAhead * kTile, 3 * kTile);
    return;
  }
  std::uint32_t repeated[3 * kTile];
  for (std::size_t i = 0; i < 3 * kTile; ++i) repeated[i] = corners[3 * std::min(i / 3, end - 1 - first) + i % 3];
  TriangleTile(segment, rows, repeated, tile);
}

#if HWY_TARGET != HWY_SCALAR

#if HWY_TARGET == HWY_AVX3
// Row i has lane i of plane(0) ... plane(7): pairs, fours, and eights of neighbours.
template <class PlaneOf>
HWY_INLINE void StoreEightRows(const PlaneOf& plane, double* to, std::size_t stride) {
  __m512d even[4], odd[4];  // of rows 0 2 4 6 and 1 3 5 7, the planes 2 i and 2 i + 1
  for (std::size_t i = 0; i < 4; ++i) {
    even[i] = _mm512_unpacklo_pd(plane(2 * i).raw, plane(2 * i + 1).raw);
    odd[i] = _mm512_unpackhi_pd(plane(2 * i).raw, plane(2 * i + 1).raw);
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
}
#endif

// Of each pair of lanes the 128 bits go to rows of their own.
template <class V>
HWY_INLINE void StorePairs(V v, double* to, std::size_t stride) {
  constexpr std::size_t kPairs = sizeof(V) / 16;
  if constexpr (kPairs == 1) {
    hn::StoreU(v, hn::FixedTag<double, 2>(), to);
  } else {
    StorePairs(hn::LowerHalf(v), to, stride);
    StorePairs(hn::UpperHalf(hn::Half<hn::FixedTag<double, 2 * kPairs>>(), v), to + kPairs / 2 * stride, stride);
  }
}
#endif

// Sixteen rows of kRow doubles: the nine components of a face, and its magnitude where there is room for it.
template <std::size_t kRow>
HWY_INLINE void StoreRows(const ExactTile& tile, double* rows) {
#if HWY_TARGET == HWY_SCALAR
  for (std::size_t lane = 0; lane < kTile; ++lane) {
    for (std::size_t k = 0; k < 9; ++k) rows[lane * kRow + k] = tile.normals[k][lane];
    if constexpr (kRow > 9) rows[lane * kRow + 9] = tile.magnitude[lane];
  }
#else
  for (std::size_t lane = 0; lane < kTile; lane += kDoubleLanes) {
    double* const to = rows + lane * kRow;
    const auto plane = [&tile, lane](std::size_t k) HWY_ATTR { return hn::Load(kDoubles, tile.normals[k] + lane); };
#if HWY_TARGET == HWY_AVX3
    StoreEightRows(plane, to, kRow);
#else
    for (std::size_t k = 0; k < 8; k += 2) {
      StorePairs(hn::InterleaveLower(kDoubles, plane(k), plane(k + 1)), to + k, 2 * kRow);
      StorePairs(hn::InterleaveUpper(kDoubles, plane(k), plane(k + 1)), to + kRow + k, 2 * kRow);
    }
#endif
    if constexpr (kRow > 9) {
      const Doubles magnitude = hn::PromoteTo(kDoubles, hn::LoadU(HalfFloatTag(), tile.magnitude + lane));
      StorePairs(hn::InterleaveLower(kDoubles, plane(8), magnitude), to + 8, 2 * kRow);
      StorePairs(hn::InterleaveUpper(kDoubles, plane(8), magnitude), to + kRow + 8, 2 * kRow);
    } else {
      for (std::size_t i = 0; i < kDoubleLanes; ++i) to[i * kRow + 8] = tile.normals[8][lane + i];
    }
  }
#endif
}

}  // namespace chronormal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // CHRONORMAL_NORMALS_CONTROL_KERNELS_TRIANGLES_INL_H_
