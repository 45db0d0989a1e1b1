// Evaluates sixteen flagged elements in lanes of double.
#include "normals/curves/kernels/flagged_normals.h"

#include <cassert>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "normals/curves/kernels/flagged_normals.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "simd/intrinsics-inl.h"
#include "simd/lanes-inl.h"
#include "simd/rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace chronormal::inline internal::HWY_NAMESPACE {

HWY_INLINE Doubles LargestOf(const Doubles3& v) { return LargerAbs(LargerAbs(v.x, v.y), v.z); }

// The inverse of the power of two below a number, so that their product is exact, and at least 1 and below 4; of numbers
// below the normal ones, the largest such inverse.
HWY_INLINE Doubles InversePowerBelow(Doubles v) {
  const hn::RebindToSigned<DoubleTag> ints;
  const Doubles bounded = hn::Min(v, hn::Set(kDoubles, 0x1p1022));  // 2^-1023 would not be a normal number
  const auto exponent = hn::And(hn::BitCast(ints, bounded), hn::Set(ints, std::int64_t{0x7FF} << 52));
  return hn::BitCast(kDoubles, hn::Sub(hn::Set(ints, std::int64_t{0x7FE} << 52), exponent));
}

// Vectors of a tile, in planes.
struct alignas(64) FlaggedVectors {
  float x[kTile], y[kTile], z[kTile];
};

// Writes n(t), scaled, and returns for which elements it is not certain, as bits. With the operations of normal_at().
HWY_INLINE std::uint32_t Evaluate(const FlaggedTile& tile, double t, FlaggedVectors& result) {
  const double s = 1 - t;
  const Doubles w0 = hn::Set(kDoubles, s * s), w1 = hn::Set(kDoubles, 2 * t * s), w2 = hn::Set(kDoubles, t * t);
  std::uint32_t uncertain = 0;
  for (std::size_t lane = 0; lane < kTile; lane += kDoubleLanes) {
    const auto vector = [&tile, lane](std::size_t k) HWY_ATTR {
      return Doubles3{hn::Load(kDoubles, tile.normals[k] + lane), hn::Load(kDoubles, tile.normals[k + 1] + lane),
                      hn::Load(kDoubles, tile.normals[k + 2] + lane)};
    };
    const Doubles3 n0 = vector(0), m = vector(3), n1 = vector(6);
    const Doubles3 n = (Scale(w0, n0) + Scale(w1, m)) + Scale(w2, n1);
    const Doubles size =
        hn::Add(hn::Add(hn::Mul(w0, LargestOf(n0)), hn::Mul(w1, LargestOf(m))), hn::Mul(w2, LargestOf(n1)));
    const Doubles largest = LargestOf(n);
    const auto certain = hn::Gt(largest, hn::Mul(hn::Load(kDoubles, tile.certain + lane), size));

    // Times a power of two, so that float32 has all of it in range, and carries on from here.
    const Doubles3 u = Scale(InversePowerBelow(largest), n);
    const HalfFloatTag floats;
    hn::Store(hn::DemoteTo(floats, u.x), floats, result.x + lane);
    hn::Store(hn::DemoteTo(floats, u.y), floats, result.y + lane);
    hn::Store(hn::DemoteTo(floats, u.z), floats, result.z + lane);
    uncertain |= BitsOf(kDoubles, hn::Not(certain)) << lane;
  }
  return uncertain;
}

HWY_INLINE void Normalize(const FlaggedVectors& vectors, float* xyz) {
  for (std::size_t lane = 0; lane < kTile; lane += kLanes) {
    const Lanes3 u{hn::Load(kFloats, vectors.x + lane), hn::Load(kFloats, vectors.y + lane),
                   hn::Load(kFloats, vectors.z + lane)};
    // The vector of an element that is not certain may be zero, and is divided by something else then.
    const Floats square = hn::Max(Dot(u, u), hn::Set(kFloats, 0x1p-100f));
    StorePacked<false>(Scale(hn::Div(hn::Set(kFloats, 1.0f), hn::Sqrt(square)), u), xyz + 3 * lane);
  }
}

// Each pass over a few tiles, so that no load waits for the store of a shorter vector.
void FlaggedUnitNormals(const FlaggedTile* tiles, std::size_t count, double t, FlaggedUnits* results) {
  constexpr std::size_t kAtOnce = 4;
  FlaggedVectors vectors[kAtOnce];
  for (std::size_t first = 0; first < count; first += kAtOnce) {
    const std::size_t some = HWY_MIN(kAtOnce, count - first);
    for (std::size_t i = 0; i < some; ++i) results[first + i].uncertain = Evaluate(tiles[first + i], t, vectors[i]);
    for (std::size_t i = 0; i < some; ++i) Normalize(vectors[i], results[first + i].xyz);
  }
}

}  // namespace chronormal::inline internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace chronormal::inline internal {

HWY_EXPORT(FlaggedUnitNormals);

void flagged_unit_normals(std::span<const FlaggedTile> tiles, double t, std::span<FlaggedUnits> results) noexcept {
  assert(results.size() >= tiles.size());
  HWY_DYNAMIC_DISPATCH(FlaggedUnitNormals)(tiles.data(), tiles.size(), t, results.data());
}

}  // namespace chronormal::inline internal
#endif  // HWY_ONCE
