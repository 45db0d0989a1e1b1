// Searches for the arc with the least mean error. Let h be half the angle between u0 and u1. An arc about axis(phi)
// turns by twice beta, with
//
//     tan(beta)^2 = tan(h)^2 + y^2,  y = tan(h) tan(phi),
//
// and on a small part of the sphere, the distance between the middle of the arc and the middle of the chord is g = y /
// (1 + sqrt(1 + y^2)), in units of half the chord. The search is for g, since positions along the arc are nearly linear
// in g, up to half a turn, at which g = 1.
#include "schemes/kernels/optimal_arcs.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "schemes/kernels/optimal_arcs.cpp"
#include "simd/foreach_target-inl.h"
#include "simd/highway-inl.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <limits>

#include "core/portable_math.h"
#include "simd/angles-inl.h"

HWY_BEFORE_NAMESPACE();
namespace chronormal::inline internal::HWY_NAMESPACE {

inline constexpr std::size_t kIntervals = 20;  // number of intervals between samples, as in ExactSamples
// The search ends if a better arc could gain at most this fraction of the mean error.
inline constexpr double kGain = 1e-4;
inline constexpr double kNoError = 1e-10;  // an angle in radians; if the mean error is smaller, there is no search
inline constexpr double kLargestG = 0.77;  // the g of an arc of 150 degrees

// Returns the sine of x, which must be in [0, 0.16], with no larger error than the rounding of double.
HWY_INLINE Real small_sine(Real x) {
  const Real z = x * x;
  return x - x * z * (Real(1.0 / 6) - z * (Real(1.0 / 120) - z * (Real(1.0 / 5040) - z * Real(1.0 / 362880))));
}
HWY_INLINE Real small_cosine(Real x) {
  const Real z = x * x;
  return Real(1.0) - z * (Real(1.0 / 2) - z * (Real(1.0 / 24) - z * (Real(1.0 / 720) - z * Real(1.0 / 40320))));
}

// Returns the angle in radians between two unit vectors, given the square of their distance. Below a right angle the
// result is that of angle_of_squared_chord() of mean_error.h; for larger angles the result is too large.
HWY_INLINE Real angle_of_chord(Real square) {
  const Real z = Real(0.25) * square;
  const Real series =
      Real(1.0000000016226231) +
      z * (Real(0.16666614237825533) +
           z * (Real(0.07502757316322511) +
                z * (Real(0.04409161673659448) +
                     z * (Real(0.035814239270631806) +
                          z * (Real(-0.007020579119684662) +
                               z * (Real(0.10740002125895513) +
                                    z * (Real(-0.13591627120977998) + z * Real(0.12391349489483766))))))));
  return Real(2.0) * sqrt(z) * series;
}

// The search for the best arc of each element, with one element in each lane.
struct Search {
  Real3 u0, pole, bisector;
  Real cosine, tangent;  // the cosine and the tangent of half the angle between the ends
  Real3 exact[kIntervals - 1];

  HWY_INLINE Real mean_error(Real g) const {
    const Real y = (g + g) / (Real(1.0) - g * g), slope = y / tangent;
    const Real cos_phi = Real(1.0) / sqrt(Real(1.0) + slope * slope), sin_phi = slope * cos_phi;
    const Real3 axis = cos_phi * pole + sin_phi * bisector;
    const Real3 w = (sin_phi * cosine) * axis, p = u0 - w, q = cross(axis, u0);
    const Real step = Real(2.0 / kIntervals) * upper_angle(tangent, cos_phi);
    const Real step_sine = small_sine(step), step_cosine = small_cosine(step);
    Real c(1.0), s(0.0), sum(0.0);
    for (const Real3& n : exact) {
      const Real next = c * step_cosine - s * step_sine;
      s = s * step_cosine + c * step_sine;
      c = next;
      const Real3 miss = (w + c * p + s * q) - n;
      sum = sum + angle_of_chord(dot(miss, miss));
    }
    return Real(1.0 / kIntervals) * sum;
  }
};

// Three arcs with ascending g (see the top of this file), and their mean errors.
struct Bracket {
  Real low, middle, high;
  Real at_low, at_middle, at_high;

