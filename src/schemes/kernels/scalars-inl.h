// The types in which the formulas of schemes are written: a scalar S, vectors of three S, and the planes of an element.
//
// S is Lanes, which computes, or Counting, which counts operations, so that each formula is written once. This file is
// included once for each instruction set, outside of any namespace.

#include "simd/highway-inl.h"

#include <cstddef>

#include "schemes/counting.h"
#include "schemes/kernels/curve_kernels.h"
#include "simd/lanes-inl.h"

#if defined(CHRONORMAL_SCHEMES_KERNELS_SCALARS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CHRONORMAL_SCHEMES_KERNELS_SCALARS_INL_H_
#undef CHRONORMAL_SCHEMES_KERNELS_SCALARS_INL_H_
#else
#define CHRONORMAL_SCHEMES_KERNELS_SCALARS_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace chronormal::inline internal::HWY_NAMESPACE {

// The number of elements that one step evaluates, which is as many as two vectors hold. If a formula is a long chain of
// operations, such as a sine, a processor with only one vector at a time cannot look far enough ahead to stay busy.
inline constexpr std::size_t kStep = 2 * kLanes;

// A number for each of kStep elements. Every operation is one IEEE operation on each number.
struct Lanes {
  Floats low, high;

  Lanes() = default;
  HWY_INLINE Lanes(Floats of_low, Floats of_high) : low(of_low), high(of_high) {}
  explicit HWY_INLINE Lanes(float value) : low(hn::Set(kFloats, value)), high(low) {}

  friend HWY_INLINE Lanes operator+(const Lanes& a, const Lanes& b) {
    return {hn::Add(a.low, b.low), hn::Add(a.high, b.high)};
  }
  friend HWY_INLINE Lanes operator-(const Lanes& a, const Lanes& b) {
    return {hn::Sub(a.low, b.low), hn::Sub(a.high, b.high)};
  }
  friend HWY_INLINE Lanes operator*(const Lanes& a, const Lanes& b) {
    return {hn::Mul(a.low, b.low), hn::Mul(a.high, b.high)};
  }
  friend HWY_INLINE Lanes operator/(const Lanes& a, const Lanes& b) {
    return {hn::Div(a.low, b.low), hn::Div(a.high, b.high)};
  }
  friend HWY_INLINE Lanes sqrt(const Lanes& a) { return {hn::Sqrt(a.low), hn::Sqrt(a.high)}; }
};

// The elements for which a condition holds. For the scalar Counting, a bool takes the place of this mask.
struct LanesMask {
  hn::Mask<FloatTag> low, high;
};

HWY_INLINE LanesMask operator<(const Lanes& a, const Lanes& b) {
  return {hn::Lt(a.low, b.low), hn::Lt(a.high, b.high)};
}
HWY_INLINE LanesMask operator>(const Lanes& a, const Lanes& b) {
  return {hn::Gt(a.low, b.low), hn::Gt(a.high, b.high)};
}
HWY_INLINE LanesMask operator!(const LanesMask& a) { return {hn::Not(a.low), hn::Not(a.high)}; }

HWY_INLINE Lanes select(const LanesMask& mask, const Lanes& a, const Lanes& b) {
  return {hn::IfThenElse(mask.low, a.low, b.low), hn::IfThenElse(mask.high, a.high, b.high)};
}

// Return true if a condition holds for any of the elements. Callers use these functions to skip rare cases, which never
// changes a result.
HWY_INLINE bool any(const LanesMask& mask) { return !hn::AllFalse(kFloats, hn::Or(mask.low, mask.high)); }
HWY_INLINE bool any(bool mask) { return mask; }

