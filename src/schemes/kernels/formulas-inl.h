// The formulas of schemes. Each formula is written once, as a template on its scalar. With Lanes it computes, and with
// Counting its operations are counted (scalars-inl.h).
//
// A formula is a class with static functions, which are templates on the scalar S, and with the number of planes that
// it reads (0 means all planes):
//
//     kPlanes, kStatePlanes
//     Triple<S> evaluate(const Coefficients<S>& c, const float* shared)    returns the unit normals at one t; `shared`
//                                                                          has what all elements have in common there
//     Triple<S> advance(const Coefficients<S>& c, const State<S>& state)   returns the unit normals of the state, and
//                                                                          advances it by a step
//
// Code for lanes does not branch. Results that depend on the element are selected, and a rare case is skipped if no
// lane has it. Coefficients that are zero give (0, 0, 0).

#include "simd/highway-inl.h"

#include <cstddef>

#include "schemes/kernels/scalars-inl.h"
#include "simd/trigonometry-inl.h"

#if defined(CHRONORMAL_SCHEMES_KERNELS_FORMULAS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CHRONORMAL_SCHEMES_KERNELS_FORMULAS_INL_H_
#undef CHRONORMAL_SCHEMES_KERNELS_FORMULAS_INL_H_
#else
#define CHRONORMAL_SCHEMES_KERNELS_FORMULAS_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace chronormal::inline internal::HWY_NAMESPACE {

// Returns v scaled to length 1, or `fallback` if v is nearly zero, which happens when opposite unit vectors cancel.
template <class S>
HWY_INLINE Triple<S> normalized_or(const Triple<S>& v, const Triple<S>& fallback) {
  const S square = dot(v, v);
  const auto has_length = square > S(1e-16f);
  const S scale = S(1.0f) / sqrt(select(has_length, square, S(1.0f)));
  return select(has_length, scale * v, fallback);
}

// The sum of kCount vectors times shared weights, scaled to length 1. If kCount is 0, all vectors of the element are
// added. If the sum vanishes, because opposite ends meet in the middle, the result is the first vector.
template <std::size_t kCount>
struct WeightedSum {
  static constexpr std::size_t kPlanes = 3 * kCount, kStatePlanes = 3 * kCount;

  template <class S>
  static HWY_INLINE Triple<S> evaluate(const Coefficients<S>& c, const float* weights) {
    const std::size_t count = kCount > 0 ? kCount : c.plane_count / 3;
    const Triple<S> first = vector_of(c, 0);
    Triple<S> sum = S(weights[0]) * first;
    for (std::size_t k = 1; k < count; ++k) sum = sum + S(weights[k]) * vector_of(c, k);
    return normalized_or(sum, first);
  }

  // Returns the unit vector of the state, which is the sum and its forward differences, and advances the state by one
  // step.
  template <class S>
  static HWY_INLINE Triple<S> advance(const Coefficients<S>& c, const State<S>& state) {
    const Triple<S> here = vector_of(state, 0);
    Triple<S> difference = here;
    for (std::size_t k = 0; k + 1 < kCount; ++k) {
      const Triple<S> next = vector_of(state, k + 1);
      set_vector(state, k, difference + next);
      difference = next;
    }
    return normalized_or(here, vector_of(c, 0));
  }
};

// The scheme rational (eq. 3 of the paper): three quadratics over the root of a quartic, whose coefficients are in the
// planes 9 to 13.
struct RationalQuadratic {
  static constexpr std::size_t kPlanes = 14;

  template <class S>
  static HWY_INLINE Triple<S> evaluate(const Coefficients<S>& c, const float* weights) {
    const Triple<S> n =
        S(weights[0]) * vector_of(c, 0) + S(weights[1]) * vector_of(c, 1) + S(weights[2]) * vector_of(c, 2);
    S square = S(weights[3]) * c[9];
    for (std::size_t k = 1; k < 5; ++k) square = square + S(weights[3 + k]) * c[9 + k];
    // If the quartic is below a tenth of its largest coefficient, too few of its digits are correct. The length of n is
    // then computed from n itself.
    const auto has_digits = square > S(0.1f);
    const Triple<S> u = (S(1.0f) / sqrt(select(has_digits, square, S(1.0f)))) * n;
    if (!any(!has_digits)) return u;
    const Triple<S> start = normalized_or(vector_of(c, 0), vector_of(c, 0));
    return select(has_digits, u, normalized_or(n, start));
  }
};

// Returns the sine and cosine of the current angle, and advances the angle by one step, which is a rotation. The state
// has cosine and sine of the angle on the arc, and of the angle of one step. The Chebyshev recurrence x' = 2 cos(step)
// x - x'' would need no sine, but loses digits a hundred times faster.
template <class S>
HWY_INLINE SinCos<S> advance_turn(const State<S>& state) {
  const S cosine = state[0], sine = state[1], step_cosine = state[2], step_sine = state[3];
  state.set(0, cosine * step_cosine - sine * step_sine);
  state.set(1, sine * step_cosine + cosine * step_sine);
  return {sine, cosine};
}

