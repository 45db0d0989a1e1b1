// Adds up cross products along paths, in lanes of float32. Each second point of a path adds one product
// (groups/rings.h).
#include "normals/recompute/kernels/float_rings.h"

#include <algorithm>
#include <cassert>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "normals/recompute/kernels/float_rings.cpp"
#include "simd/foreach_target-inl.h"
#include "simd/highway-inl.h"

#include "normals/recompute/kernels/results-inl.h"
#include "simd/intrinsics-inl.h"
#include "simd/lanes-inl.h"
#include "simd/rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace chronormal::inline internal::HWY_NAMESPACE {

// The number of rows of indices by which points are prefetched in advance.
constexpr std::size_t kRingRowsAhead = 12;

// Loads the points whose numbers are index(0) ... index(kLanes - 1), one into each lane.
template <class IndexOf>
HWY_INLINE Lanes3 PointsAt(const float* rows, const IndexOf& index) {
#if HWY_TARGET == HWY_SCALAR
  return LoadRow(rows + 4 * std::size_t{index(0)}).xyz();
#else
  Floats of_four[4];
  for (std::size_t k = 0; k < 4; ++k) {
    of_four[k] = LoadBlocks([&](std::size_t block)
                                HWY_ATTR { return rows + 4 * static_cast<std::size_t>(index(4 * block + k)); });
  }
  return Transposed(of_four).xyz();
#endif
}

// Returns the sum over the path in each lane, which has row_count - 1 points. index(row, lane) is the number of a
// point; row 0 has the centres.
template <class IndexOf>
HWY_INLINE Lanes3 SumOfRing(const float* rows, const IndexOf& index, std::size_t row_count) {
  const auto row = [&](std::size_t r)
                       HWY_ATTR { return PointsAt(rows, [&](std::size_t lane) HWY_ATTR { return index(r, lane); }); };
  const Lanes3 centre = row(0);
  Lanes3 before = row(1);
  Lanes3 sum = {hn::Zero(kFloats), hn::Zero(kFloats), hn::Zero(kFloats)};
  std::size_t r = 2;
  for (; r + 1 < row_count; r += 2) {
    const Lanes3 point = row(r), after = row(r + 1);
    sum = sum + Cross(point - centre, after - before);
    before = after;
  }
  if (r < row_count) sum = sum + Cross(before - centre, row(r) - centre);
  return sum;
}

// Writes the vectors n, scaled to length 1, to the places from `place` on. Returns the number of vectors that have no
// direction.
template <ResultLayout kLayout>
HWY_INLINE std::size_t WriteUnit(const Lanes3& n, std::size_t place, const VectorView<float>& result) {
  const Floats square = Dot(n, n);
  // NaN counts as out of range.
  const auto in_range =
      hn::And(hn::Ge(square, hn::Set(kFloats, 0x1p-126f)), hn::Le(square, hn::Set(kFloats, 0x1.fffffep127f)));
  const Floats scale = hn::Div(hn::Set(kFloats, 1.0f), hn::Sqrt(square));
  Lanes3 unit = Scale(scale, n);
  std::size_t zeros = 0;
  if (HWY_UNLIKELY(!hn::AllTrue(kFloats, in_range))) {
    unit = {hn::IfThenElseZero(in_range, unit.x), hn::IfThenElseZero(in_range, unit.y),
            hn::IfThenElseZero(in_range, unit.z)};
    const auto counted = hn::FirstN(kFloats, result.count - std::min(place, result.count));
    zeros = hn::CountTrue(kFloats, hn::AndNot(in_range, counted));
  }
  Write<kLayout>(unit, place, result);
  return zeros;
}

std::size_t RingUnitNormals(const RingPoints& points, const RingSlices& all, IndexRange slices,
                            VectorView<float> result, bool stream) {
  const std::size_t row_end = all.first_row[all.count];
  return WithLayout(result, stream, [&](auto layout) HWY_ATTR {
    std::size_t zeros = 0;
    for (std::size_t s = slices.first; s < slices.end(); ++s) {
      const std::size_t first = all.first_row[s], count = all.first_row[s + 1] - first;
      const std::uint32_t* const indices = all.indices + kRingLanes * first;
      if (points.fetch && first + count + kRingRowsAhead <= row_end) {
        for (std::size_t i = 0; i < kRingLanes * count; ++i)
          hwy::Prefetch(points.rows + 4 * std::size_t{indices[kRingLanes * kRingRowsAhead + i]});
      }
      for (std::size_t lane = 0; lane < kRingLanes; lane += kLanes) {
        const auto index = [=](std::size_t r, std::size_t i) HWY_ATTR { return indices[kRingLanes * r + lane + i]; };
        zeros +=
            WriteUnit<layout()>(SumOfRing(points.rows, index, count), kRingLanes * (s - slices.first) + lane, result);
      }
    }
    return zeros;
  });
}

