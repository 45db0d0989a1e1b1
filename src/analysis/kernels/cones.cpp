// The smallest cone around three unit vectors is that of the widest pair where the third lies in it, and else the one
// through all three, whose axis is perpendicular to their differences. Whatever axis comes out, it is rounded to float32,
// and then the cone is made wide enough for it: the largest sine of the angles between the axis as rounded and the three
// vectors, and to it
//     the share of its length by which a vector may be off: the sine of the angle that it may be off by
//     2^-46 for the rounding of the sine
// With sin(a + b) <= sin a + sin b this sum is no less than the sine of the angle to any vector as it is, and where it is
// at most 1 that angle is at most 90 degrees.
#include "analysis/kernels/cones.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "analysis/kernels/cones.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "simd/intrinsics-inl.h"
#include "simd/rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace chronormal::inline internal::HWY_NAMESPACE {

using DoubleMask = hn::Mask<DoubleTag>;

struct Three {
  Doubles3 v[3];
};

// The nine numbers of kDoubleLanes elements, as lanes.
HWY_INLINE Three LoadThree(const double* rows) {
  constexpr std::size_t kRun = 3 * kDoubleLanes;
  alignas(64) double component[3][kRun];  // of all vectors, in order
  for (std::size_t i = 0; i < 3; ++i) {
    Doubles x, y, z;
    hn::LoadInterleaved3(kDoubles, rows + i * kRun, x, y, z);
    hn::Store(x, kDoubles, component[0] + i * kDoubleLanes);
    hn::Store(y, kDoubles, component[1] + i * kDoubleLanes);
    hn::Store(z, kDoubles, component[2] + i * kDoubleLanes);
  }
  Three three;
  hn::LoadInterleaved3(kDoubles, component[0], three.v[0].x, three.v[1].x, three.v[2].x);
  hn::LoadInterleaved3(kDoubles, component[1], three.v[0].y, three.v[1].y, three.v[2].y);
  hn::LoadInterleaved3(kDoubles, component[2], three.v[0].z, three.v[1].z, three.v[2].z);
  return three;
}

HWY_INLINE Doubles MaxAbs(const Doubles3& v) { return LargerAbs(LargerAbs(v.x, v.y), v.z); }

// The power of two that brings a positive number into [1, 2), or as near to it as one can.
HWY_INLINE Doubles ScaleOf(Doubles size) {
  const hn::RebindToUnsigned<DoubleTag> bits;
  const auto exponent = hn::And(hn::BitCast(bits, size), hn::Set(bits, 0x7FF0000000000000));
  const auto inverse = hn::Sub(hn::Set(bits, 0x7FE0000000000000), exponent);
  return hn::BitCast(kDoubles, inverse);
}

HWY_INLINE Doubles3 Select(DoubleMask mask, const Doubles3& yes, const Doubles3& no) {
  return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y), hn::IfThenElse(mask, yes.z, no.z)};
}

// The direction in the middle of three unit vectors, of any length.
HWY_INLINE Doubles3 MiddleOf(const Doubles3 (&u)[3]) {
  const Doubles one = hn::Set(kDoubles, 1);
  const Doubles d01 = Dot(u[0], u[1]), d02 = Dot(u[0], u[2]), d12 = Dot(u[1], u[2]);
  const Doubles widest = hn::Min(hn::Min(d01, d02), d12);
  const DoubleMask is01 = hn::Eq(d01, widest), is02 = hn::Eq(d02, widest);
  const Doubles3 pair = Select(is01, u[0] + u[1], Select(is02, u[0] + u[2], u[1] + u[2]));
  const Doubles others =
      hn::IfThenElse(is01, hn::Add(d02, d12), hn::IfThenElse(is02, hn::Add(d01, d12), hn::Add(d01, d02)));
  const Doubles3 perpendicular = Cross(u[1] - u[0], u[2] - u[0]);
  const Doubles side = Dot(perpendicular, u[0]);
  const Doubles3 through_all =
      Select(hn::Lt(side, hn::Zero(kDoubles)),
             Doubles3{hn::Neg(perpendicular.x), hn::Neg(perpendicular.y), hn::Neg(perpendicular.z)}, perpendicular);
  // Where the third lies hardly outside, or all are hardly apart, differences are too rough for an axis through all three.
  const Doubles slack = hn::Add(hn::Mul(hn::Set(kDoubles, 1e-8), hn::Sub(one, widest)), hn::Set(kDoubles, 0x1p-48));
  const DoubleMask pair_holds = hn::Ge(hn::Add(others, slack), hn::Add(one, widest));
  return Select(pair_holds, pair, through_all);
}

