// Computes sine, cosine and arc tangent for any scalar type: a float, or a vector of floats.
//
// This file is included once for each instruction set, outside of any namespace. A scalar S is constructed from a
// float, has + - * / and comparisons that give a mask, and these functions, which the compiler finds by their
// arguments:
//
//     select(mask, a, b)      a where the mask holds, b elsewhere
//     absolute(a), larger_of(a, b), smaller_of(a, b)
//     has_low_bit(s)          a mask: whether the lowest bit of the representation of s is set
//     negated_by_bit_1(s, v)  v with its sign changed where the second lowest bit of s is set
//     next_bits(s)            the representation plus one, as if it were an integer

#include "simd/highway-inl.h"

#include <cstdint>

#include "core/bits.h"
#include "simd/trigonometry.h"

#if defined(CHRONORMAL_SIMD_TRIGONOMETRY_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CHRONORMAL_SIMD_TRIGONOMETRY_INL_H_
#undef CHRONORMAL_SIMD_TRIGONOMETRY_INL_H_
#else
#define CHRONORMAL_SIMD_TRIGONOMETRY_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace chronormal::inline internal::HWY_NAMESPACE {

// The next functions are for scalars with comparisons that return bool.
template <class S>
HWY_INLINE S select(bool mask, const S& a, const S& b) {
  return mask ? a : b;
}

HWY_INLINE float absolute(float a) { return bit_cast<float>(bit_cast<std::uint32_t>(a) & 0x7FFFFFFF); }
HWY_INLINE float larger_of(float a, float b) { return a > b ? a : b; }
HWY_INLINE float smaller_of(float a, float b) { return a < b ? a : b; }

HWY_INLINE bool has_low_bit(float s) { return (bit_cast<std::uint32_t>(s) & 1) != 0; }
HWY_INLINE float negated_by_bit_1(float s, float v) {
  return bit_cast<float>(bit_cast<std::uint32_t>(v) ^ (bit_cast<std::uint32_t>(s) & 2) << 30);
}
HWY_INLINE float next_bits(float s) { return bit_cast<float>(bit_cast<std::uint32_t>(s) + 1); }

template <class S>
HWY_INLINE SinCos<S> sin_cos(const S& x) {
  // The argument x is reduced to r in [-pi/4, pi/4] with x = quarter * pi/2 + r. pi/2 is split into two parts, the
  // first of which has 8 bits, so that the error of r is at most 1e-10. Adding 3 * 2^22 rounds a float to an integer,
  // and leaves this integer in the lowest bits.
  const S shift(12582912.0f);
  const S shifted = x * S(0.636619772f) + shift;
  const S quarter = shifted - shift;
  const S r = (x - quarter * S(1.5703125f)) - quarter * S(4.8382679490e-4f);

  const S z = r * r;
  const S s = r + r * z * (S(-0.16666664662f) + z * (S(0.00833274827f) + z * S(-0.00019587891f)));
  const S c = S(1.0f) - S(0.5f) * z + z * z * (S(0.04166666466f) + z * (S(-0.00138883030f) + z * S(2.454794e-5f)));

  const auto swap = has_low_bit(shifted);
  return {negated_by_bit_1(shifted, select(swap, c, s)), negated_by_bit_1(next_bits(shifted), select(swap, s, c))};
}

template <class S>
HWY_INLINE S upper_angle(const S& y, const S& x) {
  // First the arc tangent of a quotient in [0, 1] is computed; quotients above tan(pi/8) are reduced once more. The
  // octant of the vector then gives the angle.
  const S zero(0.0f);
  const S ax = absolute(x), larger = larger_of(y, ax), smaller = smaller_of(y, ax);
  const auto steep = y > ax;
  const auto fold = smaller > S(0.41421357f) * larger;
  const S numerator = select(fold, smaller - larger, smaller);
  const S denominator = select(fold, smaller + larger, larger);
  const S r = numerator / select(denominator > zero, denominator, S(1.0f));

  const S z = r * r;
  const S polynomial =
      r + r * z *
              (S(-0.3333333176f) +
               z * (S(0.1999954048f) + z * (S(-0.1426395560f) + z * (S(0.1074373147f) + z * S(-0.0645192816f)))));
  const S octant = select(fold, polynomial + S(0.785398163f), polynomial);
  const S quadrant = select(steep, S(1.570796327f) - octant, octant);
  return select(x < zero, S(3.141592654f) - quadrant, quadrant);
}

}  // namespace chronormal::inline internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // CHRONORMAL_SIMD_TRIGONOMETRY_INL_H_
