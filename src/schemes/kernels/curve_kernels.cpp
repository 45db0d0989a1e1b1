#include "schemes/kernels/curve_kernels.h"

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <iterator>
#include <utility>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "schemes/kernels/curve_kernels.cpp"

#include "simd/foreach_target-inl.h"
#include "simd/highway-inl.h"

#include "simd/highway-inl.h"

#include "schemes/kernels/formulas-inl.h"
#include "simd/intrinsics-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace chronormal::inline internal::HWY_NAMESPACE {

enum class Layout { kPacked, kPackedPastCaches, kPlanes };

// The memory to which the normals of whole blocks are written, and its layout.
struct BlockResult {
  float *x, *y, *z;
  Layout layout;

  // Stores the normals of the elements i, i + 1, ..., i + kStep - 1.
  HWY_INLINE void store(std::size_t i, const Triple<Lanes>& u) const {
    store(i, Lanes3{u.x.low, u.y.low, u.z.low});
    store(i + kLanes, Lanes3{u.x.high, u.y.high, u.z.high});
  }

  HWY_INLINE void store(std::size_t i, const Lanes3& v) const {
    if (layout == Layout::kPacked) {
      StorePacked<false>(v, x + 3 * i);
    } else if (layout == Layout::kPackedPastCaches) {
      StorePacked<true>(v, x + 3 * i);
    } else {
      hn::StoreU(v.x, kFloats, x + i);
      hn::StoreU(v.y, kFloats, y + i);
      hn::StoreU(v.z, kFloats, z + i);
    }
  }
};

// Prefetches the coefficients that are about 2 KiB further in memory, since they are read soon.
HWY_INLINE void PrefetchBlock(const float* block, std::size_t plane_count) {
  constexpr std::size_t kAhead = 2048 / sizeof(float);
  constexpr std::size_t kCacheLine = 64 / sizeof(float);
  for (std::size_t i = 0; i < plane_count * kBlock; i += kCacheLine) hwy::Prefetch(block + kAhead + i);
}

template <class F>
HWY_NOINLINE void EvaluateBlocks(const CoefficientBlocks& curves, std::size_t first_block, std::size_t block_count,
                                 const SharedValues& shared, const BlockResult& result_of_caller) {
  // The result and the shared values are copied, so that the compiler knows that no store changes them.
  const BlockResult result = result_of_caller;
  const SharedValues common = shared;

  const std::size_t plane_count = F::kPlanes > 0 ? F::kPlanes : curves.plane_count;
  const float* values = curves.values + first_block * plane_count * kBlock;
  for (std::size_t block = 0; block < block_count; ++block, values += plane_count * kBlock) {
    PrefetchBlock(values, plane_count);
    for (std::size_t i = 0; i < kBlock; i += kStep)
      result.store(block * kBlock + i, F::evaluate(Coefficients<Lanes>{values + i, plane_count}, common.data()));
  }
}

template <class F>
HWY_NOINLINE void AdvanceBlocks(const CoefficientBlocks& curves, std::size_t first_block, std::size_t block_count,
                                float* state, const BlockResult& result_of_caller) {
  const BlockResult result = result_of_caller;
  const float* values = curves.values + first_block * F::kPlanes * kBlock;
  state += first_block * F::kStatePlanes * kBlock;
  for (std::size_t block = 0; block < block_count; ++block) {
    PrefetchBlock(values, F::kPlanes);
    PrefetchBlock(state, F::kStatePlanes);
    for (std::size_t i = 0; i < kBlock; i += kStep) {
      const Coefficients<Lanes> c{values + i, F::kPlanes};
      result.store(block * kBlock + i, F::advance(c, State<Lanes>{state + i}));
    }
    values += F::kPlanes * kBlock;
    state += F::kStatePlanes * kBlock;
  }
}

// Calls visit() with an object of the class of the formula, for formulas that can be played.
template <class Visitor>
auto VisitPlayable(Formula formula, Visitor visit) {
  switch (formula) {
    case Formula::kSumOf2:
      return visit(WeightedSum<2>{});
    case Formula::kSumOf3:
      return visit(WeightedSum<3>{});
    case Formula::kSumOf4:
      return visit(WeightedSum<4>{});
    case Formula::kGreatArc:
      return visit(GreatArc{});
    default:
      assert(formula == Formula::kCircleArc);
      return visit(CircleArc{});
  }
}

template <class Visitor>
auto Visit(Formula formula, Visitor visit) {
  switch (formula) {
    case Formula::kSum:
      return visit(WeightedSum<0>{});
    case Formula::kRational:
      return visit(RationalQuadratic{});
    case Formula::kTimedCircleArc:
      return visit(TimedCircleArc{});
    case Formula::kDeCasteljau:
      return visit(SphericalDeCasteljau{});
    default:
      return VisitPlayable(formula, visit);
  }
}

