#include "normals/curves/kernels/flagged_normals.h"

#include <algorithm>
#include <cassert>
#include <cstdint>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "normals/curves/kernels/flagged_normals.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace chronormal::inline internal::HWY_NAMESPACE {

using DoubleTag = hn::CappedTag<double, 8>;
using Doubles = hn::Vec<DoubleTag>;
inline constexpr DoubleTag kDoubles;
inline constexpr std::size_t kDoubleLanes = hn::MaxLanes(DoubleTag());

struct DoubleLanes3 {
  Doubles x, y, z;
};

HWY_INLINE Doubles LargestOf(const DoubleLanes3& v) {
  return hn::Max(hn::Max(hn::Abs(v.x), hn::Abs(v.y)), hn::Abs(v.z));
}

HWY_INLINE DoubleLanes3 Weighted(Doubles w, const DoubleLanes3& v) {
  return {hn::Mul(w, v.x), hn::Mul(w, v.y), hn::Mul(w, v.z)};
}

HWY_INLINE DoubleLanes3 Sum(const DoubleLanes3& a, const DoubleLanes3& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}

// Unit normals of the regular lanes, with n(t) operation by operation as normal_at() has it; returns which are, as
// bits.
std::uint32_t RegularUnitNormals(const double* planes, std::size_t stride, double t, double* result) {
  const double s = 1 - t;
  const auto vector = [=](std::size_t k) HWY_ATTR {
    const double* const p = planes + 3 * k * stride;
    return DoubleLanes3{hn::Load(kDoubles, p), hn::Load(kDoubles, p + stride), hn::Load(kDoubles, p + 2 * stride)};
  };
  const Doubles w0 = hn::Set(kDoubles, s * s), w1 = hn::Set(kDoubles, 2 * t * s), w2 = hn::Set(kDoubles, t * t);
  const DoubleLanes3 n0 = vector(0), m = vector(1), n1 = vector(2);
  const DoubleLanes3 n = Sum(Sum(Weighted(w0, n0), Weighted(w1, m)), Weighted(w2, n1));
  const Doubles size =
      hn::Add(hn::Add(hn::Mul(w0, LargestOf(n0)), hn::Mul(w1, LargestOf(m))), hn::Mul(w2, LargestOf(n1)));
  const Doubles largest = LargestOf(n), certain = hn::Load(kDoubles, planes + 9 * stride);
  const auto regular = hn::Gt(largest, hn::Mul(certain, size));

  // Against the largest component, so that squares stay in range.
  const Doubles divisor = hn::IfThenElse(regular, largest, hn::Set(kDoubles, 1.0));
  const DoubleLanes3 u{hn::Div(n.x, divisor), hn::Div(n.y, divisor), hn::Div(n.z, divisor)};
  const Doubles square = hn::Add(hn::Add(hn::Mul(u.x, u.x), hn::Mul(u.y, u.y)), hn::Mul(u.z, u.z));
  const Doubles length = hn::Sqrt(hn::IfThenElse(regular, square, hn::Set(kDoubles, 1.0)));
  hn::Store(hn::Div(u.x, length), kDoubles, result);
  hn::Store(hn::Div(u.y, length), kDoubles, result + stride);
  hn::Store(hn::Div(u.z, length), kDoubles, result + 2 * stride);
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(kDoubles, regular, bits);
  return bits[0] & ((1u << kDoubleLanes) - 1);
}

std::size_t FlaggedUnitNormals(const FlaggedNormals* normals, std::size_t count, double t, Vec3f* result,
                               std::uint32_t* doubtful) {
  std::size_t doubtful_count = 0;
  for (std::size_t first = 0; first < count; first += kDoubleLanes) {
    const std::size_t part = std::min(kDoubleLanes, count - first);
    alignas(64) double planes[10][kDoubleLanes], units[3][kDoubleLanes];
    for (std::size_t lane = 0; lane < kDoubleLanes; ++lane) {
      const auto& [c, certain] = normals[first + std::min(lane, part - 1)];
      std::size_t plane = 0;
      for (const Vec3d* const v : {&c.n0, &c.m, &c.n1}) {
        planes[plane++][lane] = v->x;
        planes[plane++][lane] = v->y;
        planes[plane++][lane] = v->z;
      }
      planes[plane][lane] = certain;
    }
    const std::uint32_t regular = RegularUnitNormals(planes[0], kDoubleLanes, t, units[0]);
    for (std::size_t lane = 0; lane < part; ++lane) {
      Vec3f& to = result[first + lane];
      to = {static_cast<float>(units[0][lane]), static_cast<float>(units[1][lane]), static_cast<float>(units[2][lane])};
      if ((regular >> lane & 1) == 0) doubtful[doubtful_count++] = static_cast<std::uint32_t>(first + lane);
    }
  }
  return doubtful_count;
}

}  // namespace chronormal::inline internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace chronormal::inline internal {

HWY_EXPORT(FlaggedUnitNormals);

std::size_t flagged_unit_normals(std::span<const FlaggedNormals> normals, double t, std::span<Vec3f> result,
                                 std::span<std::uint32_t> doubtful) noexcept {
  assert(result.size() == normals.size() && doubtful.size() >= normals.size());
  return HWY_DYNAMIC_DISPATCH(FlaggedUnitNormals)(normals.data(), normals.size(), t, result.data(), doubtful.data());
}

}  // namespace chronormal::inline internal
#endif  // HWY_ONCE
