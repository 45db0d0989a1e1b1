// Loads and stores rows of four doubles, and turns one row for each lane into columns. A row is a vector x y z with a
// fourth number, at any place in memory.
//
// This file is included once for each instruction set, as lanes-inl.h is.

#include "simd/highway-inl.h"

#include <cstddef>

#include "simd/intrinsics-inl.h"
#include "simd/lanes-inl.h"
#include "simd/rows-inl.h"

#if defined(CHRONORMAL_SIMD_DOUBLE_ROWS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CHRONORMAL_SIMD_DOUBLE_ROWS_INL_H_
#undef CHRONORMAL_SIMD_DOUBLE_ROWS_INL_H_
#else
#define CHRONORMAL_SIMD_DOUBLE_ROWS_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace chronormal::inline internal::HWY_NAMESPACE {

// The number of doubles of a row that are in one register. A row takes one register if a register holds four doubles,
// otherwise two, or four if Highway is plain C++.
inline constexpr std::size_t kRowStep = kDoubleLanes < 4 ? kDoubleLanes : 4;
using DoubleRowTag = hn::CappedTag<double, kRowStep>;

struct DoubleRow {
  hn::Vec<DoubleRowTag> parts[4 / kRowStep];
};

// Makes a row from its registers: part(i) returns register i.
template <class PartOf>
HWY_INLINE DoubleRow MakeRow(const PartOf& part) {
  DoubleRow row;
  for (std::size_t i = 0; i < 4 / kRowStep; ++i) row.parts[i] = part(i);
  return row;
}

HWY_INLINE DoubleRow LoadDoubleRow(const double* from) {
  return MakeRow([from](std::size_t i) HWY_ATTR { return hn::LoadU(DoubleRowTag(), from + kRowStep * i); });
}
// Loads four floats and converts them to a row of doubles.
HWY_INLINE DoubleRow LoadDoubleRow(const float* from) {
  return MakeRow([from](std::size_t i) HWY_ATTR {
    const hn::Rebind<float, DoubleRowTag> some;
    return hn::PromoteTo(DoubleRowTag(), hn::LoadU(some, from + kRowStep * i));
  });
}
HWY_INLINE void StoreDoubleRow(const DoubleRow& row, double* to) {
  for (std::size_t i = 0; i < 4 / kRowStep; ++i) hn::StoreU(row.parts[i], DoubleRowTag(), to + kRowStep * i);
}

HWY_INLINE DoubleRow operator+(const DoubleRow& a, const DoubleRow& b) {
  return MakeRow([&](std::size_t i) HWY_ATTR { return hn::Add(a.parts[i], b.parts[i]); });
}
HWY_INLINE DoubleRow operator*(const DoubleRow& a, const DoubleRow& b) {
  return MakeRow([&](std::size_t i) HWY_ATTR { return hn::Mul(a.parts[i], b.parts[i]); });
}

struct DoubleColumns {
  Doubles3 xyz;
  Doubles w;
};

// Returns the four columns of a matrix whose row i is at row(i). Lane i of a column is from row i.
template <class RowOf>
HWY_INLINE DoubleColumns ColumnsOfDoubles(const RowOf& row) {
#if HWY_TARGET == HWY_SCALAR
  const double* const r = row(0);
  return {{hn::Load(kDoubles, r), hn::Load(kDoubles, r + 1), hn::Load(kDoubles, r + 2)}, hn::Load(kDoubles, r + 3)};
#else
  if constexpr (kDoubleLanes == 2) {
    const double *const r0 = row(0), *const r1 = row(1);
    const Doubles xy0 = hn::LoadU(kDoubles, r0), xy1 = hn::LoadU(kDoubles, r1);
    const Doubles zw0 = hn::LoadU(kDoubles, r0 + 2), zw1 = hn::LoadU(kDoubles, r1 + 2);
    return {{hn::InterleaveLower(kDoubles, xy0, xy1), hn::InterleaveUpper(kDoubles, xy0, xy1),
             hn::InterleaveLower(kDoubles, zw0, zw1)},
            hn::InterleaveUpper(kDoubles, zw0, zw1)};
  } else if constexpr (kDoubleLanes > 4 && HWY_TARGET != HWY_AVX3) {
    alignas(64) double columns[4][kDoubleLanes];
    for (std::size_t i = 0; i < kDoubleLanes; ++i)
      for (std::size_t c = 0; c < 4; ++c) columns[c][i] = row(i)[c];
    return {{hn::Load(kDoubles, columns[0]), hn::Load(kDoubles, columns[1]), hn::Load(kDoubles, columns[2])},
            hn::Load(kDoubles, columns[3])};
  } else {
    Doubles rows[4];  // rows 0 to 3; or, with vectors of eight doubles, 0 and 2, 1 and 3, 4 and 6, 5 and 7
    for (std::size_t k = 0; k < 4; ++k) rows[k] = LoadTransposable(row, k);
    const Doubles xz0 = hn::InterleaveLower(kDoubles, rows[0], rows[1]);
    const Doubles xz1 = hn::InterleaveLower(kDoubles, rows[2], rows[3]);
    const Doubles yw0 = hn::InterleaveUpper(kDoubles, rows[0], rows[1]);
    const Doubles yw1 = hn::InterleaveUpper(kDoubles, rows[2], rows[3]);
    return {{EvenPairs(xz0, xz1), EvenPairs(yw0, yw1), OddPairs(xz0, xz1)}, OddPairs(yw0, yw1)};
  }
#endif
}

}  // namespace chronormal::inline internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // CHRONORMAL_SIMD_DOUBLE_ROWS_INL_H_
