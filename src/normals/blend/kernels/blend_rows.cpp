// Adds multiples of rows to other rows, one row at a time. Computes unit normals in lanes of double, with one element
// per lane.
#include "normals/blend/kernels/blend_rows.h"

#include <algorithm>
#include <array>
#include <bit>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "normals/blend/kernels/blend_rows.cpp"
#include "simd/foreach_target-inl.h"
#include "simd/highway-inl.h"

#include "core/rounding.h"
#include "normals/blend/index_bits.h"
#include "simd/double_rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace chronormal::inline internal::HWY_NAMESPACE {

HWY_INLINE double* RowAt(double* rows, std::size_t i) { return rows + kBlendLanes * i; }
HWY_INLINE const double* RowAt(const double* rows, std::size_t i) { return rows + kBlendLanes * i; }

void AddTargetRows(std::span<const std::uint32_t> elements, const float* coefficients, const RowWeights& linear,
                   const RowWeights& square, std::size_t first, double* rows) {
  const DoubleRow a = LoadDoubleRow(linear.data()), c = LoadDoubleRow(square.data());
  for (const std::uint32_t e : elements) {
    double* const row = RowAt(rows, e - first);
    const DoubleRow term = a * LoadDoubleRow(coefficients) + c * LoadDoubleRow(coefficients + kBlendLanes);
    StoreDoubleRow(LoadDoubleRow(row) + term, row);
    coefficients += 2 * kBlendLanes;
  }
}

void AddPairRows(std::span<const std::uint32_t> elements, const float* coefficients, const RowWeights& weight,
                 std::size_t first, double* rows) {
  const DoubleRow c = LoadDoubleRow(weight.data());
  for (const std::uint32_t e : elements) {
    double* const row = RowAt(rows, e - first);
    StoreDoubleRow(LoadDoubleRow(row) + c * LoadDoubleRow(coefficients), row);
    coefficients += kBlendLanes;
  }
}

// Loads three floats as the row x y z 0, without reading beyond the third float.
HWY_INLINE DoubleRow LoadLastThree(const float* from) {
  const float row[kBlendLanes] = {from[0], from[1], from[2], 0};
  return LoadDoubleRow(row);
}

// Returns a row that multiplies x, y and z by a factor and the fourth component by 0. The result is for rows whose
// fourth float belongs to the next vector in memory.
HWY_INLINE DoubleRow ThreeTimes(double factor) {
  const double row[kBlendLanes] = {factor, factor, factor, 0};
  return LoadDoubleRow(row);
}

void MovePoints(std::span<const std::uint32_t> vertices, const float* deltas, double weight, double* points) {
  if (vertices.empty()) return;
  const DoubleRow w = ThreeTimes(weight);
  const std::size_t last = vertices.size() - 1;
  for (std::size_t i = 0; i < last; ++i) {
    double* const point = RowAt(points, vertices[i]);
    StoreDoubleRow(LoadDoubleRow(point) + w * LoadDoubleRow(deltas + 3 * i), point);
  }
  double* const point = RowAt(points, vertices[last]);
  StoreDoubleRow(LoadDoubleRow(point) + w * LoadLastThree(deltas + 3 * last), point);
}

void ResetPoints(std::span<const float> base, IndexRange vertices, double* points) {
  if (vertices.count == 0) return;
  const DoubleRow one = ThreeTimes(1);
  const std::size_t last = vertices.end() - 1;
  for (std::size_t v = vertices.first; v < last; ++v)
    StoreDoubleRow(one * LoadDoubleRow(base.data() + 3 * v), RowAt(points, v));
  StoreDoubleRow(LoadLastThree(base.data() + 3 * last), RowAt(points, last));
}

HWY_INLINE void MoveFloatPoint(const float* delta, float weight, float* point) {
  for (std::size_t k = 0; k < 3; ++k) point[k] += weight * delta[k];
}

void MoveFloatPoints(std::span<const std::uint32_t> vertices, const float* deltas, float weight, float* points) {
  if (vertices.empty()) return;
  const std::size_t last = vertices.size() - 1;
#if HWY_TARGET == HWY_SCALAR
  for (std::size_t i = 0; i < last; ++i)
    MoveFloatPoint(deltas + 3 * i, weight, points + kBlendLanes * std::size_t{vertices[i]});
#else
  // The fourth component of a point must not change. The fourth float of a loaded row of deltas belongs to the next
  // delta, so its factor is 0.
  const hn::FixedTag<float, 4> tag;
  const float factors[4] = {weight, weight, weight, 0};
  const auto w = hn::LoadU(tag, factors);
  for (std::size_t i = 0; i < last; ++i) {
    float* const point = points + kBlendLanes * std::size_t{vertices[i]};
    hn::Store(hn::Add(hn::Load(tag, point), hn::Mul(w, hn::LoadU(tag, deltas + 3 * i))), tag, point);
  }
#endif
  MoveFloatPoint(deltas + 3 * last, weight, points + kBlendLanes * std::size_t{vertices[last]});
}

