// Computes coefficients by dot products in double, roots of quadratics in closed form, and roots of cubics by Newton's
// method, starting from the root of a quadratic. A bracket is only accepted if the values at its ends certainly have
// different signs, so the way of finding the root does not matter.
#include "analysis/signs/kernels/facing_lanes.h"

#include <algorithm>
#include <cstdint>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "analysis/signs/kernels/facing_lanes.cpp"
#include "simd/foreach_target-inl.h"
#include "simd/highway-inl.h"

#include "core/rounding.h"
#include "simd/intrinsics-inl.h"
#include "simd/rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace chronormal::inline internal::HWY_NAMESPACE {

struct NormalLanes {
  Doubles3 n0, m, n1;
};

HWY_INLINE NormalLanes LoadNormals(const double* rows) {
  Doubles column[9];
  LoadColumns<9>(rows, column);
  return {{column[0], column[1], column[2]}, {column[3], column[4], column[5]}, {column[6], column[7], column[8]}};
}

HWY_INLINE Doubles Twice(Doubles v) { return hn::Add(v, v); }
HWY_INLINE Doubles SumAbs(const Doubles3& v) { return hn::Add(hn::Add(hn::Abs(v.x), hn::Abs(v.y)), hn::Abs(v.z)); }
HWY_INLINE Doubles MaxAbs(const Doubles3& v) { return LargerAbs(LargerAbs(v.x, v.y), v.z); }

template <std::size_t M>
HWY_INLINE void StoreCoefficients(const Doubles (&values)[M], const Doubles (&bounds)[M], Doubles reach, std::size_t at,
                                  FacingCoefficients& result) {
  const Doubles zero = hn::Zero(kDoubles);
  auto is_front = hn::Eq(zero, zero), is_back = is_front;
  for (std::size_t k = 0; k < M; ++k) {
    hn::Store(values[k], kDoubles, result.values[k] + at);
    hn::Store(bounds[k], kDoubles, result.bounds[k] + at);
    is_front = hn::And(is_front, hn::Gt(values[k], bounds[k]));
    is_back = hn::And(is_back, hn::Lt(values[k], hn::Neg(bounds[k])));
  }
  hn::Store(reach, kDoubles, result.reach + at);
  const std::uint32_t front = BitsOf(kDoubles, is_front), back = BitsOf(kDoubles, is_back);
  for (std::size_t i = 0; i < kDoubleLanes; ++i)
    result.signs[at + i] = static_cast<int>(front >> i & 1) - static_cast<int>(back >> i & 1);
}

struct DirectionTo {
  double way[3];

  HWY_INLINE void operator()(const double* rows, std::size_t at, FacingCoefficients& result) const {
    const Doubles3 w = {hn::Set(kDoubles, way[0]), hn::Set(kDoubles, way[1]), hn::Set(kDoubles, way[2])};
    const auto [n0, m, n1] = LoadNormals(rows);
    const Doubles share = hn::Mul(hn::Set(kDoubles, kDotShare), MaxAbs(w));
    StoreCoefficients<3>({Dot(n0, w), Twice(Dot(m, w)), Dot(n1, w)},
                         {hn::Mul(share, SumAbs(n0)), Twice(hn::Mul(share, SumAbs(m))), hn::Mul(share, SumAbs(n1))},
                         SumAbs(w), at, result);
  }
};

struct WaysTo {
  const FacingWays& ways;

  HWY_INLINE void operator()(const double* rows, std::size_t at, FacingCoefficients& result) const {
    const auto way = [this, at](std::size_t k) HWY_ATTR { return hn::Load(kDoubles, ways.at[k] + at); };
    const Doubles3 from = {way(0), way(1), way(2)}, to = {way(3), way(4), way(5)};
    const auto [n0, m, n1] = LoadNormals(rows);
    const Doubles share = hn::Mul(hn::Set(kDoubles, kDotShare), hn::Max(MaxAbs(from), MaxAbs(to)));
    const Doubles b0 = hn::Mul(share, SumAbs(n0)), b = Twice(hn::Mul(share, SumAbs(m))),
                  b1 = hn::Mul(share, SumAbs(n1));
    StoreCoefficients<4>({Dot(n0, from), hn::Add(Dot(n0, to), Twice(Dot(m, from))),
                          hn::Add(Twice(Dot(m, to)), Dot(n1, from)), Dot(n1, to)},
                         {b0, hn::Add(b0, b), hn::Add(b, b1), b1}, hn::Max(SumAbs(from), SumAbs(to)), at, result);
  }
};

