// Finds the smallest and the largest of a list of indices.
//
// This file is included once for each instruction set, as lanes-inl.h is.

#include "simd/highway-inl.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "chronormal/core/views.h"
#include "simd/lanes-inl.h"

#if defined(CHRONORMAL_SIMD_INDEX_RANGE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CHRONORMAL_SIMD_INDEX_RANGE_INL_H_
#undef CHRONORMAL_SIMD_INDEX_RANGE_INL_H_
#else
#define CHRONORMAL_SIMD_INDEX_RANGE_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace chronormal::inline internal::HWY_NAMESPACE {

using IndexTag = hn::RebindToUnsigned<FloatTag>;

inline constexpr IndexTag kIndices;

// Returns the range from the smallest to the largest index. Precondition: count > 0.
HWY_INLINE IndexRange RangeOf(const std::uint32_t* indices, std::size_t count) {
  std::uint32_t first = indices[0], last = indices[0];
  std::size_t i = 0;
  if (count >= kLanes) {
    auto low = hn::LoadU(kIndices, indices), high = low;
    for (; i + kLanes <= count; i += kLanes) {
      const auto v = hn::LoadU(kIndices, indices + i);
      low = hn::Min(low, v);
      high = hn::Max(high, v);
    }
    first = hn::GetLane(hn::MinOfLanes(kIndices, low));
    last = hn::GetLane(hn::MaxOfLanes(kIndices, high));
  }
  for (; i < count; ++i) {
    first = std::min(first, indices[i]);
    last = std::max(last, indices[i]);
  }
  return {first, std::size_t{last} - first + 1};
}

}  // namespace chronormal::inline internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // CHRONORMAL_SIMD_INDEX_RANGE_INL_H_