void ResetFloatPoints(std::span<const float> base, IndexRange vertices, float* points) {
  for (std::size_t v = vertices.first; v < vertices.end(); ++v) {
    float* const point = points + kBlendLanes * v;
    for (std::size_t k = 0; k < 3; ++k) point[k] = base[3 * v + k];
    point[3] = 0;
  }
}

HWY_INLINE Doubles Squared(Doubles v) { return hn::Mul(v, v); }

// Writes n / |n| for kDoubleLanes elements from `first` on, as far as their bits are set in `elements`. Returns the
// bits of those elements whose n or error is beyond the limits.
HWY_INLINE std::uint32_t WriteUnit(const Doubles3& n, Doubles error, std::size_t first, std::uint32_t elements,
                                   const UnitLimits& limits, const VectorView<float>& result) {
  const Doubles square = Dot(n, n);
  // Both comparisons are false for NaN, so NaN counts as beyond the limits.
  const auto is_usual = hn::And(hn::Ge(square, hn::Set(kDoubles, limits.smallest_square)),
                                hn::Le(square, hn::Set(kDoubles, limits.largest_square)));
  const Doubles most = hn::Mul(hn::Set(kDoubles, limits.largest_error * limits.largest_error), square);
  const std::uint32_t good = elements & BitsOf(kDoubles, hn::And(is_usual, hn::Le(Squared(error), most)));
  const Doubles3 unit = Scale(hn::Div(hn::Set(kDoubles, 1.0), hn::Sqrt(square)), n);
  alignas(64) double x[kDoubleLanes], y[kDoubleLanes], z[kDoubleLanes];
  hn::Store(unit.x, kDoubles, x);
  hn::Store(unit.y, kDoubles, y);
  hn::Store(unit.z, kDoubles, z);
  for (std::uint32_t left = good; left != 0; left &= left - 1) {
    const auto i = static_cast<std::size_t>(std::countr_zero(left));
    result.set(first + i, {static_cast<float>(x[i]), static_cast<float>(y[i]), static_cast<float>(z[i])});
  }
  return elements & ~good;
}

// Calls body(first, bits) for each group of kDoubleLanes elements of a word, if at least one of their bits is set.
// Returns the bits that the calls returned, at their places in the word.
template <class Body>
HWY_INLINE std::uint64_t ForLanesOfWord(std::uint64_t elements, const Body& body) {
  constexpr std::uint64_t kAll = (std::uint64_t{1} << kDoubleLanes) - 1;
  std::uint64_t result = 0;
  for (std::size_t lane = 0; lane < kBitsOfWord; lane += kDoubleLanes) {
    const auto bits = static_cast<std::uint32_t>(elements >> lane & kAll);
    if (bits != 0) result |= std::uint64_t{body(lane, bits)} << lane;
  }
  return result;
}

std::uint64_t UnitNormalsOfRows(std::uint64_t elements, std::size_t place, const double* rows, const UnitLimits& limits,
                                const VectorView<float>& result) {
  return ForLanesOfWord(elements, [&](std::size_t lane, std::uint32_t bits) HWY_ATTR {
    const std::size_t first = kBitsOfWord * place + lane;
    // No row after that of the last element may be read, so the row of the last element is read again.
    const std::size_t last = result.count - 1;
    const DoubleColumns n =
        ColumnsOfDoubles([=](std::size_t i) HWY_ATTR { return RowAt(rows, std::min(first + i, last)); });
    return WriteUnit(n.xyz, n.w, first, bits, limits, result);
  });
}

// The factors of the error bound of unit_normals_of_rings() (blend_rows.h). An object returns the bound for m, which is
// the largest component of the edges of a path and of half the distances between neighbours whose products are added.
struct RingError {
  double of_square, of_edge, alone;

  RingError(std::size_t point_count, double moved) {
    const auto c = static_cast<double>(point_count);
    of_square = 9 * kUnitRoundoff * (10 + c) * (c - 2);
    of_edge = 3 * moved * (2 * c - 3);
    alone = c * moved * moved;
  }
  HWY_INLINE Doubles operator()(Doubles edge) const {
    const Doubles products = hn::Mul(hn::Set(kDoubles, of_square), Squared(edge));
    return hn::Add(hn::Add(products, hn::Mul(hn::Set(kDoubles, of_edge), edge)), hn::Set(kDoubles, alone));
  }
};