// Calls body for the control normals of all faces, one vector of lanes at a time. Lanes beyond the last face repeat the
// last face.
template <class Body>
HWY_INLINE void ForNormals(const double* rows, std::size_t count, FacingCoefficients& result, const Body& body) {
  constexpr std::size_t kRow = 9;
  for (std::size_t i = 0; i < count; i += kDoubleLanes) {
    if (i + kDoubleLanes <= count) {
      body(rows + kRow * i, i, result);
      continue;
    }
    double padded[kRow * kDoubleLanes];
    for (std::size_t lane = 0; lane < kDoubleLanes; ++lane)
      std::copy_n(rows + kRow * std::min(i + lane, count - 1), kRow, padded + kRow * lane);
    body(padded, i, result);
  }
}

void FacingOfDirection(const double* rows, std::size_t count, const double* way, FacingCoefficients& result) {
  ForNormals(rows, count, result, DirectionTo{{way[0], way[1], way[2]}});
}

void FacingOfEye(const double* rows, std::size_t count, const FacingWays& ways, FacingCoefficients& result) {
  ForNormals(rows, count, result, WaysTo{ways});
}

struct Guess {
  Doubles root, slope;  // `slope` is an absolute value
};

// Returns the only root in [0, 1] of a quadratic that is positive at 0 and negative at 1. s = t / (1 - t) is a root of
// p2 s^2 + 2 p1 s + p0, and is computed by the formula in which nothing cancels.
HWY_INLINE Doubles RootOfQuadratic(Doubles p0, Doubles p1, Doubles p2) {
  const Doubles w = hn::Add(p1, hn::CopySign(hn::Sqrt(hn::Sub(hn::Mul(p1, p1), hn::Mul(p0, p2))), p1));
  const auto is_negative = hn::Lt(w, hn::Zero(kDoubles));
  return hn::Div(hn::IfThenElse(is_negative, p0, w), hn::IfThenElse(is_negative, hn::Sub(p0, w), hn::Sub(w, p2)));
}

HWY_INLINE Guess OnlyRoot(const Doubles (&p)[3]) {
  const Doubles t = RootOfQuadratic(p[0], p[1], p[2]), s = hn::Sub(hn::Set(kDoubles, 1), t);
  const Doubles half_slope = hn::Add(hn::Mul(s, hn::Sub(p[1], p[0])), hn::Mul(t, hn::Sub(p[2], p[1])));
  return {t, hn::Abs(Twice(half_slope))};
}

HWY_INLINE Guess OnlyRoot(const Doubles (&p)[4]) {
  constexpr int kMostSteps = 5;
  const Doubles zero = hn::Zero(kDoubles), one = hn::Set(kDoubles, 1), three = hn::Set(kDoubles, 3);
  const Doubles d0 = hn::Sub(p[1], p[0]), d1 = hn::Sub(p[2], p[1]), d2 = hn::Sub(p[3], p[2]);
  const Doubles a1 = hn::Mul(three, d0), a2 = hn::Mul(three, hn::Sub(d1, d0)), a3 = hn::Add(hn::Sub(d0, Twice(d1)), d2);
  const Doubles twice_a2 = Twice(a2), thrice_a3 = hn::Mul(three, a3);
  const Doubles middle =
      hn::Mul(hn::Set(kDoubles, 0.25), hn::Sub(hn::Mul(three, hn::Add(p[1], p[2])), hn::Add(p[0], p[3])));
  Doubles t = RootOfQuadratic(p[0], middle, p[3]), slope = zero;
  // Each lane stops at its own step, so its result does not depend on the other lanes. Lanes that have not converged
  // are left to CertainRoots.
  auto is_done = hn::Lt(one, zero);
  for (int i = 0; i < kMostSteps && !hn::AllTrue(kDoubles, is_done); ++i) {
    const Doubles value = hn::Add(hn::Mul(hn::Add(hn::Mul(hn::Add(hn::Mul(a3, t), a2), t), a1), t), p[0]);
    slope = hn::IfThenElse(is_done, slope, hn::Add(hn::Mul(hn::Add(hn::Mul(thrice_a3, t), twice_a2), t), a1));
    const Doubles next = hn::Max(zero, hn::Min(one, hn::Sub(t, hn::Div(value, slope))));
    // After a step this small, the error is about the square of the step, so the step is the last.
    const auto is_last = hn::Le(hn::Abs(hn::Sub(next, t)), hn::Set(kDoubles, 0x1p-28));
    t = hn::IfThenElse(is_done, t, next);
    is_done = hn::Or(is_done, is_last);
  }
  return {t, hn::IfThenElseZero(is_done, hn::Abs(slope))};
}

// Returns the value of a polynomial at t, by de Casteljau's algorithm.
template <std::size_t M>
HWY_INLINE Doubles ValueAt(const Doubles (&p)[M], Doubles t) {
  const Doubles s = hn::Sub(hn::Set(kDoubles, 1), t);
  Doubles row[M];
  for (std::size_t k = 0; k < M; ++k) row[k] = p[k];
  for (std::size_t level = M - 1; level > 0; --level) {
    for (std::size_t k = 0; k < level; ++k) row[k] = hn::Add(hn::Mul(s, row[k]), hn::Mul(t, row[k + 1]));
  }
  return row[0];
}