// The functions of Lanes that simd/trigonometry-inl.h needs. That file documents what they must do.
HWY_INLINE Lanes absolute(const Lanes& a) { return {hn::Abs(a.low), hn::Abs(a.high)}; }
HWY_INLINE Lanes larger_of(const Lanes& a, const Lanes& b) { return {hn::Max(a.low, b.low), hn::Max(a.high, b.high)}; }
HWY_INLINE Lanes smaller_of(const Lanes& a, const Lanes& b) { return {hn::Min(a.low, b.low), hn::Min(a.high, b.high)}; }
HWY_INLINE LanesMask has_low_bit(const Lanes& s) {
  const auto mask = [](Floats bits) HWY_ATTR {
    return hn::RebindMask(kFloats, hn::TestBit(hn::BitCast(kInts, bits), hn::Set(kInts, 1)));
  };
  return {mask(s.low), mask(s.high)};
}
HWY_INLINE Lanes negated_by_bit_1(const Lanes& s, const Lanes& v) {
  const auto negated = [](Floats bits, Floats value) HWY_ATTR {
    const Ints sign = hn::ShiftLeft<30>(hn::And(hn::BitCast(kInts, bits), hn::Set(kInts, 2)));
    return hn::Xor(value, hn::BitCast(kFloats, sign));
  };
  return {negated(s.low, v.low), negated(s.high, v.high)};
}
HWY_INLINE Lanes next_bits(const Lanes& s) {
  const auto next = [](Floats bits)
                        HWY_ATTR { return hn::BitCast(kFloats, hn::Add(hn::BitCast(kInts, bits), hn::Set(kInts, 1))); };
  return {next(s.low), next(s.high)};
}

// A vector of three components. (Vec3 of core/vec3.h is compiled without an instruction set, so its components cannot
// be lanes.)
template <class S>
struct Triple {
  S x, y, z;
};

template <class S>
HWY_INLINE Triple<S> operator+(const Triple<S>& a, const Triple<S>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class S>
HWY_INLINE Triple<S> operator*(const S& s, const Triple<S>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <class S>
HWY_INLINE S dot(const Triple<S>& a, const Triple<S>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class S>
HWY_INLINE Triple<S> cross(const Triple<S>& a, const Triple<S>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class S>
HWY_INLINE Triple<S> lerp(const Triple<S>& a, const Triple<S>& b, const S& t) {
  return (S(1.0f) - t) * a + t * b;
}
HWY_INLINE Triple<Lanes> select(const LanesMask& mask, const Triple<Lanes>& a, const Triple<Lanes>& b) {
  return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}

// Reads the coefficients of the current elements, one value per plane.
template <class S>
struct Coefficients {
  const S* first;
  std::size_t plane_count;

  HWY_INLINE S operator[](std::size_t plane) const { return first[plane]; }
};

// Reads and writes the values that change from step to step while a curve is played, one value per plane.
template <class S>
struct State {
  S* first;

  HWY_INLINE S operator[](std::size_t plane) const { return first[plane]; }
  HWY_INLINE void set(std::size_t plane, const S& value) const { first[plane] = value; }
};

// The specialisations for Lanes read from a block (curve_kernels.h).
template <>
struct Coefficients<Lanes> {
  const float* first;
  std::size_t plane_count;

  HWY_INLINE Lanes operator[](std::size_t plane) const {
    const float* p = first + plane * kBlock;
    return {hn::Load(kFloats, p), hn::Load(kFloats, p + kLanes)};
  }
};

template <>
struct State<Lanes> {
  float* first;

  HWY_INLINE Lanes operator[](std::size_t plane) const { return Coefficients<Lanes>{first, 0}[plane]; }
  HWY_INLINE void set(std::size_t plane, const Lanes& value) const {
    float* p = first + plane * kBlock;
    hn::Store(value.low, kFloats, p);
    hn::Store(value.high, kFloats, p + kLanes);
  }
};

// Returns the vector that is stored in the planes 3k, 3k + 1, 3k + 2.
template <template <class> class Planes, class S>
HWY_INLINE Triple<S> vector_of(const Planes<S>& planes, std::size_t k) {
  return {planes[3 * k], planes[3 * k + 1], planes[3 * k + 2]};
}

template <class S>
HWY_INLINE void set_vector(const State<S>& state, std::size_t k, const Triple<S>& v) {
  state.set(3 * k, v.x);
  state.set(3 * k + 1, v.y);
  state.set(3 * k + 2, v.z);
}

}  // namespace chronormal::inline internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // CHRONORMAL_SCHEMES_KERNELS_SCALARS_INL_H_