std::size_t TriangleUnitNormals(const RingPoints& points, const std::uint32_t* corners, std::size_t face_count,
                                IndexRange faces, VectorView<float> result, bool stream) {
  constexpr std::size_t kAhead = 4 * kRingRowsAhead;  // number of faces by which points are prefetched in advance
  return WithLayout(result, stream, [&](auto layout) HWY_ATTR {
    std::size_t zeros = 0;
    for (std::size_t i = 0; i < faces.count; i += kRingLanes) {
      const std::uint32_t* of_faces = corners + 3 * (faces.first + i);
      std::uint32_t padded[3 * kRingLanes];
      if (HWY_UNLIKELY(faces.count - i < kRingLanes)) {
        for (std::size_t k = 0; k < 3 * kRingLanes; ++k)
          padded[k] = of_faces[3 * std::min(k / 3, faces.count - i - 1) + k % 3];
        of_faces = padded;
      } else if (points.fetch && faces.first + i + kAhead + kRingLanes <= face_count) {
        for (std::size_t k = 0; k < 3 * kRingLanes; ++k)
          hwy::Prefetch(points.rows + 4 * std::size_t{of_faces[3 * kAhead + k]});
      }
      for (std::size_t lane = 0; lane < kRingLanes; lane += kLanes) {
        const auto index = [=](std::size_t r, std::size_t l) HWY_ATTR { return of_faces[3 * (lane + l) + r]; };
        zeros += WriteUnit<layout()>(SumOfRing(points.rows, index, 3), i + lane, result);
      }
    }
    return zeros;
  });
}

void InterpolatePoints(VectorView<const float> from, VectorView<const float> to, float s, float t, IndexRange points,
                       float* result) {
  std::size_t v = points.first;
#if HWY_TARGET != HWY_SCALAR
  if (from.is_packed() && to.is_packed()) {
    // Packed points are loaded as kLanes floats. Of every four lanes of a row, the first three get the coordinates of a
    // point.
    constexpr std::size_t kRows = kLanes / 4;
    alignas(64) std::int32_t place[kLanes];
    for (std::size_t i = 0; i < kLanes; ++i)
      place[i] = static_cast<std::int32_t>(i / 4 * 3 + std::min<std::size_t>(i % 4, 2));
    const auto places = hn::SetTableIndices(kFloats, place);
    const Floats start = hn::Set(kFloats, s), end = hn::Set(kFloats, t);
    const std::size_t last = std::min(points.end(), from.count - std::min(from.count, kRows));
    for (; v + kRows <= last; v += kRows, result += kLanes) {
      const Floats a = hn::Mul(start, hn::LoadU(kFloats, from.x + 3 * v));
      const Floats b = hn::Mul(end, hn::LoadU(kFloats, to.x + 3 * v));
      hn::StoreU(hn::TableLookupLanes(hn::Add(a, b), places), kFloats, result);
    }
  }
#endif
  for (; v < points.end(); ++v, result += 4) {
    const Vec3f a = from[v], b = to[v];
    result[0] = s * a.x + t * b.x;
    result[1] = s * a.y + t * b.y;
    result[2] = result[3] = s * a.z + t * b.z;
  }
}

}  // namespace chronormal::inline internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace chronormal::inline internal {

HWY_EXPORT(RingUnitNormals);
HWY_EXPORT(TriangleUnitNormals);
HWY_EXPORT(InterpolatePoints);

void interpolate_points(VectorView<const float> from, VectorView<const float> to, float s, float t, IndexRange points,
                        float* result) noexcept {
  assert(points.end() <= from.count && points.end() <= to.count);
  HWY_DYNAMIC_DISPATCH(InterpolatePoints)(from, to, s, t, points, result);
}

std::size_t ring_unit_normals(const RingPoints& points, const RingSlices& all, IndexRange slices,
                              VectorView<float> result, bool stream) noexcept {
  assert(0 < slices.count && slices.end() <= all.count);
  assert(result.count <= kRingLanes * slices.count && kRingLanes * slices.count < result.count + kRingLanes);
  return HWY_DYNAMIC_DISPATCH(RingUnitNormals)(points, all, slices, result, stream);
}

std::size_t triangle_unit_normals(const RingPoints& points, const std::uint32_t* corners, std::size_t face_count,
                                  IndexRange faces, VectorView<float> result, bool stream) noexcept {
  assert(0 < faces.count && faces.end() <= face_count && result.count == faces.count);
  return HWY_DYNAMIC_DISPATCH(TriangleUnitNormals)(points, corners, face_count, faces, result, stream);
}

}  // namespace chronormal::inline internal
#endif  // HWY_ONCE
