// A tile of sums, for up to four SIMD vectors with a pose in each lane, stays in registers while the loop runs over all
// terms.
#include "analysis/quality/kernels/blended_normals.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "analysis/quality/kernels/blended_normals.cpp"
#include "simd/foreach_target-inl.h"
#include "simd/highway-inl.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "simd/angles-inl.h"
#include "simd/lanes-inl.h"
#include "simd/rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace chronormal::inline internal::HWY_NAMESPACE {

template <std::size_t kVectors>
HWY_INLINE void AddTile(const Vec3f& base, std::span<const WeightedVector> terms, std::size_t first, float* sums,
                        std::size_t stride) {
  Lanes3 tile[kVectors];
  for (std::size_t v = 0; v < kVectors; ++v)
    tile[v] = {hn::Set(kFloats, base.x), hn::Set(kFloats, base.y), hn::Set(kFloats, base.z)};
  for (const WeightedVector& term : terms) {
    if (term.end <= first || term.first >= first + kVectors * kLanes) continue;
    const Lanes3 vector{hn::Set(kFloats, term.vector.x), hn::Set(kFloats, term.vector.y),
                        hn::Set(kFloats, term.vector.z)};
    for (std::size_t v = 0; v < kVectors; ++v)
      tile[v] = tile[v] + Scale(hn::LoadU(kFloats, term.weights + first + v * kLanes), vector);
  }
  for (std::size_t v = 0; v < kVectors; ++v) {
    float* const to = sums + first + v * kLanes;
    hn::StoreU(tile[v].x, kFloats, to);
    hn::StoreU(tile[v].y, kFloats, to + stride);
    hn::StoreU(tile[v].z, kFloats, to + 2 * stride);
  }
}

void AddWeighted(const Vec3f& base, std::span<const WeightedVector> terms, float* sums, std::size_t stride) {
  std::size_t first = 0;
  for (; first + 4 * kLanes <= stride; first += 4 * kLanes) AddTile<4>(base, terms, first, sums, stride);
  for (; first < stride; first += kLanes) AddTile<1>(base, terms, first, sums, stride);
}

// Compares the normals of one vector of lanes, which has a pose in each lane. Writes angles and errors, and raises
// `largest` to the largest squared length of an error. An error of NaN does not count.
HWY_INLINE void CompareLanes(const Lanes3& rendered, const Lanes3& right, float* degrees,
                             const std::array<float*, 3>& errors, Floats& largest) {
  const Floats zero = hn::Zero(kFloats), one = hn::Set(kFloats, 1.0F);
  const Lanes3 aside = Cross(rendered, right);
  const Floats across = hn::Sqrt(Dot(aside, aside)), along = Dot(rendered, right);
  const auto half = [&](auto number) HWY_ATTR {
    constexpr int kHalf = decltype(number)::value;
    return upper_angle(Real(ToDouble<kHalf>(across)), Real(ToDouble<kHalf>(along))).v;
  };
  const Doubles lower = half(std::integral_constant<int, 0>()), upper = half(std::integral_constant<int, 1>());
  const Floats angle = hn::Mul(hn::Set(kFloats, static_cast<float>(kDegreesPerRadian)), Joined(lower, upper));
  const Floats size = hn::Sqrt(Dot(rendered, rendered));
  const auto is_lit =
      hn::And(hn::And(hn::Gt(size, zero), hn::Le(size, hn::Set(kFloats, std::numeric_limits<float>::max()))),
              hn::Le(angle, hn::Set(kFloats, 180.5F)));
  const auto is_unknown = hn::And(hn::And(hn::Eq(right.x, zero), hn::Eq(right.y, zero)), hn::Eq(right.z, zero));
  hn::StoreU(
      hn::IfThenElse(is_unknown, hn::Set(kFloats, -1.0F), hn::IfThenElse(is_lit, angle, hn::Set(kFloats, 180.0F))),
      kFloats, degrees);
  const Floats scale = hn::Div(one, hn::IfThenElse(is_lit, size, one));
  const Floats side = hn::IfThenElse(is_unknown, hn::Set(kFloats, std::numeric_limits<float>::quiet_NaN()),
                                     hn::IfThenElse(is_lit, one, hn::Set(kFloats, 2.0F)));
  const auto error = [&](Floats shown, Floats true_one) HWY_ATTR {
    return hn::Sub(hn::IfThenElseZero(is_lit, hn::Mul(scale, shown)), hn::Mul(side, true_one));
  };
  const Lanes3 of_lanes{error(rendered.x, right.x), error(rendered.y, right.y), error(rendered.z, right.z)};
  hn::StoreU(of_lanes.x, kFloats, errors[0]);
  hn::StoreU(of_lanes.y, kFloats, errors[1]);
  hn::StoreU(of_lanes.z, kFloats, errors[2]);
  const Floats square = Dot(of_lanes, of_lanes);
  largest = hn::IfThenElse(hn::Gt(square, largest), square, largest);
}