// Writes kDoubleLanes cones, and returns which lanes are not to be trusted.
template <bool kIsPart>
HWY_INLINE std::uint32_t Cones(const double* rows, double share, const Restriction& part, float* result) {
  const Doubles zero = hn::Zero(kDoubles), one = hn::Set(kDoubles, 1);
  Three three = LoadThree(rows);
  Doubles unknown = hn::Set(kDoubles, share);
  Doubles errors[3];
  if constexpr (kIsPart) {
    const Doubles sizes[3] = {MaxAbs(three.v[0]), MaxAbs(three.v[1]), MaxAbs(three.v[2])};
    const Three whole = three;
    for (std::size_t k = 0; k < 3; ++k) {
      const Doubles w0 = hn::Set(kDoubles, part.weights[k][0]), w1 = hn::Set(kDoubles, part.weights[k][1]),
                    w2 = hn::Set(kDoubles, part.weights[k][2]);
      three.v[k] = (Scale(w0, whole.v[0]) + Scale(w1, whole.v[1])) + Scale(w2, whole.v[2]);
      const Doubles size = hn::Add(hn::Add(hn::Mul(w0, sizes[0]), hn::Mul(w1, sizes[1])), hn::Mul(w2, sizes[2]));
      errors[k] = hn::Add(hn::Mul(hn::Set(kDoubles, kNormalShare), size), hn::Set(kDoubles, kUnderflow));
    }
  }

  // Unit vectors, by way of a power of two that keeps squares in range.
  Doubles3 u[3];
  DoubleMask is_known = hn::Eq(one, one);
  for (std::size_t k = 0; k < 3; ++k) {
    const Doubles size = MaxAbs(three.v[k]), scale = ScaleOf(size);
    const Doubles3 v = Scale(scale, three.v[k]);
    const Doubles inverse = hn::Div(one, hn::Sqrt(Dot(v, v)));
    u[k] = Scale(inverse, v);
    const Doubles length_or_nan = hn::Sub(inverse, hn::Mul(size, zero));  // NaN where size is not finite
    is_known = hn::And(is_known, hn::And(hn::Gt(size, zero), hn::Gt(length_or_nan, zero)));
    if constexpr (kIsPart) {
      const Doubles share_of_it = hn::Mul(hn::Mul(errors[k], scale), inverse);
      is_known = hn::And(is_known, hn::Le(share_of_it, hn::Set(kDoubles, kLargestUnknown)));
      unknown = hn::Max(unknown, share_of_it);
    }
  }

  const Doubles3 middle = MiddleOf(u);
  const Doubles3 unit_middle = Scale(hn::Div(one, hn::Sqrt(Dot(middle, middle))), middle);
  const HalfFloatTag half;
  const auto x = hn::DemoteTo(half, unit_middle.x), y = hn::DemoteTo(half, unit_middle.y),
             z = hn::DemoteTo(half, unit_middle.z);
  const Doubles3 axis{hn::PromoteTo(kDoubles, x), hn::PromoteTo(kDoubles, y), hn::PromoteTo(kDoubles, z)};

  Doubles sine_squared = zero, smallest_dot = one;
  for (const Doubles3& v : u) {
    const Doubles3 across = Cross(v, axis);
    sine_squared = hn::Max(sine_squared, Dot(across, across));
    smallest_dot = hn::Min(smallest_dot, Dot(v, axis));
  }
  const Doubles sine_to_axis = hn::Sqrt(hn::Div(sine_squared, Dot(axis, axis)));
  const Doubles sine = hn::Add(hn::Add(sine_to_axis, unknown), hn::Set(kDoubles, 0x1p-46));
  const DoubleMask fits = hn::And(hn::Le(sine, one), hn::Gt(smallest_dot, zero));
  const Doubles rounded_up = hn::IfThenElse(fits, hn::Min(hn::Mul(sine, hn::Set(kDoubles, 1 + 0x1p-23)), one), one);

  const auto keep = [&](Doubles component) HWY_ATTR { return hn::DemoteTo(half, hn::IfThenElseZero(fits, component)); };
  hn::StoreInterleaved4(keep(axis.x), keep(axis.y), keep(axis.z), hn::DemoteTo(half, rounded_up), half, result);
  return BitsOf(kDoubles, hn::Not(is_known));
}

