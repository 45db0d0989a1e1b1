// Defines vectors of doubles, which stand beside the vectors of floats, and turns rows of four floats into lanes.
//
// This file is included once for each instruction set, as lanes-inl.h is.

#include "simd/highway-inl.h"

#include <cstddef>

#include "simd/lanes-inl.h"

#if defined(CHRONORMAL_SIMD_ROWS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CHRONORMAL_SIMD_ROWS_INL_H_
#undef CHRONORMAL_SIMD_ROWS_INL_H_
#else
#define CHRONORMAL_SIMD_ROWS_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace chronormal::inline internal::HWY_NAMESPACE {

// The number of doubles in a vector. A vector of floats is converted to two vectors of doubles, or to one if it has a
// single lane (Highway's plain C++).
inline constexpr std::size_t kDoubleLanes = kLanes > 1 ? kLanes / 2 : 1;
using DoubleTag = hn::CappedTag<double, kDoubleLanes>;
using HalfFloatTag = hn::Rebind<float, DoubleTag>;
using Doubles = hn::Vec<DoubleTag>;

inline constexpr DoubleTag kDoubles;

using Doubles3 = LanesOf3<Doubles>;

// Converts the lower half (kHalf = 0) or the upper half (kHalf = 1) of the lanes to double.
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
// Highway's plain C++ rounds values beyond the range of float to the largest float. All other targets, and static_cast,
// round them to infinity.
#undef CHRONORMAL_DEMOTE_CLAMPS
#if HWY_TARGET == HWY_SCALAR || HWY_TARGET == HWY_EMU128
#define CHRONORMAL_DEMOTE_CLAMPS 1
#else
#define CHRONORMAL_DEMOTE_CLAMPS 0
#endif

// Rounds both halves of the lanes to float and joins them. All values must be in the range of float. If a vector of
// floats has a single lane, only `lower` is rounded.
HWY_INLINE Floats Joined(Doubles lower, [[maybe_unused]] Doubles upper) {
#if HWY_TARGET == HWY_SCALAR
  return hn::DemoteTo(kFloats, lower);
#else
  const HalfFloatTag half;
  return hn::Combine(kFloats, hn::DemoteTo(half, upper), hn::DemoteTo(half, lower));
#endif
}
HWY_INLINE Lanes3 Joined(const Doubles3& lower, const Doubles3& upper) {
  return {Joined(lower.x, upper.x), Joined(lower.y, upper.y), Joined(lower.z, upper.z)};
}

// Rounds kLanes doubles in memory to floats.
HWY_INLINE Floats ToFloat(const double* from) {
#if CHRONORMAL_DEMOTE_CLAMPS
  float rounded[kLanes];
  for (std::size_t i = 0; i < kLanes; ++i) rounded[i] = static_cast<float>(from[i]);
  return hn::LoadU(kFloats, rounded);
#else
  return Joined(hn::Load(kDoubles, from), hn::Load(kDoubles, from + kDoubleLanes));
#endif
}

struct Lanes4 {
  Floats x, y, z, w;

  HWY_INLINE Lanes3 xyz() const { return {x, y, z}; }
};

// The following functions Columns(row) return the columns of a matrix. Row i of the matrix, which consists of the four
// floats at row(i), becomes lane i of the columns.
#if HWY_TARGET == HWY_SCALAR

using Row = Lanes4;
HWY_INLINE Row LoadRow(const float* from) {
  return {hn::Load(kFloats, from), hn::Load(kFloats, from + 1), hn::Load(kFloats, from + 2),
          hn::Load(kFloats, from + 3)};
}
template <class RowOf>
HWY_INLINE Lanes4 Columns(const RowOf& row) {
  return row(0);
}

#else

using Row = hn::Vec<hn::FixedTag<float, 4> >;
HWY_INLINE Row LoadRow(const float* from) { return hn::LoadU(hn::FixedTag<float, 4>(), from); }

// Makes a vector from pieces of four lanes, which are 128 bits: load(b) returns piece b.
template <class LoadBlock>
HWY_INLINE Floats Blocks(const LoadBlock& load) {
  if constexpr (kLanes == 4) {
    return load(0);
  } else if constexpr (kLanes == 8) {
    return hn::Combine(kFloats, load(1), load(0));
  } else {
    const HalfFloatTag half;
    return hn::Combine(kFloats, hn::Combine(half, load(3), load(2)), hn::Combine(half, load(1), load(0)));
  }
}

// Transposes blocks of four rows. Lane i of rows[k] is from row 4 * (i / 4) + k.
HWY_INLINE Lanes4 Transposed(const Floats (&rows)[4]) {
  const auto pairs = [](Floats v) HWY_ATTR { return hn::BitCast(kDoubles, v); };
  const Doubles xy01 = pairs(hn::InterleaveLower(kFloats, rows[0], rows[1]));
  const Doubles xy23 = pairs(hn::InterleaveLower(kFloats, rows[2], rows[3]));
  const Doubles zw01 = pairs(hn::InterleaveUpper(kFloats, rows[0], rows[1]));
  const Doubles zw23 = pairs(hn::InterleaveUpper(kFloats, rows[2], rows[3]));
  return {hn::BitCast(kFloats, hn::InterleaveLower(kDoubles, xy01, xy23)),
          hn::BitCast(kFloats, hn::InterleaveUpper(kDoubles, xy01, xy23)),
          hn::BitCast(kFloats, hn::InterleaveLower(kDoubles, zw01, zw23)),
          hn::BitCast(kFloats, hn::InterleaveUpper(kDoubles, zw01, zw23))};
}

template <class RowOf>
HWY_INLINE Lanes4 Columns(const RowOf& row) {
  Floats rows[4];
  for (std::size_t k = 0; k < 4; ++k)
    rows[k] = Blocks([&row, k](std::size_t block) HWY_ATTR { return row(4 * block + k); });
  return Transposed(rows);
}

#endif

// Rounds four doubles to a row of four floats.
HWY_INLINE Row RoundedRow(const double* from) {
#if CHRONORMAL_DEMOTE_CLAMPS
  float rounded[4];
  for (std::size_t c = 0; c < 4; ++c) rounded[c] = static_cast<float>(from[c]);
  return LoadRow(rounded);
#elif HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3
  return hn::DemoteTo(hn::FixedTag<float, 4>(), hn::LoadU(hn::FixedTag<double, 4>(), from));
#else
  const hn::FixedTag<double, 2> pair;
  const hn::FixedTag<float, 2> two;
  return hn::Combine(hn::FixedTag<float, 4>(), hn::DemoteTo(two, hn::LoadU(pair, from + 2)),
                     hn::DemoteTo(two, hn::LoadU(pair, from)));
#endif
}

}  // namespace chronormal::inline internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