float CompareNormals(const std::array<const float*, 3>& rendered, const std::array<const float*, 3>& right,
                     std::span<float> degrees, const std::array<float*, 3>& errors) {
  Floats largest = hn::Zero(kFloats);
  const auto load = [](const std::array<const float*, 3>& planes, std::size_t p) HWY_ATTR {
    return Lanes3{hn::LoadU(kFloats, planes[0] + p), hn::LoadU(kFloats, planes[1] + p),
                  hn::LoadU(kFloats, planes[2] + p)};
  };
  std::size_t p = 0;
  for (; p + kLanes <= degrees.size(); p += kLanes)
    CompareLanes(load(rendered, p), load(right, p), &degrees[p], {errors[0] + p, errors[1] + p, errors[2] + p},
                 largest);
  if (const std::size_t rest = degrees.size() - p; rest > 0) {
    float last[6][kLanes] = {}, of_last[4][kLanes];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::copy_n(rendered[axis] + p, rest, last[axis]);
      std::copy_n(right[axis] + p, rest, last[3 + axis]);
    }
    CompareLanes(load({last[0], last[1], last[2]}, 0), load({last[3], last[4], last[5]}, 0), of_last[3],
                 {of_last[0], of_last[1], of_last[2]}, largest);
    std::copy_n(of_last[3], rest, &degrees[p]);
    for (std::size_t axis = 0; axis < 3; ++axis) std::copy_n(of_last[axis], rest, errors[axis] + p);
  }
  float lanes[kLanes];
  hn::StoreU(largest, kFloats, lanes);
  return std::sqrt(*std::max_element(lanes, lanes + kLanes));
}

float LargestOpenness(const std::array<const float*, 3>& a, const std::array<const float*, 3>& b, std::size_t count) {
  const Floats zero = hn::Zero(kFloats), one = hn::Set(kFloats, 1.0F), two = hn::Set(kFloats, 2.0F);
  Floats largest = zero;
  for (std::size_t i = 0; i < count; i += kLanes) {
    const auto load = [i](const std::array<const float*, 3>& planes) HWY_ATTR {
      return Lanes3{hn::LoadU(kFloats, planes[0] + i), hn::LoadU(kFloats, planes[1] + i),
                    hn::LoadU(kFloats, planes[2] + i)};
    };
    const Lanes3 u = load(a), v = load(b), aside = Cross(u, v);
    const Floats across = Dot(aside, aside), along = Dot(u, v), both = hn::Add(across, hn::Mul(along, along));
    const auto any = hn::Gt(both, zero);
    const Floats square = hn::IfThenElseZero(any, hn::Div(across, hn::IfThenElse(any, both, one)));
    const Floats open = hn::IfThenElse(hn::Lt(along, zero), hn::Sub(two, square), square);
    largest = hn::IfThenElse(hn::Gt(open, largest), open, largest);
  }
  float lanes[kLanes];
  hn::StoreU(largest, kFloats, lanes);
  return *std::max_element(lanes, lanes + kLanes);
}

}  // namespace chronormal::inline internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace chronormal::inline internal {

HWY_EXPORT(AddWeighted);
HWY_EXPORT(CompareNormals);
HWY_EXPORT(LargestOpenness);

void add_weighted(const Vec3f& base, std::span<const WeightedVector> terms, float* sums, std::size_t stride) noexcept {
  assert(stride % kPosePadding == 0);
  HWY_DYNAMIC_DISPATCH(AddWeighted)(base, terms, sums, stride);
}

float compare_normals(const std::array<const float*, 3>& rendered, const std::array<const float*, 3>& right,
                      std::span<float> degrees, const std::array<float*, 3>& errors) noexcept {
  return HWY_DYNAMIC_DISPATCH(CompareNormals)(rendered, right, degrees, errors);
}

float largest_openness(const std::array<const float*, 3>& a, const std::array<const float*, 3>& b,
                       std::size_t count) noexcept {
  assert(count % kPosePadding == 0);
  return HWY_DYNAMIC_DISPATCH(LargestOpenness)(a, b, count);
}

}  // namespace chronormal::inline internal
#endif  // HWY_ONCE