  HWY_INLINE RealMask holds() const { return !((at_low < at_middle) | (at_high < at_middle)); }
  // Returns a bound of the amount by which a convex function with these three values can fall below the middle value.
  HWY_INLINE Real gain() const {
    const Real left = middle - low, right = high - middle;
    return larger_of((at_low - at_middle) * right / left, (at_high - at_middle) * left / right);
  }
};

HWY_INLINE Real3 unit(const Real3& v) { return (Real(1.0) / sqrt(dot(v, v))) * v; }

// Returns tan(phi) of the best arc of each element, or NaN if this search cannot find the best arc.
HWY_INLINE Real OptimalSlopes(const Real3& n0, const Real3& m, const Real3& n1) {
  const Real zero(0.0), one(1.0), none(std::numeric_limits<double>::quiet_NaN());
  // Elements are accepted only if the squares of their normals at both ends neither overflow nor vanish.
  const auto has_length = [](const Real3& v) HWY_ATTR {
    const Real square = dot(v, v);
    return (square > Real(1e-200)) & (square < Real(1e200));
  };
  RealMask good = has_length(n0) & has_length(n1);
  const Real3 start = unit(n0), end = unit(n1);
  const Real3 across = cross(start, end);
  const Real sine = dot(across, across), cosine = dot(start, end);
  good = good & (sine > Real(1e-16)) & (cosine > Real(0.54));
  if (!any(good)) return none;

  Search search;
  search.u0 = start;
  search.pole = unit(across);
  search.bisector = unit(start + end);
  search.cosine = dot(start, search.bisector);
  const Real3 half = Real(0.5) * (end - start);
  search.tangent = sqrt(dot(half, half)) / search.cosine;
  // If the normal of an element becomes short compared with its control normals, the element is left to the slower
  // search.
  const Real size = dot(n0, n0) + dot(m, m) + dot(n1, n1);
  Real3 before = start;
  for (std::size_t i = 0; i < kIntervals; ++i) {
    const double t = static_cast<double>(i + 1) / kIntervals, s = 1 - t;
    Real3 u = end;
    if (i + 1 < kIntervals) {
      const Real3 n = Real(s * s) * n0 + Real(2 * t * s) * m + Real(t * t) * n1;
      good = good & (dot(n, n) > Real(1e-10) * size);
      u = search.exact[i] = unit(n);
    }
    const Real3 turn = u - before;
    good = good & (dot(turn, turn) < Real(0.15 * 0.15));
    before = u;
  }
  const Real3 axis = cross(search.exact[kIntervals / 2 - 1] - start, half);
  const Real along = dot(axis, search.pole);
  const Real y = search.tangent * (dot(axis, search.bisector) / select(along > zero, along, one));
  const Real g = y / (one + sqrt(one + y * y));
  good = good & (along > zero) & (absolute(g) < Real(kLargestG));
  if (!any(good)) return none;

  // The search starts with the arc through the middle normal and one arc on each side of it. The distance between
  // neighbouring arcs in g is a fraction of the mean error.
  Bracket bracket;
  bracket.middle = select(good, g, zero);
  bracket.at_middle = search.mean_error(bracket.middle);
  Real step = Real(0.25) * bracket.at_middle / (search.tangent * search.cosine);
  step = larger_of(smaller_of(step, Real(0.1)), Real(1e-6));
  bracket.low = bracket.middle - step;
  bracket.high = bracket.middle + step;
  bracket.at_low = search.mean_error(bracket.low);
  bracket.at_high = search.mean_error(bracket.high);
  for (int i = 0; i < 12; ++i) {
    const RealMask moves = good & !bracket.holds();
    if (!any(moves)) break;
    const RealMask up = bracket.at_high < bracket.at_low;
    step = select(moves, step + step, step);
    const Real next = select(up, bracket.high + step, bracket.low - step);
    const RealMask inside = absolute(next) < Real(kLargestG);
    good = good & (inside | !moves);
    const Real at_next = search.mean_error(select(inside, next, zero));
    const RealMask rise = moves & up, fall = moves & !up;
    const Bracket old = bracket;
    bracket.low = select(rise, old.middle, select(fall, next, old.low));
    bracket.at_low = select(rise, old.at_middle, select(fall, at_next, old.at_low));
    bracket.middle = select(rise, old.high, select(fall, old.low, old.middle));
    bracket.at_middle = select(rise, old.at_high, select(fall, old.at_low, old.at_middle));
    bracket.high = select(rise, next, select(fall, old.middle, old.high));
    bracket.at_high = select(rise, at_next, select(fall, old.at_middle, old.at_high));
  }
  good = good & bracket.holds();

  RealMask open = good;
  for (int i = 0; i < 24; ++i) {
    open = open & (bracket.gain() > larger_of(Real(kGain) * bracket.at_middle, Real(kNoError)));
    if (!any(open)) break;
    const Real left = bracket.middle - bracket.low, right = bracket.high - bracket.middle;
    // The next arc is at the lowest point of the parabola through the three arcs. Every third time, the next arc is at
    // the golden section of the longer side of the bracket instead.
    const Real of_low = (bracket.at_low - bracket.at_middle) / left,
               of_high = (bracket.at_high - bracket.at_middle) / right;
    const Real sum = of_low + of_high;
    Real move = Real(0.5) * (right * of_low - left * of_high) / select(sum > zero, sum, one);
    const RealMask longer_right = right > left;
    const Real longer = select(longer_right, right, zero - left);
    if (i % 3 == 2) move = Real(0.381966011250105) * longer;
    // The new arc must differ from the middle arc and from the arcs at the ends of the bracket.
    const Real least = Real(0.05) * smaller_of(left, right);
    move = select(absolute(move) < least, Real(0.05) * longer, move);
    move = larger_of(smaller_of(move, Real(0.95) * right), Real(-0.95) * left);
    const Real x = bracket.middle + move;
    const Real at_x = search.mean_error(select(open, x, zero));
    const RealMask better = at_x<bracket.at_middle, to_right = move> zero;
    // If the new arc is better, the old middle becomes an end of the bracket. Otherwise the new arc becomes an end.
    const Real end_x = select(better, bracket.middle, x), at_end = select(better, bracket.at_middle, at_x);
    const RealMask is_low = open & ((better & to_right) | !(better | to_right));
    const RealMask is_high = open & !is_low;
    bracket.low = select(is_low, end_x, bracket.low);
    bracket.at_low = select(is_low, at_end, bracket.at_low);
    bracket.high = select(is_high, end_x, bracket.high);
    bracket.at_high = select(is_high, at_end, bracket.at_high);
    bracket.middle = select(open & better, x, bracket.middle);
    bracket.at_middle = select(open & better, at_x, bracket.at_middle);
  }
  good = good & !open;
  const Real best = bracket.middle;
  return select(good, (best + best) / (one - best * best) / search.tangent, none);
}

void FindOptimalArcs(std::span<const ControlNormals> normals, double* slopes) {
  for (std::size_t first = 0; first < normals.size(); first += kDoubleLanes) {
    double planes[9][kDoubleLanes] = {};
    const std::size_t count = std::min(kDoubleLanes, normals.size() - first);
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3d* const of_element[] = {&normals[first + i].n0, &normals[first + i].m, &normals[first + i].n1};
      for (std::size_t k = 0; k < 3; ++k) {
        planes[3 * k][i] = of_element[k]->x;
        planes[3 * k + 1][i] = of_element[k]->y;
        planes[3 * k + 2][i] = of_element[k]->z;
      }
    }
    const auto vector = [&planes](std::size_t k) HWY_ATTR {
      return Real3{Real::load(planes[3 * k]), Real::load(planes[3 * k + 1]), Real::load(planes[3 * k + 2])};
    };
    double result[kDoubleLanes];
    OptimalSlopes(vector(0), vector(1), vector(2)).store(result);
    std::copy_n(result, count, slopes + first);
  }
}

}  // namespace chronormal::inline internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace chronormal::inline internal {

HWY_EXPORT(FindOptimalArcs);

void find_optimal_arcs(std::span<const ControlNormals> normals, std::span<double> phis) noexcept {
  assert(normals.size() == phis.size());
  HWY_DYNAMIC_DISPATCH(FindOptimalArcs)(normals, phis.data());
  for (double& phi : phis) phi = portable::atan(phi);  // NaN stays NaN
}

}  // namespace chronormal::inline internal
#endif  // HWY_ONCE