template <bool kIsPart>
HWY_INLINE void AllCones(const double* rows, std::size_t count, double share, const Restriction& part, float* result,
                         std::uint8_t* flags) {
  constexpr std::size_t kRow = 9, kCone = 4;
  std::fill_n(flags, (count + kConesPerFlags - 1) / kConesPerFlags, std::uint8_t{0});
  for (std::size_t i = 0; i < count; i += kDoubleLanes) {
    const std::size_t here = std::min(kDoubleLanes, count - i);
    std::uint32_t flagged = 0;
    if (here == kDoubleLanes) {
      flagged = Cones<kIsPart>(rows + kRow * i, share, part, result + kCone * i);
    } else {
      alignas(64) double padded[kRow * kDoubleLanes];
      alignas(64) float cones[kCone * kDoubleLanes];
      for (std::size_t lane = 0; lane < kDoubleLanes; ++lane)
        std::copy_n(rows + kRow * (i + std::min(lane, here - 1)), kRow, padded + kRow * lane);
      flagged = Cones<kIsPart>(padded, share, part, cones) & ((1U << here) - 1);
      std::copy_n(cones, kCone * here, result + kCone * i);
    }
    flags[i / kConesPerFlags] = static_cast<std::uint8_t>(flags[i / kConesPerFlags] | flagged << i % kConesPerFlags);
  }
}

void ConesOfThree(const double* rows, std::size_t count, double share, float* result, std::uint8_t* flags) {
  AllCones<false>(rows, count, share, {}, result, flags);
}

void ConesOfParts(const double* rows, std::size_t count, const Restriction& part, float* result, std::uint8_t* flags) {
  AllCones<true>(rows, count, 0, part, result, flags);
}

}  // namespace chronormal::inline internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace chronormal::inline internal {

HWY_EXPORT(ConesOfThree);
HWY_EXPORT(ConesOfParts);

static_assert(sizeof(ControlNormals) == 9 * sizeof(double) && sizeof(NormalCone) == 4 * sizeof(float));

void cones_of_three(const ControlNormals* normals, std::size_t count, double share, NormalCone* result,
                    std::uint8_t* flags) noexcept {
  HWY_DYNAMIC_DISPATCH(ConesOfThree)
  (reinterpret_cast<const double*>(normals), count, share, reinterpret_cast<float*>(result), flags);
}

void cones_of_parts(const ControlNormals* normals, std::size_t count, const Restriction& part, NormalCone* result,
                    std::uint8_t* flags) noexcept {
  HWY_DYNAMIC_DISPATCH(ConesOfParts)
  (reinterpret_cast<const double*>(normals), count, part, reinterpret_cast<float*>(result), flags);
}

}  // namespace chronormal::inline internal
#endif  // HWY_ONCE
