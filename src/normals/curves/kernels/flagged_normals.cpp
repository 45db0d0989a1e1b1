// Evaluates sixteen flagged elements, for which float32 is not accurate enough, in lanes of double.
#include "normals/curves/kernels/flagged_normals.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "normals/curves/kernels/flagged_normals.cpp"
#include "simd/foreach_target-inl.h"
#include "simd/highway-inl.h"

#include "simd/intrinsics-inl.h"
#include "simd/lanes-inl.h"
#include "simd/rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace chronormal::inline internal::HWY_NAMESPACE {

// Returns n(t) of kDoubleLanes elements, with the operations of normal_at().
HWY_INLINE Doubles3 NormalsAt(const FlaggedTile& tile, std::size_t lane, Doubles w0, Doubles w1, Doubles w2) {
  const auto vector = [&tile, lane](std::size_t k) HWY_ATTR {
    return Doubles3{hn::Load(kDoubles, tile.normals[k] + lane), hn::Load(kDoubles, tile.normals[k + 1] + lane),
                    hn::Load(kDoubles, tile.normals[k + 2] + lane)};
  };
  return (Scale(w0, vector(0)) + Scale(w1, vector(3))) + Scale(w2, vector(6));
}

void FlaggedUnitNormals(const FlaggedTile* tiles, std::size_t count, double s, double t, FlaggedUnits* results) {
  const double weights[3] = {s * s, 2 * t * s, t * t};
  const Doubles w0 = hn::Set(kDoubles, weights[0]), w1 = hn::Set(kDoubles, weights[1]),
                w2 = hn::Set(kDoubles, weights[2]);
  for (std::size_t i = 0; i < count; ++i) {
    const FlaggedTile& tile = tiles[i];
    results[i].uncertain = 0;
    for (std::size_t lane = 0; lane < kTile; lane += kLanes) {
      const Doubles3 lower = NormalsAt(tile, lane, w0, w1, w2);
      const Lanes3 u = Joined(lower, NormalsAt(tile, lane + kLanes - kDoubleLanes, w0, w1, w2));
      const Floats largest = hn::Max(hn::Max(hn::Abs(u.x), hn::Abs(u.y)), hn::Abs(u.z));
      Floats limit = hn::Zero(kFloats);
      for (std::size_t k = 0; k < 3; ++k) {
        const Floats weight = hn::Set(kFloats, static_cast<float>(weights[k]));
        limit = hn::Add(limit, hn::Mul(weight, hn::Load(kFloats, tile.limits[k] + lane)));
      }
      const auto certain = hn::Gt(largest, limit);
      results[i].uncertain |= BitsOf(kFloats, hn::Not(certain)) << lane;
      // An element with an uncertain direction may have the zero vector here. The positive minimum avoids a division by
      // zero.
      const Floats square = hn::Max(Dot(u, u), hn::Set(kFloats, 0x1p-100f));
      StorePacked<false>(Scale(hn::Div(hn::Set(kFloats, 1.0f), hn::Sqrt(square)), u), results[i].xyz + 3 * lane);
    }
  }
}

}  // namespace chronormal::inline internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace chronormal::inline internal {

HWY_EXPORT(FlaggedUnitNormals);

FlaggedNormals FlaggedNormals::scaled(const ControlNormals& c, double certain) noexcept {
  const double sizes[3] = {max_abs(c.n0), max_abs(c.m), max_abs(c.n1)};
  const double largest = std::max({sizes[0], sizes[1], sizes[2]});
  // The exponent is limited, so that the power of two and its inverse are both normal numbers.
  constexpr int kMost = 1022;
  const bool in_range = largest >= 0x1p-1022 && is_finite(c.n0) && is_finite(c.m) && is_finite(c.n1);
  const int exponent = in_range ? std::min(kMost, std::ilogb(largest)) : 0;
  const double scale = std::ldexp(1.0, -exponent);
  FlaggedNormals result{{scale * c.n0, scale * c.m, scale * c.n1}, {}, static_cast<std::int16_t>(exponent)};
  for (std::size_t k = 0; k < 3; ++k) {
    const double limit = std::max(kLeastLimit, kLimitUp * (certain * (scale * sizes[k])));
    result.limits[k] = in_range ? static_cast<float>(limit) : std::numeric_limits<float>::infinity();
  }
  return result;
}

void flagged_unit_normals(std::span<const FlaggedTile> tiles, const LocalTime& t,
                          std::span<FlaggedUnits> results) noexcept {
  assert(results.size() >= tiles.size());
  HWY_DYNAMIC_DISPATCH(FlaggedUnitNormals)(tiles.data(), tiles.size(), t.rest, t.t, results.data());
}

}  // namespace chronormal::inline internal
#endif  // HWY_ONCE