std::uint64_t UnitNormalsOfRings(const RingSlices& slices, std::uint64_t elements, std::size_t place,
                                 const double* points, double moved, const UnitLimits& limits,
                                 const VectorView<float>& result) {
  return ForLanesOfWord(elements, [&](std::size_t lane, std::uint32_t bits) HWY_ATTR {
    const std::size_t first = kBitsOfWord * place + lane, slice = first / kRingLanes;
    const std::size_t row_count = slices.first_row[slice + 1] - slices.first_row[slice];
    const std::uint32_t* indices = slices.indices + kRingLanes * slices.first_row[slice] + first % kRingLanes;
    const auto next_row = [&]() HWY_ATTR {
      const std::uint32_t* const row = indices;
      indices += kRingLanes;
      return ColumnsOfDoubles([=](std::size_t i) HWY_ATTR { return RowAt(points, row[i]); }).xyz;
    };
    // If an edge has a NaN, the sum is NaN, and `largest` does not matter.
    const Doubles3 centre = next_row();
    Doubles3 before = next_row();
    const auto largest_of = [](const Doubles3& v) HWY_ATTR { return LargerAbs(LargerAbs(v.x, v.y), v.z); };
    Doubles largest = hn::Zero(kDoubles);
    Doubles3 sum = {hn::Zero(kDoubles), hn::Zero(kDoubles), hn::Zero(kDoubles)};
    std::size_t r = 2;
    for (; r + 1 < row_count; r += 2) {
      const Doubles3 edge = next_row() - centre, after = next_row(), between = after - before;
      sum = sum + Cross(edge, between);
      largest = hn::Max(largest, hn::Max(largest_of(edge), hn::Mul(hn::Set(kDoubles, 0.5), largest_of(between))));
      before = after;
    }
    if (r < row_count) {
      const Doubles3 edge = before - centre, last = next_row() - centre;
      sum = sum + Cross(edge, last);
      largest = hn::Max(largest, hn::Max(largest_of(edge), largest_of(last)));
    }
    return WriteUnit(sum, RingError(row_count, moved)(largest), first, bits, limits, result);
  });
}

}  // namespace chronormal::inline internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace chronormal::inline internal {

HWY_EXPORT(AddTargetRows);
HWY_EXPORT(AddPairRows);
HWY_EXPORT(MovePoints);
HWY_EXPORT(ResetPoints);
HWY_EXPORT(MoveFloatPoints);
HWY_EXPORT(ResetFloatPoints);
HWY_EXPORT(UnitNormalsOfRows);
HWY_EXPORT(UnitNormalsOfRings);

void add_target_rows(std::span<const std::uint32_t> elements, const float* coefficients, const RowWeights& linear,
                     const RowWeights& square, std::size_t first, double* rows) noexcept {
  HWY_DYNAMIC_DISPATCH(AddTargetRows)(elements, coefficients, linear, square, first, rows);
}

void add_pair_rows(std::span<const std::uint32_t> elements, const float* coefficients, const RowWeights& weight,
                   std::size_t first, double* rows) noexcept {
  HWY_DYNAMIC_DISPATCH(AddPairRows)(elements, coefficients, weight, first, rows);
}

void move_points(std::span<const std::uint32_t> vertices, const float* deltas, double weight, double* points) noexcept {
  HWY_DYNAMIC_DISPATCH(MovePoints)(vertices, deltas, weight, points);
}

void reset_points(std::span<const float> base, IndexRange vertices, double* points) noexcept {
  HWY_DYNAMIC_DISPATCH(ResetPoints)(base, vertices, points);
}

void move_points(std::span<const std::uint32_t> vertices, const float* deltas, float weight, float* points) noexcept {
  HWY_DYNAMIC_DISPATCH(MoveFloatPoints)(vertices, deltas, weight, points);
}

void reset_points(std::span<const float> base, IndexRange vertices, float* points) noexcept {
  HWY_DYNAMIC_DISPATCH(ResetFloatPoints)(base, vertices, points);
}

std::uint64_t unit_normals_of_rows(std::uint64_t elements, std::size_t place, const double* rows,
                                   const UnitLimits& limits, VectorView<float> result) noexcept {
  return HWY_DYNAMIC_DISPATCH(UnitNormalsOfRows)(elements, place, rows, limits, result);
}

std::uint64_t unit_normals_of_rings(const RingSlices& slices, std::uint64_t elements, std::size_t place,
                                    const double* points, double moved, const UnitLimits& limits,
                                    VectorView<float> result) noexcept {
  return HWY_DYNAMIC_DISPATCH(UnitNormalsOfRings)(slices, elements, place, points, moved, limits, result);
}

}  // namespace chronormal::inline internal
#endif  // HWY_ONCE
