// Computes the control normals of sixteen triangles at a time, in double.
//
// This file is included once for each instruction set, like lanes-inl.h. The operations are those of
// polygon_control_normals() in the same order, so the values have the same bits.
//
// If positions are rows of three floats, each point is loaded as 16 bytes, and the points are transposed in registers.
// The 16 bytes of the last point would end beyond its array, so triangles that use this point are loaded differently.

#include "simd/highway-inl.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "chronormal/motion/motion.h"
#include "core/rounding.h"
#include "motion/coherence.h"
#include "motion/segment_end.h"
#include "normals/control/kernels/control_tile.h"
#include "normals/control/kernels/exact_tile.h"
#include "simd/intrinsics-inl.h"
#include "simd/rows-inl.h"

#if defined(CHRONORMAL_NORMALS_CONTROL_KERNELS_TRIANGLES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CHRONORMAL_NORMALS_CONTROL_KERNELS_TRIANGLES_INL_H_
#undef CHRONORMAL_NORMALS_CONTROL_KERNELS_TRIANGLES_INL_H_
#else
#define CHRONORMAL_NORMALS_CONTROL_KERNELS_TRIANGLES_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace chronormal::inline internal::HWY_NAMESPACE {

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

// The ways of loading points. kPacked, kEnds and kRow load the 16 bytes of a row that begins with x y z: in packed
// rows, in rows with both ends of the segment side by side, and in rows of any stride. kLastRow loads only 12 bytes of
// a row. kAny loads one coordinate after the other, in any layout.
enum class PointAccess { kPacked, kEnds, kRow, kLastRow, kAny };

constexpr std::size_t kEndsStride = kScatteredBytes / sizeof(float);

constexpr bool LoadsRows(PointAccess access) { return access < PointAccess::kLastRow; }

// Returns the way of loading that works for all points of a segment, except perhaps for the last point.
HWY_INLINE PointAccess AccessOf(const Segment& segment) {
  const auto is_rows = [](const VectorView<const float>& points) {
    return points.stride >= 3 && points.y == points.x + 1 && points.z == points.x + 2;
  };
  if (!is_rows(segment.from) || !is_rows(segment.to)) return PointAccess::kAny;
  const auto both_are = [&segment](std::size_t stride) {
    return segment.from.stride == stride && segment.to.stride == stride;
  };
  if (both_are(3)) return PointAccess::kPacked;
  return both_are(kEndsStride) ? PointAccess::kEnds : PointAccess::kRow;
}

// Returns the number of floats from one point to the next, as a constant if kAccess determines this number.
template <PointAccess kAccess>
HWY_INLINE std::size_t StrideOf(const VectorView<const float>& points) {
  if constexpr (kAccess == PointAccess::kPacked) return 3;
  if constexpr (kAccess == PointAccess::kEnds) return kEndsStride;
  return points.stride;
}

template <PointAccess kAccess>
HWY_INLINE Row LoadPoint(const VectorView<const float>& points, std::uint32_t vertex) {
  const std::size_t at = vertex * StrideOf<kAccess>(points);
  if constexpr (LoadsRows(kAccess)) {
    return LoadRow(points.x + at);
  } else {
    const float point[4] = {points.x[at], points.y[at], points.z[at], 0};
    return LoadRow(point);
  }
}

#if HWY_TARGET != HWY_SCALAR
// Loads one point into each 128 bits of a vector.
template <PointAccess kAccess>
HWY_INLINE Floats LoadPoints(const VectorView<const float>& points, const std::uint32_t* vertices) {
  if constexpr (LoadsRows(kAccess)) {
    return LoadBlocks([&](std::size_t i) HWY_ATTR { return points.x + vertices[i] * StrideOf<kAccess>(points); });
  } else {
    return Blocks([&](std::size_t i) HWY_ATTR { return LoadPoint<kAccess>(points, vertices[i]); });
  }
}
#endif

// The positions of some triangles at both ends of the segment, with one triangle per lane.
struct TriangleLanes {
  Lanes3 a0, b0, c0, a1, b1, c1;
};