// Returns true in the lanes in which the signs of the inner coefficients allow only one root, as in CertainRoots.
HWY_INLINE hn::Mask<DoubleTag> HasOneRoot(const Doubles (&/*p*/)[3], Doubles error) { return hn::Eq(error, error); }
HWY_INLINE hn::Mask<DoubleTag> HasOneRoot(const Doubles (&p)[4], Doubles error) {
  const Doubles below = hn::Neg(error);
  const auto rises_again = hn::AndNot(hn::Gt(p[1], error), hn::Gt(p[2], error));
  const auto falls_before = hn::AndNot(hn::Lt(p[2], below), hn::Lt(p[1], below));
  return hn::Not(hn::Or(rises_again, falls_before));
}

template <std::size_t M>
HWY_INLINE void SingleRootsOf(std::size_t at, SingleRoots& roots) {
  constexpr double kRoundings = 46;  // number of roundings, as in CertainRoots
  const Doubles zero = hn::Zero(kDoubles), one = hn::Set(kDoubles, 1);
  // A polynomial that is negative at 0 is multiplied by -1, so that all polynomials go from positive to negative.
  const Doubles sign = hn::CopySign(one, hn::Load(kDoubles, roots.p[0] + at));
  Doubles p[M], size = zero;
  for (std::size_t k = 0; k < M; ++k) {
    p[k] = hn::Mul(sign, hn::Load(kDoubles, roots.p[k] + at));
    size = LargerAbs(size, p[k]);
  }
  const Doubles error =
      hn::Add(hn::Load(kDoubles, roots.error + at), hn::Mul(hn::Set(kDoubles, kRoundings * kUnitRoundoff), size));
  const Doubles below = hn::Neg(error);
  const auto [root, slope] = OnlyRoot(p);
  const Doubles step = hn::Add(hn::Div(Twice(error), slope), hn::Set(kDoubles, 2 * kUnitRoundoff));
  const Doubles lower = hn::Max(zero, hn::Sub(root, step)), upper = hn::Min(one, hn::Add(root, step));
  const auto is_bracketed = hn::And(hn::Gt(ValueAt(p, lower), error), hn::Lt(ValueAt(p, upper), below));
  const auto changes = hn::And(hn::Gt(p[0], error), hn::Lt(p[M - 1], below));
  // A bracket around a guess that is far from the root may contain the root, but is too wide to be of use.
  const auto is_narrow = hn::Lt(step, hn::Set(kDoubles, 0x1p-16));
  const auto is_found = hn::And(hn::And(changes, is_bracketed), hn::And(is_narrow, HasOneRoot(p, error)));
  hn::Store(lower, kDoubles, roots.lower + at);
  hn::Store(upper, kDoubles, roots.upper + at);
  const std::uint32_t found = BitsOf(kDoubles, is_found), from_below = BitsOf(kDoubles, hn::Lt(sign, zero));
  for (std::size_t i = 0; i < kDoubleLanes; ++i)
    roots.before[at + i] = (found >> i & 1) == 0 ? 0 : (from_below >> i & 1) == 0 ? 1 : -1;
}

void FindSingleRoots(std::size_t degree, std::size_t count, SingleRoots& roots) {
  for (std::size_t at = 0; at < count; at += kDoubleLanes) {
    if (degree == 2)
      SingleRootsOf<3>(at, roots);
    else
      SingleRootsOf<4>(at, roots);
  }
}

}  // namespace chronormal::inline internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace chronormal::inline internal {

HWY_EXPORT(FacingOfDirection);
HWY_EXPORT(FacingOfEye);
HWY_EXPORT(FindSingleRoots);

static_assert(sizeof(ControlNormals) == 9 * sizeof(double));

void facing_of_direction(const ControlNormals* normals, std::size_t count, const Vec3d& way,
                         FacingCoefficients& result) noexcept {
  const double components[3] = {way.x, way.y, way.z};
  HWY_DYNAMIC_DISPATCH(FacingOfDirection)(reinterpret_cast<const double*>(normals), count, components, result);
}

void facing_of_eye(const ControlNormals* normals, std::size_t count, const FacingWays& ways,
                   FacingCoefficients& result) noexcept {
  HWY_DYNAMIC_DISPATCH(FacingOfEye)(reinterpret_cast<const double*>(normals), count, ways, result);
}

void find_single_roots(std::size_t degree, std::size_t count, SingleRoots& roots) noexcept {
  HWY_DYNAMIC_DISPATCH(FindSingleRoots)(degree, count, roots);
}

}  // namespace chronormal::inline internal
#endif  // HWY_ONCE
