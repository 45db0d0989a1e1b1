// Finds the angle of a vector in lanes of double. The result has the same bits as that of portable::atan2() for y >= 0.
// This file also defines the type Real, with which formulas for lanes look the same as for one number.
//
// This file is included once for each instruction set, as lanes-inl.h is. The polynomial is that of Highway for the arc
// tangent on [0, 1]. The operations are in the same order but never fused, as in core/portable_math for one number.

#include "simd/highway-inl.h"

#include <cstddef>
#include <cstdint>

#include "simd/rows-inl.h"

#if defined(CHRONORMAL_SIMD_ANGLES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CHRONORMAL_SIMD_ANGLES_INL_H_
#undef CHRONORMAL_SIMD_ANGLES_INL_H_
#else
#define CHRONORMAL_SIMD_ANGLES_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace chronormal::inline internal::HWY_NAMESPACE {

// A double for each of kDoubleLanes elements. Every operation is one IEEE operation on each double.
struct Real {
  Doubles v;

  Real() = default;
  // The following two constructors convert implicitly on purpose, so that a formula that mixes lanes and numbers reads
  // like a formula with double.
  HWY_INLINE Real(Doubles of_v) : v(of_v) {}                      // NOLINT(google-explicit-constructor)
  HWY_INLINE Real(double value) : v(hn::Set(kDoubles, value)) {}  // NOLINT(google-explicit-constructor)
  static HWY_INLINE Real load(const double* from) { return hn::LoadU(kDoubles, from); }
  HWY_INLINE void store(double* to) const { hn::StoreU(v, kDoubles, to); }

  friend HWY_INLINE Real operator+(Real a, Real b) { return hn::Add(a.v, b.v); }
  friend HWY_INLINE Real operator-(Real a, Real b) { return hn::Sub(a.v, b.v); }
  friend HWY_INLINE Real operator*(Real a, Real b) { return hn::Mul(a.v, b.v); }
  friend HWY_INLINE Real operator/(Real a, Real b) { return hn::Div(a.v, b.v); }
};

// The elements, one in each lane, for which a condition holds.
struct RealMask {
  hn::Mask<DoubleTag> m;

  friend HWY_INLINE RealMask operator&(RealMask a, RealMask b) { return {hn::And(a.m, b.m)}; }
  friend HWY_INLINE RealMask operator|(RealMask a, RealMask b) { return {hn::Or(a.m, b.m)}; }
  friend HWY_INLINE RealMask operator!(RealMask a) { return {hn::Not(a.m)}; }
};

HWY_INLINE RealMask operator<(Real a, Real b) { return {hn::Lt(a.v, b.v)}; }
HWY_INLINE RealMask operator>(Real a, Real b) { return {hn::Gt(a.v, b.v)}; }
HWY_INLINE RealMask operator==(Real a, Real b) { return {hn::Eq(a.v, b.v)}; }

HWY_INLINE Real select(RealMask mask, Real a, Real b) { return hn::IfThenElse(mask.m, a.v, b.v); }
HWY_INLINE bool any(RealMask mask) { return !hn::AllFalse(kDoubles, mask.m); }
HWY_INLINE Real sqrt(Real a) { return hn::Sqrt(a.v); }
HWY_INLINE Real absolute(Real a) { return hn::Abs(a.v); }
// Return the larger and the smaller of two numbers in each lane, or b if one of the two is NaN.
HWY_INLINE Real larger_of(Real a, Real b) { return select(a > b, a, b); }
HWY_INLINE Real smaller_of(Real a, Real b) { return select(a < b, a, b); }
// Returns the lanes in which the sign bit is set, also for -0.
HWY_INLINE RealMask has_sign(Real a) {
  const hn::RebindToSigned<DoubleTag> bits;
  return {hn::RebindMask(kDoubles, hn::Lt(hn::BitCast(bits, a.v), hn::Zero(bits)))};
}

struct Real3 {
  Real x, y, z;

  friend HWY_INLINE Real3 operator+(const Real3& a, const Real3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend HWY_INLINE Real3 operator-(const Real3& a, const Real3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend HWY_INLINE Real3 operator*(Real s, const Real3& a) { return {s * a.x, s * a.y, s * a.z}; }
};

HWY_INLINE Real dot(const Real3& a, const Real3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
HWY_INLINE Real3 cross(const Real3& a, const Real3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
// Returns the largest absolute component. Components that are NaN are ignored, as in core/vec3.h.
HWY_INLINE Real max_abs(const Real3& a) {
  const Real x = absolute(a.x), y = absolute(a.y), z = absolute(a.z);
  const Real largest = larger_of(z, larger_of(y, x));
  const Real of_two = larger_of(z, y);
  return select(largest == largest, largest, select(of_two == of_two, of_two, z));
}

// Returns the arc tangent of q, which must be in [0, 1].
HWY_INLINE Real arc_tangent(Real q) {
  const Real x = q * q, x2 = x * x, x4 = x2 * x2, x8 = x4 * x4, x16 = x8 * x8;
  const auto pair = [x](double c0, double c1) HWY_ATTR { return Real(c1) * x + Real(c0); };
  const auto four = [x2](Real low, Real high) HWY_ATTR { return x2 * high + low; };
  const Real c0 = four(pair(-0.333333333333311110369124, +0.199999999996591265594148),
                       pair(-0.14285714266771329383765, +0.111111105648261418443745));
  const Real c4 = four(pair(-0.090908995008245008229153, +0.0769219538311769618355029),
                       pair(-0.0666573579361080525984562, +0.0587666392926673580854313));
  const Real c8 = four(pair(-0.0523674852303482457616113, +0.0466667150077840625632675),
                       pair(-0.0407629191276836500001934, +0.0337852580001353069993897));
  const Real c12 = four(pair(-0.0254517624932312641616861, +0.016599329773529201970117),
                        pair(-0.00889896195887655491740809, +0.00370026744188713119232403));
  const Real c16 =
      four(pair(-0.00110611831486672482563471, +0.000209850076645816976906797), Real(-1.88796008463073496563746e-5));
  const Real series = x16 * c16 + (x8 * (x4 * c12 + c8) + (x4 * c4 + c0));
  return series * (x * q) + q;
}

// Returns the angle in radians of the vector (x, y) with y >= 0, in [0, pi]. The angle of the zero vector is 0, or pi
// if x is -0. If x or y is not finite, the result is NaN.
HWY_INLINE Real upper_angle(Real y, Real x) {
  const Real ax = absolute(x);
  const RealMask steep = y > ax;
  const Real larger = select(steep, y, ax), smaller = select(steep, ax, y);
  const Real angle = arc_tangent(smaller / select(larger == Real(0.0), Real(1.0), larger));
  const Real upright = select(steep, Real(1.57079632679489661923132169) - angle, angle);
  return select(has_sign(x), Real(3.14159265358979323846) - upright, upright);
}

}  // namespace chronormal::inline internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // CHRONORMAL_SIMD_ANGLES_INL_H_