// An arc of a great circle, u(t) = cos(t A) u0 + sin(t A) q. Its planes are u0, q, A.
struct GreatArc {
  static constexpr std::size_t kPlanes = 7, kStatePlanes = 4;

  template <class S>
  static HWY_INLINE Triple<S> evaluate(const Coefficients<S>& c, const float* t) {
    return point(c, sin_cos(S(t[0]) * c[6]));
  }

  template <class S>
  static HWY_INLINE Triple<S> advance(const Coefficients<S>& c, const State<S>& state) {
    return point(c, advance_turn(state));
  }

  template <class S>
  static HWY_INLINE Triple<S> point(const Coefficients<S>& c, const SinCos<S>& angle) {
    return angle.cos * vector_of(c, 0) + angle.sin * vector_of(c, 1);
  }
};

// An arc of any circle on the sphere (eq. 7). Its planes are w, p, q, A.
struct CircleArc {
  static constexpr std::size_t kPlanes = 10, kStatePlanes = 4;

  template <class S>
  static HWY_INLINE Triple<S> evaluate(const Coefficients<S>& c, const float* t) {
    return point(c, sin_cos(S(t[0]) * c[9]));
  }

  template <class S>
  static HWY_INLINE Triple<S> advance(const Coefficients<S>& c, const State<S>& state) {
    return point(c, advance_turn(state));
  }

  template <class S>
  static HWY_INLINE Triple<S> point(const Coefficients<S>& c, const SinCos<S>& angle) {
    return vector_of(c, 0) + angle.cos * vector_of(c, 1) + angle.sin * vector_of(c, 2);
  }
};

// An arc of any circle that has turned by a given share of its angle at t = 1/2. Plane 10 has this share; the other
// planes are those of CircleArc.
struct TimedCircleArc {
  static constexpr std::size_t kPlanes = 11;

  template <class S>
  static HWY_INLINE Triple<S> evaluate(const Coefficients<S>& c, const float* shared_t) {
    const S t(shared_t[0]), share = c[10];
    const S numerator = share * t, rest = (S(1.0f) - share) * (S(1.0f) - t);
    const S sum = numerator + rest;
    const S warped = numerator / select(sum > S(0.0f), sum, S(1.0f));
    return CircleArc::point(c, sin_cos(warped * c[9]));
  }
};

// Turns the unit vector a about a fixed perpendicular by the share t of half a turn. This is slerp from a to -a.
template <class S>
HWY_INLINE Triple<S> half_turn_at(const Triple<S>& a, const S& t) {
  const S zero(0.0f), one(1.0f);
  const auto along_x = a.x * a.x > S(0.5f);
  const Triple<S> other = select(along_x, cross(a, Triple<S>{zero, one, zero}), cross(a, Triple<S>{one, zero, zero}));
  const SinCos<S> turn = sin_cos(t * S(3.14159265f));
  return turn.cos * a + turn.sin * normalized_or(other, a);
}

// Interpolates by slerp between two unit vectors that are only known at run time. Antipodal vectors turn about a fixed
// perpendicular.
template <class S>
HWY_INLINE Triple<S> slerp_at(const Triple<S>& a, const Triple<S>& b, const S& t) {
  const Triple<S> normal = cross(a, b);
  const S sine = sqrt(dot(normal, normal)), cosine = dot(a, b);
  const SinCos<S> turn = sin_cos(t * upper_angle(sine, cosine));
  const S b_weight = turn.sin / sine;
  const Triple<S> slerp = (turn.cos - b_weight * cosine) * a + b_weight * b;

  // For angles below 1e-4 rad, the chord is used, which differs from the arc by less than rounding. For such angles,
  // the quotient above may be 0 / 0.
  const auto aligned = sine < S(1e-4f);
  if (!any(aligned)) return slerp;
  const auto opposite = !(cosine > S(0.0f));
  const Triple<S> chord = select(aligned, lerp(a, b, t), slerp);
  if (!any(select(opposite, sine, S(1.0f)) < S(1e-4f))) return chord;
  const Triple<S> far = select(sine < S(1e-6f), half_turn_at(a, t), slerp);
  return select(opposite, far, chord);
}

// De Casteljau's triangular scheme over all vectors of an element, with slerp in place of every linear interpolation.
struct SphericalDeCasteljau {
  static constexpr std::size_t kPlanes = 0;

  template <class S>
  static HWY_INLINE Triple<S> evaluate(const Coefficients<S>& c, const float* shared_t) {
    const std::size_t count = c.plane_count / 3;
    const S t(shared_t[0]);
    Triple<S> row[kMaxDeCasteljauNormals];
    for (std::size_t k = 0; k < count; ++k) row[k] = vector_of(c, k);
    for (std::size_t left = count - 1; left > 0; --left) {
      for (std::size_t k = 0; k < left; ++k) row[k] = slerp_at(row[k], row[k + 1], t);
    }
    return normalized_or(row[0], vector_of(c, 0));
  }
};

}  // namespace chronormal::inline internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // CHRONORMAL_SCHEMES_KERNELS_FORMULAS_INL_H_
