// The smallest cone around three unit vectors is the cone of the widest pair if this cone contains the third vector,
// that is, if the triangle has no acute angle at the third vector. Otherwise the cone goes through all three, around
// the circumcentre of the triangle. Its axis is found in float32, and the cone is then made wide enough for the rounded
// axis: its sine is the largest sine of the angles between the axis and the three vectors, plus, with u = 2^-24,
//     2^-20 of itself, for the lengths of axis and vectors, the root and the quotient
//     5 u: a vector loses 2 u to float32, and a cross product of unit vectors 2.5 u
//     the relative error of a vector, which is the sine of the angle of that error
// By sin(a + b) <= sin a + sin b, this sum is at least the sine of the angle to any exact vector. If the sum is at most
// 1, that angle is at most 90 degrees.
#include "analysis/cones/kernels/cones_of_three.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "analysis/cones/kernels/cones_of_three.cpp"
#include "simd/foreach_target-inl.h"
#include "simd/highway-inl.h"

#include "simd/intrinsics-inl.h"
#include "simd/rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace chronormal::inline internal::HWY_NAMESPACE {

// The vectors of kLanes elements and the bounds of their errors. Each element has three vectors, which are scaled by
// powers of two.
struct Scaled {
  alignas(64) double vectors[9][kLanes];
  alignas(64) double errors[3][kLanes];
};

HWY_INLINE Doubles MaxAbs(const Doubles3& v) { return LargerAbs(LargerAbs(v.x, v.y), v.z); }

// Returns the power of two by which a number that is not subnormal must be multiplied to be in [1, 2).
HWY_INLINE Doubles ScaleOf(Doubles size) {
  const hn::RebindToUnsigned<DoubleTag> bits;
  const auto exponent = hn::And(hn::BitCast(bits, size), hn::Set(bits, 0x7FF0000000000000));
  return hn::BitCast(kDoubles, hn::Sub(hn::Set(bits, 0x7FE0000000000000), exponent));
}

// Reads the control normals of kDoubleLanes elements, scales them, and writes them to the lanes of `scaled` from `at`
// on.
template <bool kIsPart>
HWY_INLINE void Load(const double* rows, const Restriction& part, std::size_t at, Scaled& scaled) {
  Doubles column[9];
  LoadColumns<9>(rows, column);
  Doubles3 v[3],
      whole[3] = {
          {column[0], column[1], column[2]}, {column[3], column[4], column[5]}, {column[6], column[7], column[8]}};
  Doubles sizes[3];
  if constexpr (kIsPart) {
    for (std::size_t k = 0; k < 3; ++k) sizes[k] = MaxAbs(whole[k]);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    v[k] = whole[k];
    if constexpr (kIsPart) {
      const Doubles w0 = hn::Set(kDoubles, part.weights[k][0]), w1 = hn::Set(kDoubles, part.weights[k][1]),
                    w2 = hn::Set(kDoubles, part.weights[k][2]);
      v[k] = (Scale(w0, whole[0]) + Scale(w1, whole[1])) + Scale(w2, whole[2]);
    }
    const Doubles scale = ScaleOf(MaxAbs(v[k]));
    hn::Store(hn::Mul(scale, v[k].x), kDoubles, scaled.vectors[3 * k] + at);
    hn::Store(hn::Mul(scale, v[k].y), kDoubles, scaled.vectors[3 * k + 1] + at);
    hn::Store(hn::Mul(scale, v[k].z), kDoubles, scaled.vectors[3 * k + 2] + at);
    if constexpr (kIsPart) {
      const Doubles w0 = hn::Set(kDoubles, part.weights[k][0]), w1 = hn::Set(kDoubles, part.weights[k][1]),
                    w2 = hn::Set(kDoubles, part.weights[k][2]);
      const Doubles size = hn::Add(hn::Add(hn::Mul(w0, sizes[0]), hn::Mul(w1, sizes[1])), hn::Mul(w2, sizes[2]));
      const Doubles error = hn::Add(hn::Mul(hn::Set(kDoubles, kNormalShare), size), hn::Set(kDoubles, kUnderflow));
      hn::Store(hn::Mul(scale, error), kDoubles, scaled.errors[k] + at);
    }
  }
}

HWY_INLINE Lanes3 Select(hn::Mask<FloatTag> mask, const Lanes3& yes, const Lanes3& no) {
  return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y), hn::IfThenElse(mask, yes.z, no.z)};
}

// Returns a vector, of any length, along the axis of the smallest cone around three unit vectors.
HWY_INLINE Lanes3 MiddleOf(const Lanes3 (&u)[3]) {
  const auto square = [](const Lanes3& v) HWY_ATTR { return Dot(v, v); };
  // The vectors are the corners of a triangle. c0, c1, c2 are its squared sides, and e0, e1, e2 are negative where the
  // angle opposite to the side is obtuse.
  const Floats c0 = square(u[1] - u[2]), c1 = square(u[0] - u[2]), c2 = square(u[0] - u[1]);
  const Floats e0 = hn::Sub(hn::Add(c1, c2), c0), e1 = hn::Sub(hn::Add(c0, c2), c1), e2 = hn::Sub(hn::Add(c0, c1), c2);
  const Floats longest = hn::Max(hn::Max(c0, c1), c2);
  const auto is0 = hn::Eq(c0, longest), is1 = hn::Eq(c1, longest);
  const Floats e = hn::IfThenElse(is0, e0, hn::IfThenElse(is1, e1, e2));
  const Lanes3 pair = Select(is0, u[1] + u[2], Select(is1, u[0] + u[2], u[0] + u[1]));
  // The centre of the circle through all three corners is computed in barycentric coordinates.
  const Floats inverse = hn::Div(hn::Set(kFloats, 1), longest);
  const auto weight = [inverse](Floats side, Floats angle)
                          HWY_ATTR { return hn::Mul(hn::Mul(side, inverse), hn::Mul(angle, inverse)); };
  const Lanes3 centre = (Scale(weight(c0, e0), u[0]) + Scale(weight(c1, e1), u[1])) + Scale(weight(c2, e2), u[2]);
  return Select(hn::Le(e, hn::Mul(hn::Set(kFloats, 1e-4F), longest)), pair, centre);
}

