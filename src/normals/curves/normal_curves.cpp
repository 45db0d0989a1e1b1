// Evaluates NormalCurves in one pass over the runs of blocks (curve_data.h). Each run is passed to the kernel as a
// whole. Then the flagged elements, for which float32 is not accurate enough, are overwritten with values computed in
// double. outputs.h lists the forms of results.

#include "chronormal/normals/normal_curves.h"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "core/blocks.h"
#include "normals/control/exact_curve.h"
#include "normals/control/local_time.h"
#include "normals/curves/certificate.h"
#include "normals/curves/curve_builder.h"
#include "normals/curves/curve_count.h"
#include "normals/curves/curve_data.h"
#include "normals/curves/curve_evaluation.h"
#include "normals/curves/kernels/curve_blocks.h"
#include "normals/curves/outputs.h"

namespace chronormal {
namespace {

// The number of elements that a thread takes at a time. If there are fewer than twice as many elements, one thread
// computes all of them.
constexpr std::size_t kPiece = 8192;
// The number of elements that are evaluated at all requested t before the next elements are evaluated. kManyTimes
// elements fit into the nearest cache. kManyTimesLarge is for results that bypass the caches, which should be written
// in long runs.
constexpr std::size_t kManyTimes = 1024, kManyTimesLarge = 8192;

std::size_t many_times_step(MemoryAccess access) { return access.stream ? kManyTimesLarge : kManyTimes; }

float clamped_to_float(double value) {
  constexpr double kLargest = std::numeric_limits<float>::max();
  return static_cast<float>(std::clamp(value, -kLargest, kLargest));
}

Vec3f clamped_to_float(const Vec3d& v) { return {clamped_to_float(v.x), clamped_to_float(v.y), clamped_to_float(v.z)}; }

// Returns true if double is certain of the direction of n(t), or certain that n(t) has no direction. Control normals
// are taken as exact.
bool has_certain_direction(const ControlNormals& c, double t) {
  const double s = 1 - t;
  const double size = s * s * max_abs(c.n0) + 2 * t * s * max_abs(c.m) + t * t * max_abs(c.n1);
  return largest_component(c) == 0 || max_abs(normal_at(c, t)) > smallest_certain(0) * size;
}

// Writes (0, 0, 0) as all normals, for a time that is NaN, and returns the number of normals.
template <class Output>
std::size_t write_zeros(std::size_t size, const Output& output) {
  for (std::size_t i = 0; i < size; ++i) output.set(i, {});
  return size;
}

// Calls body(range) for all elements, either for all at once on this thread, or for pieces on all threads. Returns the
// sum of the results of the calls.
template <class Body>
std::size_t over_pieces(std::size_t size, Threads threads, Body body) {
  const auto flushed = [&](IndexRange range) {
    const std::size_t result = body(range);
    flush_stream();
    return result;
  };
  if (threads == Threads::kOne || size < 2 * kPiece) return flushed(IndexRange{0, size});
  std::atomic<std::size_t> sum = 0;
  parallel_blocks(size, kPiece, [&](IndexRange range) { sum += flushed(range); });
  return sum;
}

template <class Output>
std::size_t evaluate_all(const CurveData& curves, const LocalTime& time, const Output& output, Threads threads) {
  if (curves.size == 0) return 0;
  if (std::isnan(time)) return write_zeros(curves.size, output);
  const LocalTime t = local_time(time);
  const CurveWeights weights = CurveWeights::at(t, !curves.keeps_lengths);
  return over_pieces(curves.size, threads,
                     [&](IndexRange range) { return evaluate_range(curves, range, t, weights, output); });
}

template <class Output>
std::size_t evaluate_many(const CurveData& curves, std::span<const double> times, const std::vector<Output>& outputs,
                          std::size_t step, Threads threads) {
  if (curves.size == 0) return 0;
  struct AtTime {
    double t;
    CurveWeights weights;
    const Output* output;
  };
  std::vector<AtTime> all;
  std::size_t without_time = 0;
  for (std::size_t k = 0; k < times.size(); ++k) {
    const double t = local_time(times[k]);
    if (std::isnan(t)) {
      without_time += write_zeros(curves.size, outputs[k]);
    } else {
      all.push_back({t, CurveWeights::at(t, !curves.keeps_lengths), &outputs[k]});
    }
  }
  const std::size_t others = over_pieces(curves.size, threads, [&](IndexRange piece) {
    std::size_t without_direction = 0;
    for (std::size_t first = piece.first; first < piece.end(); first += step) {
      const IndexRange range{first, std::min(step, piece.end() - first)};
      for (const AtTime& at : all) without_direction += evaluate_range(curves, range, at.t, at.weights, *at.output);
    }
    return without_direction;
  });
  return without_time + others;
}

}  // namespace

NormalCurves::NormalCurves() noexcept = default;
NormalCurves::NormalCurves(NormalCurves&&) noexcept = default;
NormalCurves& NormalCurves::operator=(NormalCurves&&) noexcept = default;
NormalCurves::~NormalCurves() = default;

NormalCurves::NormalCurves(std::unique_ptr<CurveData> data) noexcept : data_(std::move(data)) {}

NormalCurves::NormalCurves(std::span<const ControlNormals> normals, const CurveOptions& options)
    : NormalCurves(std::make_unique<CurveData>(build_curves(normals, options))) {}

NormalCurves NormalCurves::of_faces(const Segment& segment, const CurveOptions& options, Threads threads,
                                    NormalCurves* reuse) {
  return NormalCurves(std::make_unique<CurveData>(build_curves(segment, options, threads, data_of(reuse))));
}

NormalCurves NormalCurves::of_groups(const Segment& segment, const NormalGroups& groups, const CurveOptions& options,
                                     Threads threads, NormalCurves* reuse) {
  return NormalCurves(std::make_unique<CurveData>(build_curves(segment, groups, options, threads, data_of(reuse))));
}

const CurveData& NormalCurves::data() const noexcept {
  if (data_) return *data_;
  static const CurveData none;
  return none;
}

// Returns the data of curves whose memory is to be reused. Curves without elements may have no data. Such curves get
// empty data, in which memory can be kept.
CurveData* NormalCurves::data_of(NormalCurves* reuse) {
  if (reuse == nullptr) return nullptr;
  if (!reuse->data_) reuse->data_ = std::make_unique<CurveData>();
  return reuse->data_.get();
}

std::size_t NormalCurves::unit_normals(const LocalTime& t, VectorView<float> result, Threads threads) const {
  const CurveData& curves = data();
  assert(result.count == curves.size);
  return with_output(result, access_of_pass(curves.blocks.size(), curves.size * 3 * sizeof(float)),
                     [&](const auto& output) { return evaluate_all(curves, t, output, threads); });
}

std::size_t NormalCurves::unit_normals(const LocalTime& t, std::span<Octahedral> result, Threads threads) const {
  const CurveData& curves = data();
  assert(result.size() == curves.size);
  const MemoryAccess access = access_of_pass(curves.blocks.size(), curves.size * sizeof(Octahedral));
  return evaluate_all(curves, t, OctahedralOutput(result, access), threads);
}

std::size_t NormalCurves::unit_normals(const LocalTime& t, std::span<Rgb10A2> result, Threads threads) const {
  const CurveData& curves = data();
  assert(result.size() == curves.size);
  const MemoryAccess access = access_of_pass(curves.blocks.size(), curves.size * sizeof(Rgb10A2));
  return evaluate_all(curves, t, Rgb10A2Output(result, access), threads);
}

std::size_t NormalCurves::unit_normals(std::span<const double> times, std::span<const VectorView<float>> results,
                                       Threads threads) const {
  const CurveData& curves = data();
  assert(results.size() == times.size());
  const MemoryAccess access = access_of_pass(curves.blocks.size(), times.size() * curves.size * 3 * sizeof(float));
  if (std::all_of(results.begin(), results.end(), is_packed)) {
    std::vector<PackedOutput> outputs;
    for (const auto& result : results) outputs.emplace_back(result, access);
    return evaluate_many(curves, times, outputs, many_times_step(access), threads);
  }
  if (std::all_of(results.begin(), results.end(), [](const auto& result) { return result.stride == 1; })) {
    std::vector<PlanesOutput> outputs;
    for (const auto& result : results) outputs.emplace_back(result, access);
    return evaluate_many(curves, times, outputs, many_times_step(access), threads);
  }
  std::size_t without_direction = 0;
  for (std::size_t k = 0; k < times.size(); ++k) without_direction += unit_normals(times[k], results[k], threads);
  return without_direction;
}

std::size_t NormalCurves::unit_normals(std::span<const double> times, std::span<const std::span<Octahedral>> results,
                                       Threads threads) const {
  const CurveData& curves = data();
  assert(results.size() == times.size());
  std::vector<OctahedralOutput> outputs;
  const MemoryAccess access = access_of_pass(curves.blocks.size(), times.size() * curves.size * sizeof(Octahedral));
  for (const auto& result : results) {
    assert(result.size() == curves.size);
    outputs.emplace_back(result, access);
  }
  return evaluate_many(curves, times, outputs, many_times_step(access), threads);
}

std::size_t NormalCurves::uncertain_count(double time) const noexcept {
  const CurveData& curves = data();
  const double t = local_time(time);
  // At t = 0 and t = 1, n(t) is a control normal and nothing is rounded, so no element is uncertain there.
  if (!(0 < t && t < 1)) return 0;
  std::size_t count = 0;
  for_flagged(
      curves, {0, curves.size}, t, [](std::size_t, const float*, std::size_t) {},
      [&](std::size_t index, std::size_t element) {
        if (digits_of(curves, element) == nullptr && !has_certain_direction(curves.flagged.scaled_normals(index), t))
          ++count;
      });
  return count;
}

void NormalCurves::normals(const LocalTime& time, VectorView<float> result) const noexcept {
  const CurveData& curves = data();
  assert(result.count == curves.size && curves.keeps_lengths);
  if (std::isnan(time)) {
    for (std::size_t i = 0; i < result.count; ++i) result.set(i, {});
    return;
  }
  const LocalTime t = local_time(time);
  const CurveWeights weights = CurveWeights::at(t, !curves.keeps_lengths);
  for (const CurveData::Run& run : curves.runs) {
    if (run.kind == BlockKind::kNone) continue;
    const IndexRange elements = run.elements(curves.size);
    for (std::size_t i = elements.first; i < elements.end(); ++i) {
      const std::size_t block = (i - elements.first) / kTile;
      const float* const p =
          reinterpret_cast<const float*>(curves.blocks.data() + run.offset + block * kTile * bytes_of(run.kind)) +
          i % kTile;
      const auto vector = [p](std::size_t k) {
        const float* const x = p + 3 * k * kTile;
        return Vec3f{x[0], x[kTile], x[2 * kTile]};
      };
      Vec3f n;
      if (run.kind == BlockKind::kUnitLength) {
        n = p[3 * kTile] * vector(0);
      } else if (run.kind == BlockKind::kLinear32) {
        n = weights.linear[0] * vector(0) + weights.linear[1] * vector(1);
      } else {
        n = weights.quadratic[0] * vector(0) + weights.quadratic[1] * vector(1) + weights.quadratic[2] * vector(2);
      }
      const int exponent = curves.exponents.empty() ? 0 : curves.exponents[i / kTile];
      result.set(i, exponent == 0 ? n : clamped_to_float(std::ldexp(1.0, exponent) * to_double(n)));
    }
  }
  for (std::size_t k = 0; k < curves.flagged.size(); ++k) {
    const std::int32_t* const digits = digits_of(curves, curves.flagged.numbers[k]);
    result.set(curves.flagged.numbers[k],
               clamped_to_float(digits != nullptr ? ExactCurve::of_kept(digits).normal_at(t)
                                                  : std::ldexp(1.0, curves.flagged.exponents[k]) *
                                                        normal_at(curves.flagged.scaled_normals(k), t)));
  }
}

std::size_t NormalCurves::size() const noexcept { return data().size; }
bool NormalCurves::keeps_lengths() const noexcept { return data().keeps_lengths; }
const std::array<std::size_t, 3>& NormalCurves::degree_counts() const noexcept { return data().degree_counts; }
std::size_t NormalCurves::flagged_count() const noexcept { return data().flagged.size(); }

std::size_t NormalCurves::bytes() const noexcept { return CurveCount::of(data()).bytes(data().size); }

std::vector<NormalCurves::ByteCount> NormalCurves::byte_counts() const {
  std::vector<ByteCount> counts;
  for (const CurveData::Run& run : data().runs) {
    const std::size_t bytes = bytes_of(run.kind), elements = run.elements(data().size).count;
    const auto at = std::lower_bound(counts.begin(), counts.end(), bytes,
                                     [](const ByteCount& count, std::size_t b) { return count.bytes < b; });
    if (at != counts.end() && at->bytes == bytes) {
      at->elements += elements;
    } else {
      counts.insert(at, {bytes, elements});
    }
  }
  return counts;
}

}  // namespace chronormal