// Loads the positions of one vertex per lane at both ends of the segment. The vertices of neighbouring lanes are kStep
// entries apart in `vertices`. Both ends are loaded together, so that every index is read once.
template <PointAccess kAccess, std::size_t kStep>
HWY_INLINE void LoadBothEnds(const Segment& segment, const std::uint32_t* vertices, Lanes3& from, Lanes3& to) {
#if HWY_TARGET == HWY_SCALAR
  from = LoadPoint<kAccess>(segment.from, vertices[0]).xyz();
  to = LoadPoint<kAccess>(segment.to, vertices[0]).xyz();
#else
  Floats from_rows[4], to_rows[4];
  for (std::size_t k = 0; k < 4; ++k) {
    std::uint32_t of_blocks[kLanes / 4];
    for (std::size_t block = 0; block < kLanes / 4; ++block) of_blocks[block] = vertices[kStep * (4 * block + k)];
    from_rows[k] = LoadPoints<kAccess>(segment.from, of_blocks);
    to_rows[k] = LoadPoints<kAccess>(segment.to, of_blocks);
  }
  from = Transposed(from_rows).xyz();
  to = Transposed(to_rows).xyz();
#endif
}

template <PointAccess kAccess>
HWY_INLINE TriangleLanes LoadTriangles(const Segment& segment, const std::uint32_t* corners) {
  TriangleLanes p;
  LoadBothEnds<kAccess, 3>(segment, corners, p.a0, p.a1);
  LoadBothEnds<kAccess, 3>(segment, corners + 1, p.b0, p.b1);
  LoadBothEnds<kAccess, 3>(segment, corners + 2, p.c0, p.c1);
  return p;
}

// Returns an upper bound of the sum of the absolute products in any component of e x f, where each of the edges e and f
// may be at either end of the segment.
HWY_INLINE Floats MagnitudeAbove(const TriangleLanes& p) {
  const Floats e = MaxAbs(p.b0 - p.a0, p.b1 - p.a1);
  const Floats f = MaxAbs(p.c0 - p.a0, p.c1 - p.a1);
  // The factor is slightly more than 2 because the product is rounded. A tiny number is added in case the product
  // underflows.
  const Floats tiny = hn::Min(hn::Min(e, f), hn::Set(kFloats, std::numeric_limits<float>::min()));
  return hn::Add(hn::Mul(hn::Set(kFloats, 2.0f + 0x1p-19f), hn::Mul(e, f)), tiny);
}

// Returns an upper bound of the absolute components of the edges from the first corner, at both ends of the segment.
HWY_INLINE Floats LongestAbove(const TriangleLanes& p) {
  const Floats e = MaxAbs(p.b0 - p.a0, p.b1 - p.a1), f = MaxAbs(p.c0 - p.a0, p.c1 - p.a1);
  return hn::Mul(hn::Set(kFloats, 1 + 0x1p-22f), hn::Max(e, f));  // the factor covers the rounding of the differences
}

// Returns the bounds of MagnitudeAbove() separately for n0, m and n1. Each bound is computed from the ends of the
// segment on which its control normal depends. The bound for m covers both of its products.
HWY_INLINE Lanes3 MagnitudesAbove(const TriangleLanes& p) {
  const Floats e0 = MaxAbs(p.b0 - p.a0), e1 = MaxAbs(p.b1 - p.a1);
  const Floats f0 = MaxAbs(p.c0 - p.a0), f1 = MaxAbs(p.c1 - p.a1);
  const auto above = [](Floats e, Floats f) HWY_ATTR {
    const Floats tiny = hn::Min(hn::Min(e, f), hn::Set(kFloats, std::numeric_limits<float>::min()));
    return hn::Add(hn::Mul(hn::Set(kFloats, 2.0f + 0x1p-18f), hn::Mul(e, f)), tiny);
  };
  return {above(e0, f0), hn::Add(above(e0, f1), above(e1, f0)), above(e1, f1)};
}

// Writes the control normals of half of the triangles in the lanes into a tile. Returns true if a component may be zero
// or only rounding error, or if a control normal is hardly larger than its rounding error.
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
  const Doubles certain = hn::Mul(hn::Set(kDoubles, kCertainAbove), ToDouble<kHalf>(magnitude));
  return !hn::AllTrue(kDoubles, hn::Gt(smallest, certain));
}

// Stores the error bounds of half of the lanes. The bounds are the values of CrossSum::error().
template <int kHalf>
HWY_INLINE void StoreErrors(const Lanes3& magnitudes, double (*errors)[kTile], std::size_t lane) {
  const Doubles3 e = Scale(hn::Set(kDoubles, 12 * kUnitRoundoff), ToDouble<kHalf>(magnitudes));
  hn::Store(e.x, kDoubles, errors[0] + lane);
  hn::Store(e.y, kDoubles, errors[1] + lane);
  hn::Store(e.z, kDoubles, errors[2] + lane);
}

