// Finds the degrees of sixteen elements. SetDegrees() does so in double, like degree() in control_normals.h.
// SetDegreesByFloats() does so in float32, and only if all degrees are certainly 2.
//
// This file is included once for each instruction set, as lanes-inl.h is.

#include "simd/highway-inl.h"

#include <cstddef>
#include <cstdint>

#include "normals/control/kernels/control_tile.h"
#include "normals/control/kernels/exact_tile.h"
#include "normals/control/kernels/triangles-inl.h"
#include "normals/control/polygon_normals.h"

#if defined(CHRONORMAL_NORMALS_CONTROL_KERNELS_TILE_DEGREES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CHRONORMAL_NORMALS_CONTROL_KERNELS_TILE_DEGREES_INL_H_
#undef CHRONORMAL_NORMALS_CONTROL_KERNELS_TILE_DEGREES_INL_H_
#else
#define CHRONORMAL_NORMALS_CONTROL_KERNELS_TILE_DEGREES_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace chronormal::inline internal::HWY_NAMESPACE {

// Sets the degrees of a tile to 2 and returns true if float32 alone proves that all degrees are 2. The error of float32
// in n0 - 2 m + n1 is below 2^-20 of the largest component. In most motions, n0 - 2 m + n1 is larger than this error,
// which is far above the tolerance of degree().
HWY_INLINE bool SetDegreesByFloats(ControlTile& tile) {
  const Floats share = hn::Set(kFloats, 0x1p-19f), smallest_size = hn::Set(kFloats, 0x1p-100f);
  bool all = true;
  for (std::size_t lane = 0; lane < kTile; lane += kLanes) {
    const auto load = [&tile, lane](std::size_t k) HWY_ATTR {
      return Lanes3{hn::Load(kFloats, tile.normals[k] + lane), hn::Load(kFloats, tile.normals[k + 1] + lane),
                    hn::Load(kFloats, tile.normals[k + 2] + lane)};
    };
    const Lanes3 n0 = load(0), m = load(3), n1 = load(6);
    const Floats size = MaxAbs(n0, m, n1);
    const Floats bend = MaxAbs((n0 - m) + (n1 - m));
    all &= hn::AllTrue(kFloats, hn::And(hn::Gt(bend, hn::Mul(share, size)), hn::Gt(size, smallest_size)));
    hn::Store(hn::Set(kInts, 2), kInts, tile.degree + lane);
  }
  return all;
}

// Returns the error of a sum of `products` products in float32, relative to the absolute products (docs/theory.md,
// section 13). The error includes the roundings of each product and of its additions to the sum.
HWY_INLINE Floats RoundingsInFloat(std::size_t products) {
  return hn::Set(kFloats, 0x1p-24f * static_cast<float>(products + 5));
}

// The control normals of some elements in float32, with one element per lane.
struct FloatControlLanes {
  Lanes3 n0, m, n1;
};

// Stores control normals in float32, with a bound of the error of their components as magnitude. The degree is 0 if all
// three control normals are the same, and 2 if the curve bends by more than eight times this bound. Otherwise the
// degree is 1, and the bound is increased by a quarter of the bend and some roundings.
HWY_INLINE void StoreInFloat(const FloatControlLanes& c, Floats error, std::size_t lane, ControlTile& tile) {
  std::size_t k = 0;
  for (const Lanes3* v : {&c.n0, &c.m, &c.n1}) {
    hn::Store(v->x, kFloats, tile.normals[k] + lane);
    hn::Store(v->y, kFloats, tile.normals[k + 1] + lane);
    hn::Store(v->z, kFloats, tile.normals[k + 2] + lane);
    k += 3;
  }
  const Lanes3 before = c.n0 - c.m, after = c.n1 - c.m;
  const Floats zero = hn::Zero(kFloats), one = hn::Set(kFloats, 1.0f), two = hn::Set(kFloats, 2.0f);
  const auto moves = hn::Gt(MaxAbs(before, after), zero);
  const auto bends = hn::Gt(MaxAbs(before + after), hn::Mul(hn::Set(kFloats, 8.0f), error));
  const Floats errors = hn::IfThenElse(hn::AndNot(bends, moves), hn::Set(kFloats, 3.5f), one);
  hn::Store(hn::Mul(errors, error), kFloats, tile.magnitude + lane);
  const Floats degree = hn::IfThenElse(bends, two, hn::IfThenElseZero(moves, one));
  hn::Store(hn::ConvertTo(kInts, degree), kInts, tile.degree + lane);
}

HWY_NOINLINE inline void SetDegrees(const ExactTile& exact, ControlTile& tile) {
  const Doubles share = hn::Set(kDoubles, kDegreeTolerance);
  for (std::size_t lane = 0; lane < kTile; lane += kDoubleLanes) {
    const auto load = [&exact, lane](std::size_t k) HWY_ATTR {
      return Doubles3{hn::Load(kDoubles, exact.normals[k] + lane), hn::Load(kDoubles, exact.normals[k + 1] + lane),
                      hn::Load(kDoubles, exact.normals[k + 2] + lane)};
    };
    const Doubles3 n0 = load(0), m = load(3), n1 = load(6);
    const Doubles tolerance = hn::Mul(share, MaxAbs(n0, m, n1));
    const Doubles one = hn::Set(kDoubles, 1.0), two = hn::Set(kDoubles, 2.0);
    const Doubles at_most_1 = hn::IfThenElseZero(hn::Gt(MaxAbs(n1 - n0), tolerance), one);
    const Doubles degree = hn::IfThenElse(hn::Gt(MaxAbs((n0 - m) + (n1 - m)), tolerance), two, at_most_1);
    const hn::Rebind<std::int32_t, DoubleTag> half_ints;
    hn::StoreU(hn::DemoteTo(half_ints, degree), half_ints, tile.degree + lane);
  }
}

}  // namespace chronormal::inline internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // CHRONORMAL_NORMALS_CONTROL_KERNELS_TILE_DEGREES_INL_H_
