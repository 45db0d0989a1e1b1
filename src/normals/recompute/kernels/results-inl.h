// Writes unit normals from lanes to the memory of the caller: packed, packed and past the caches, as planes, or one by
// one. Also lists the elements whose normals are not reliable.
//
// This file is included once for each instruction set, as lanes-inl.h is.

#include "simd/highway-inl.h"

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "chronormal/core/views.h"
#include "simd/intrinsics-inl.h"
#include "simd/lanes-inl.h"

#if defined(CHRONORMAL_NORMALS_RECOMPUTE_KERNELS_RESULTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CHRONORMAL_NORMALS_RECOMPUTE_KERNELS_RESULTS_INL_H_
#undef CHRONORMAL_NORMALS_RECOMPUTE_KERNELS_RESULTS_INL_H_
#else
#define CHRONORMAL_NORMALS_RECOMPUTE_KERNELS_RESULTS_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace chronormal::inline internal::HWY_NAMESPACE {

// Appends to `doubtful` the places of the lanes that are not trusted.
HWY_INLINE std::size_t Append(hn::Mask<FloatTag> trusted, std::size_t first, std::size_t end, std::size_t count,
                              std::uint32_t* doubtful) {
  if (HWY_LIKELY(hn::AllTrue(kFloats, trusted))) return count;
  alignas(64) float flags[kLanes];
  hn::Store(hn::IfThenElseZero(trusted, hn::Set(kFloats, 1.0f)), kFloats, flags);
  for (std::size_t i = 0; i < kLanes && first + i < end; ++i) {
    if (flags[i] == 0) doubtful[count++] = static_cast<std::uint32_t>(first + i);
  }
  return count;
}

enum class ResultLayout { kPacked, kStreamed, kPlanes, kOther };

// Writes kLanes vectors to the places from `first` on. Vectors beyond the end of the result are left out.
template <ResultLayout kLayout>
HWY_INLINE void Write(const Lanes3& v, std::size_t first, const VectorView<float>& result) {
  if (HWY_LIKELY(kLayout != ResultLayout::kOther && first + kLanes <= result.count)) {
    if constexpr (kLayout == ResultLayout::kPlanes) {
      hn::StoreU(v.x, kFloats, result.x + first);
      hn::StoreU(v.y, kFloats, result.y + first);
      hn::StoreU(v.z, kFloats, result.z + first);
    } else {
      StorePacked<kLayout == ResultLayout::kStreamed>(v, result.x + 3 * first);
    }
    return;
  }
  alignas(64) float x[kLanes], y[kLanes], z[kLanes];
  hn::Store(v.x, kFloats, x);
  hn::Store(v.y, kFloats, y);
  hn::Store(v.z, kFloats, z);
  for (std::size_t i = 0; i < kLanes && first + i < result.count; ++i) result.set(first + i, {x[i], y[i], z[i]});
}

// Calls body with the layout of a result as a constant at compile time. If `stream` is true, the layout of packed
// results that are aligned is kStreamed.
template <class Body>
HWY_INLINE std::size_t WithLayout(const VectorView<float>& result, bool stream, const Body& body) {
  if (result.stride == 1) return body(std::integral_constant<ResultLayout, ResultLayout::kPlanes>());
  if (result.is_packed()) {
    if (stream && reinterpret_cast<std::uintptr_t>(result.x) % 64 == 0)
      return body(std::integral_constant<ResultLayout, ResultLayout::kStreamed>());
    return body(std::integral_constant<ResultLayout, ResultLayout::kPacked>());
  }
  return body(std::integral_constant<ResultLayout, ResultLayout::kOther>());
}

}  // namespace chronormal::inline internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // CHRONORMAL_NORMALS_RECOMPUTE_KERNELS_RESULTS_INL_H_