// Turns -0 into 0. Recomputes every triangle that has a component which may be only rounding error, or a vector that
// rounding errors could turn.
HWY_NOINLINE inline void SettleNoise(const Segment& segment, const std::uint32_t* corners, ExactTile& tile) {
  const Doubles zero = hn::Zero(kDoubles);
  for (std::size_t lane = 0; lane < kTile; lane += kDoubleLanes) {
    const auto magnitude = hn::PromoteTo(kDoubles, hn::LoadU(HalfFloatTag(), tile.magnitude + lane));
    const Doubles noise = hn::Mul(hn::Set(kDoubles, kErrorAbove), magnitude);
    const Doubles certain = hn::Mul(hn::Set(kDoubles, kCertainAbove), magnitude);
    const auto nothing = hn::Eq(magnitude, zero);
    auto settled = hn::Lt(noise, hn::Set(kDoubles, std::numeric_limits<double>::infinity()));
    for (std::size_t k = 0; k < 9; k += 3) {
      Doubles largest = zero;
      for (double* plane : {tile.normals[k], tile.normals[k + 1], tile.normals[k + 2]}) {
        const Doubles v = hn::Load(kDoubles, plane + lane);
        hn::Store(hn::Add(v, zero), kDoubles, plane + lane);
        settled = hn::And(settled, hn::Or(hn::Eq(v, zero), hn::Gt(hn::Abs(v), noise)));
        largest = LargerAbs(largest, v);
      }
      settled = hn::And(settled, hn::Or(nothing, hn::Gt(largest, certain)));
    }
    if (hn::AllTrue(kDoubles, settled)) continue;
    const std::uint32_t bits = BitsOf(kDoubles, settled);
    for (std::size_t i = 0; i < kDoubleLanes; ++i) {
      if ((bits >> i & 1) == 0) set_without_rounding(segment, corners + 3 * (lane + i), lane + i, tile);
    }
  }
}

// The results for a tile besides its normals: the errors of a BoundedTile, or the longest edges of an EdgedTile.
// nullptr stands for results that are not needed.
struct TileExtras {
  double (*errors)[kTile] = nullptr;
  float* longest = nullptr;
};

template <PointAccess kAccess>
void TriangleTile(const Segment& segment, const std::uint32_t* corners, ExactTile& tile, const TileExtras& extras) {
  bool noise = false;
  for (std::size_t lane = 0; lane < kTile; lane += kLanes) {
    const TriangleLanes p = LoadTriangles<kAccess>(segment, corners + 3 * lane);
    const Floats magnitude = MagnitudeAbove(p);
    hn::Store(magnitude, kFloats, tile.magnitude + lane);
    noise |= HalfOfTriangles<0>(p, magnitude, lane, tile);
    if constexpr (kLanes > 1) noise |= HalfOfTriangles<1>(p, magnitude, lane, tile);
    if (extras.errors != nullptr) {
      const Lanes3 magnitudes = MagnitudesAbove(p);
      StoreErrors<0>(magnitudes, extras.errors, lane);
      if constexpr (kLanes > 1) StoreErrors<1>(magnitudes, extras.errors, lane + kDoubleLanes);
    }
    if (extras.longest != nullptr) hn::Store(LongestAbove(p), kFloats, extras.longest + lane);
  }
  if (noise) SettleNoise(segment, corners, tile);
}

// Prefetches the positions of `count` vertices at both ends of the segment, which must be rows of three floats.
HWY_INLINE void PrefetchPoints(const Segment& segment, const std::uint32_t* vertices, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t vertex = vertices[i];
    hwy::Prefetch(segment.from.x + vertex * segment.from.stride);
    hwy::Prefetch(segment.to.x + vertex * segment.to.stride);
  }
}

template <PointAccess kAccess>
using AccessConstant = std::integral_constant<PointAccess, kAccess>;