// Calls write(first block, number of blocks, memory) until the normals of all elements are written. The memory is
// usually the result itself. The memory is a buffer, which is then copied to the result, if the result is neither
// packed nor in planes, and for a last block that is not full.
template <class Write>
void WriteBlocks(const CoefficientBlocks& curves, VectorView<float> result, std::size_t stream_from, Write write) {
  if (result.count == 0) return;
  std::size_t done = 0;  // number of blocks that are already written
  const bool packed = result.is_packed();
  if (packed || result.stride == 1) {
    done = result.count / kBlock;
    const bool stream = packed && result.count * (curves.plane_count + 3) * sizeof(float) > stream_from &&
                        reinterpret_cast<std::uintptr_t>(result.x) % 64 == 0;
    const Layout layout = !packed ? Layout::kPlanes : stream ? Layout::kPackedPastCaches : Layout::kPacked;
    write(0, done, BlockResult{result.x, result.y, result.z, layout});
    if (stream) hwy::FlushStream();
  }

  constexpr std::size_t kBuffered = 8 * kBlock;
  alignas(64) float x[kBuffered], y[kBuffered], z[kBuffered];
  for (std::size_t first = done * kBlock; first < result.count; first += kBuffered) {
    const std::size_t count = std::min(kBuffered, result.count - first);
    write(first / kBlock, (count + kBlock - 1) / kBlock, BlockResult{x, y, z, Layout::kPlanes});
    for (std::size_t i = 0; i < count; ++i) result.set(first + i, {x[i], y[i], z[i]});
  }
}

void EvaluateCurves(Formula formula, const CoefficientBlocks& curves, const SharedValues& shared,
                    VectorView<float> result, std::size_t stream_from) {
  const auto evaluate = Visit(formula, [](auto f) { return &EvaluateBlocks<decltype(f)>; });
  WriteBlocks(curves, result, stream_from, [&](std::size_t first, std::size_t count, const BlockResult& to) {
    evaluate(curves, first, count, shared, to);
  });
}

void AdvanceCurves(Formula formula, const CoefficientBlocks& curves, float* state, VectorView<float> result) {
  const auto advance = VisitPlayable(formula, [](auto f) { return &AdvanceBlocks<decltype(f)>; });
  WriteBlocks(curves, result, kStreamFrom, [&](std::size_t first, std::size_t count, const BlockResult& to) {
    advance(curves, first, count, state, to);
  });
}

}  // namespace chronormal::inline internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace chronormal::inline internal {

HWY_EXPORT(EvaluateCurves);
HWY_EXPORT(AdvanceCurves);

namespace {

std::vector<Counting> counting(std::span<const float> values) {
  std::vector<Counting> result;
  result.reserve(values.size());
  for (const float value : values) result.push_back(Counting(value));
  return result;
}

}  // namespace

SharedValues shared_values(Formula formula, double t) noexcept {
  assert(!is_sum(formula));
  SharedValues values{};
  if (formula != Formula::kRational) {
    values[0] = static_cast<float>(t);
    return values;
  }
  const double s = 1 - t;
  const double weights[] = {
      s * s, 2 * t * s, t * t, s * s * s * s, 4 * s * s * s * t, 6 * s * s * t * t, 4 * s * t * t * t, t * t * t * t};
  for (std::size_t k = 0; k < std::size(weights); ++k) values[k] = static_cast<float>(weights[k]);
  return values;
}

void evaluate_curves(Formula formula, const CoefficientBlocks& curves, const SharedValues& shared,
                     VectorView<float> result, std::size_t stream_from) noexcept {
  assert(result.count == curves.element_count);
  HWY_DYNAMIC_DISPATCH(EvaluateCurves)(formula, curves, shared, result, stream_from);
}

void advance_curves(Formula formula, const CoefficientBlocks& curves, float* state, VectorView<float> result) noexcept {
  assert(result.count == curves.element_count);
  HWY_DYNAMIC_DISPATCH(AdvanceCurves)(formula, curves, state, result);
}

OperationCounts count_evaluation(Formula formula, std::span<const float> coefficients, const SharedValues& shared) {
  const auto values = counting(coefficients);
  Counting::reset();
  HWY_NAMESPACE::Visit(formula, [&](auto f) {
    (void)decltype(f)::evaluate(HWY_NAMESPACE::Coefficients<Counting>{values.data(), values.size()}, shared.data());
  });
  return Counting::counts();
}

OperationCounts count_advance(Formula formula, std::span<const float> coefficients, std::span<const float> state) {
  const auto values = counting(coefficients);
  auto moving = counting(state);
  Counting::reset();
  HWY_NAMESPACE::VisitPlayable(formula, [&](auto f) {
    (void)decltype(f)::advance(HWY_NAMESPACE::Coefficients<Counting>{values.data(), values.size()},
                               HWY_NAMESPACE::State<Counting>{moving.data()});
  });
  return Counting::counts();
}

}  // namespace chronormal::inline internal

#endif  // HWY_ONCE