// Writes kLanes cones. Returns a number whose bits mark the lanes with cones that cannot be trusted.
template <bool kIsPart>
HWY_INLINE std::uint32_t Cones(const double* rows, float share, const Restriction& part, float* result) {
  Scaled scaled;
  for (std::size_t at = 0; at < kLanes; at += kDoubleLanes) Load<kIsPart>(rows + 9 * at, part, at, scaled);

  const Floats zero = hn::Zero(kFloats), one = hn::Set(kFloats, 1);
  Floats unknown = hn::Set(kFloats, share);
  Lanes3 u[3];
  auto is_known = hn::Eq(one, one);
  for (std::size_t k = 0; k < 3; ++k) {
    const Lanes3 v{ToFloat(scaled.vectors[3 * k]), ToFloat(scaled.vectors[3 * k + 1]),
                   ToFloat(scaled.vectors[3 * k + 2])};
    const Floats square = Dot(v, v);
    is_known = hn::And(is_known, hn::And(hn::Ge(square, hn::Set(kFloats, 0.5F)), hn::Le(square, hn::Set(kFloats, 16))));
    const Floats inverse = hn::Div(one, hn::Sqrt(square));
    u[k] = Scale(inverse, v);
    if constexpr (kIsPart) {
      const Floats share_of_it = hn::Mul(ToFloat(scaled.errors[k]), inverse);
      is_known = hn::And(is_known, hn::Le(share_of_it, hn::Set(kFloats, static_cast<float>(kLargestUnknown))));
      unknown = hn::Max(unknown, share_of_it);
    }
  }

  const Lanes3 axis = Normalized(MiddleOf(u));
  Floats sine_squared = zero, smallest_dot = one;
  for (const Lanes3& v : u) {
    const Lanes3 across = Cross(v, axis);
    sine_squared = hn::Max(sine_squared, Dot(across, across));
    smallest_dot = hn::Min(smallest_dot, Dot(v, axis));
  }
  const Floats computed = hn::Mul(hn::Set(kFloats, 1 + 0x1p-20F), hn::Sqrt(hn::Div(sine_squared, Dot(axis, axis))));
  const Floats sine = hn::Add(hn::Add(computed, unknown), hn::Set(kFloats, 5 * 0x1p-24F));
  const Floats rounded_up = hn::Mul(sine, hn::Set(kFloats, 1 + 0x1p-21F));
  const auto fits = hn::And(hn::Le(rounded_up, one), hn::Gt(smallest_dot, zero));
  hn::StoreInterleaved4(hn::IfThenElseZero(fits, axis.x), hn::IfThenElseZero(fits, axis.y),
                        hn::IfThenElseZero(fits, axis.z), hn::IfThenElse(fits, rounded_up, one), kFloats, result);
  return BitsOf(kFloats, hn::Not(is_known));
}

template <bool kIsPart>
HWY_INLINE void AllCones(const double* rows, std::size_t count, float share, const Restriction& part, float* result,
                         std::uint16_t* flags) {
  constexpr std::size_t kRow = 9, kCone = 4;
  std::fill_n(flags, (count + kConesPerFlags - 1) / kConesPerFlags, std::uint16_t{0});
  for (std::size_t i = 0; i < count; i += kLanes) {
    const std::size_t here = std::min(kLanes, count - i);
    std::uint32_t flagged = 0;
    if (here == kLanes) {
      flagged = Cones<kIsPart>(rows + kRow * i, share, part, result + kCone * i);
    } else {
      alignas(64) double padded[kRow * kLanes];
      alignas(64) float cones[kCone * kLanes];
      for (std::size_t lane = 0; lane < kLanes; ++lane)
        std::copy_n(rows + kRow * (i + std::min(lane, here - 1)), kRow, padded + kRow * lane);
      flagged = Cones<kIsPart>(padded, share, part, cones) & ((1U << here) - 1);
      std::copy_n(cones, kCone * here, result + kCone * i);
    }
    flags[i / kConesPerFlags] = static_cast<std::uint16_t>(flags[i / kConesPerFlags] | flagged << i % kConesPerFlags);
  }
}

void ConesOfThree(const double* rows, std::size_t count, float share, float* result, std::uint16_t* flags) {
  AllCones<false>(rows, count, share, {}, result, flags);
}

void ConesOfParts(const double* rows, std::size_t count, const Restriction& part, float* result, std::uint16_t* flags) {
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
                    std::uint16_t* flags) noexcept {
  HWY_DYNAMIC_DISPATCH(ConesOfThree)
  (reinterpret_cast<const double*>(normals), count, static_cast<float>(share * (1 + 0x1p-22)),
   reinterpret_cast<float*>(result), flags);
}

void cones_of_parts(const ControlNormals* normals, std::size_t count, const Restriction& part, NormalCone* result,
                    std::uint16_t* flags) noexcept {
  HWY_DYNAMIC_DISPATCH(ConesOfParts)
  (reinterpret_cast<const double*>(normals), count, part, reinterpret_cast<float*>(result), flags);
}

}  // namespace chronormal::inline internal
#endif  // HWY_ONCE