// Calls body(access) with the fastest way of loading points that works for sixteen triangles, as a constant. `corners`
// are their 48 vertices. Returns true if these vertices are far from each other in memory.
template <class Body>
HWY_INLINE bool WithAccess(const Segment& segment, PointAccess access, const std::uint32_t* corners, const Body& body) {
  if (access == PointAccess::kAny) {
    body(AccessConstant<PointAccess::kAny>());
    return false;
  }
  constexpr std::uint32_t kFar = 1u << 14;  // positions of this many vertices exceed a cache near the core
  const hn::RebindToUnsigned<FloatTag> tag;
  auto highest = hn::LoadU(tag, corners), lowest = highest;
  for (std::size_t i = kLanes; i < 3 * kTile; i += kLanes) {
    highest = hn::Max(highest, hn::LoadU(tag, corners + i));
    lowest = hn::Min(lowest, hn::LoadU(tag, corners + i));
  }
  const auto last = hn::Set(tag, static_cast<std::uint32_t>(segment.from.count - 1));
  if (HWY_UNLIKELY(!hn::AllFalse(tag, hn::Eq(highest, last)))) {
    body(AccessConstant<PointAccess::kLastRow>());
  } else if (access == PointAccess::kPacked) {
    body(AccessConstant<PointAccess::kPacked>());
  } else if (access == PointAccess::kEnds) {
    body(AccessConstant<PointAccess::kEnds>());
  } else {
    body(AccessConstant<PointAccess::kRow>());
  }
  const auto far_bits = hn::And(hn::Sub(highest, lowest), hn::Set(tag, ~(kFar - 1)));
  return !hn::AllTrue(tag, hn::Eq(far_bits, hn::Zero(tag)));
}

// Calls body(access, corners) for the triangles first ... first + 15. `access` is the fastest way of loading points
// that works for them, as a constant, and `corners` are their 48 vertices. From `end` on, the last triangle is
// repeated. If the vertices are far from each other in memory, the vertices of later triangles are prefetched.
// Precondition: first < end.
template <class Body>
HWY_INLINE void WithTriangles(const Segment& segment, PointAccess access, std::size_t first, std::size_t end,
                              const Body& body) {
  constexpr std::size_t kAhead = 2;  // number of tiles by which vertices are prefetched in advance
  const Topology& topology = *segment.topology;
  const std::uint32_t* const corners = topology.corners().data() + 3 * first;
  if (HWY_LIKELY(first + kTile <= end)) {
    const bool far = WithAccess(segment, access, corners, [&](auto known) HWY_ATTR { body(known, corners); });
    if (far && first + (kAhead + 1) * kTile <= topology.face_count())
      PrefetchPoints(segment, corners + 3 * kAhead * kTile, 3 * kTile);
    return;
  }
  std::uint32_t repeated[3 * kTile];
  for (std::size_t i = 0; i < 3 * kTile; ++i) repeated[i] = corners[3 * std::min(i / 3, end - 1 - first) + i % 3];
  WithAccess(segment, access, repeated, [&](auto known) HWY_ATTR { body(known, repeated); });
}

// Writes the control normals of the faces first ... first + 15 into a tile. From `end` on, the last face is repeated.
// Extras are written for triangles only. Precondition: first < end.
HWY_INLINE void FaceTile(const Segment& segment, PointAccess access, std::size_t first, std::size_t end,
                         ExactTile& tile, const TileExtras& extras = {}) {
  if (!fits_lanes(segment)) {
    for (std::size_t i = 0; i < kTile; ++i) set_polygon(segment, std::min(first + i, end - 1), i, tile);
    return;
  }
  WithTriangles(segment, access, first, end, [&](auto known, const std::uint32_t* corners) HWY_ATTR {
    TriangleTile<known()>(segment, corners, tile, extras);
  });
}

// Stores the components of sixteen faces as sixteen rows of nine doubles.
HWY_INLINE void StoreRows(const ExactTile& tile, double* rows) {
  constexpr std::size_t kRow = 9;
#if HWY_TARGET == HWY_SCALAR
  for (std::size_t lane = 0; lane < kTile; ++lane) {
    for (std::size_t k = 0; k < kRow; ++k) rows[lane * kRow + k] = tile.normals[k][lane];
  }
#else
  for (std::size_t lane = 0; lane < kTile; lane += kDoubleLanes) {
    double* const to = rows + lane * kRow;
    StoreEightColumns([&tile, lane](std::size_t k) HWY_ATTR { return hn::Load(kDoubles, tile.normals[k] + lane); }, to,
                      kRow);
    for (std::size_t i = 0; i < kDoubleLanes; ++i) to[i * kRow + 8] = tile.normals[8][lane + i];
  }
#endif
}

}  // namespace chronormal::inline internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // CHRONORMAL_NORMALS_CONTROL_KERNELS_TRIANGLES_INL_H_
