#include "chronormal/normals/normal_curves.h"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "core/blocks.h"
#include "normals/curves/curve_builder.h"
#include "normals/curves/kernels/curve_blocks.h"
#include "normals/curves/kernels/exact_normals.h"
#include "normals/curves/outputs.h"

namespace chronormal {
namespace {

// What one thread does at a time, and below which there is nothing to share out.
constexpr std::size_t kPiece = 8192;
// Of how many elements many t are evaluated before the next ones: as many as stay in the nearest cache; and where
// results go past the caches, as many as let each of these streams be long.
constexpr std::size_t kManyTimes = 1024, kManyTimesLarge = 8192;

std::size_t many_times_step(Access access) { return access.stream ? kManyTimesLarge : kManyTimes; }

float clamped_to_float(double value) {
  constexpr double kLargest = std::numeric_limits<float>::max();
  return static_cast<float>(std::clamp(value, -kLargest, kLargest));
}

Vec3f clamped_to_float(const Vec3d& v) { return {clamped_to_float(v.x), clamped_to_float(v.y), clamped_to_float(v.z)}; }

}  // namespace

NormalCurves& NormalCurves::operator=(NormalCurves&& other) noexcept {
  size_ = std::exchange(other.size_, 0);
  keeps_lengths_ = std::exchange(other.keeps_lengths_, true);
  degree_counts_ = std::exchange(other.degree_counts_, {});
  blocks_ = std::move(other.blocks_);
  runs_ = std::exchange(other.runs_, {});
  exponents_ = std::exchange(other.exponents_, {});
  flagged_ = std::exchange(other.flagged_, {});
  exact_ = std::exchange(other.exact_, {});
  scratch_ = std::exchange(other.scratch_, {});
  return *this;
}

NormalCurves::NormalCurves(std::span<const ControlNormals> normals, const CurveOptions& options)
    : NormalCurves(CurveBuilder::of_control_normals(normals, options)) {}

NormalCurves NormalCurves::of_faces(const Segment& segment, const CurveOptions& options, Threads threads,
                                    NormalCurves* reuse) {
  return CurveBuilder::of_faces(segment, options, threads, reuse);
}

NormalCurves NormalCurves::of_groups(const Segment& segment, const NormalGroups& groups, const CurveOptions& options,
                                     Threads threads, NormalCurves* reuse) {
  return CurveBuilder::of_groups(segment, groups, options, threads, reuse);
}

// One pass over the elements of a range, at one t. Returns how many have no direction.
template <class Output>
std::size_t NormalCurves::evaluate_range(IndexRange range, double t, const CurveWeights& weights,
                                         const Output& output) const noexcept {
  const std::size_t first_block = range.first / kTile;
  auto run = std::upper_bound(runs_.begin(), runs_.end(), first_block,
                              [](std::size_t block, const Run& r) { return block < r.first_block; });
  std::size_t element = range.first;
  for (--run; element < range.end(); ++run) {
    const auto kind = static_cast<BlockKind>(run->kind);
    const std::size_t end = std::min((run->first_block + run->block_count) * kTile, range.end());
    const std::size_t skipped = element - run->first_block * kTile;
    const std::byte* const blocks = blocks_.data() + run->offset + skipped * bytes_of(kind);
    output.write({blocks, kind, end - element}, weights, element);
    element = end;
  }

  return write_flagged(range, t, output);
}

template <class Output>
std::size_t NormalCurves::write_flagged(IndexRange range, double t, const Output& output) const noexcept {
  constexpr std::size_t kBatch = 64;
  Vec3f batch[kBatch];
  const auto index_of = [this](std::size_t element) {
    return static_cast<std::size_t>(std::lower_bound(flagged_.begin(), flagged_.end(), element) - flagged_.begin());
  };
  const std::size_t end = index_of(range.end());
  std::size_t without_direction = 0;
  for (std::size_t i = index_of(range.first); i < end; i += kBatch) {
    const std::size_t count = std::min(kBatch, end - i);
    without_direction += exact_unit_normals(std::span(exact_).subspan(i, count), t, std::span(batch, count));
    for (std::size_t k = 0; k < count; ++k) output.set(flagged_[i + k], batch[k]);
  }
  return without_direction;
}

std::size_t NormalCurves::write_flagged(double t, VectorView<float> result) const noexcept {
  return write_flagged({0, size_}, t, PlanesOutput(result, Access{}));
}

template <class Output>
std::size_t NormalCurves::evaluate_all(double t, const Output& output, Threads threads) const {
  if (size_ == 0) return 0;
  const CurveWeights weights = CurveWeights::at(t, !keeps_lengths_);
  return over_pieces(threads, kPiece, [&](IndexRange range) { return evaluate_range(range, t, weights, output); });
}

template <class Output>
std::size_t NormalCurves::evaluate_many(std::span<const double> times, std::span<const Output> outputs,
                                        std::size_t step, Threads threads) const {
  if (size_ == 0) return 0;
  std::vector<CurveWeights> weights;
  for (const double t : times) weights.push_back(CurveWeights::at(t, !keeps_lengths_));
  return over_pieces(threads, kPiece, [&](IndexRange piece) {
    std::size_t without_direction = 0;
    for (std::size_t first = piece.first; first < piece.end(); first += step) {
      const IndexRange range{first, std::min(step, piece.end() - first)};
      for (std::size_t k = 0; k < times.size(); ++k)
        without_direction += evaluate_range(range, times[k], weights[k], outputs[k]);
    }
    return without_direction;
  });
}

// Calls body(range) over all elements, on one thread as a whole or on all in pieces; returns the sum of the results.
template <class Body>
std::size_t NormalCurves::over_pieces(Threads threads, std::size_t piece, Body body) const {
  const auto flushed = [&](IndexRange range) {
    const std::size_t result = body(range);
    flush_stream();
    return result;
  };
  if (threads == Threads::kOne || size_ < 2 * piece) return flushed(IndexRange{0, size_});
  std::atomic<std::size_t> sum = 0;
  parallel_blocks(size_, piece, [&](IndexRange range) { sum += flushed(range); });
  return sum;
}

std::size_t NormalCurves::unit_normals(double t, VectorView<float> result, Threads threads) const {
  assert(result.count == size_);
  return with_output(result, access_of_pass(blocks_.size(), size_ * 3 * sizeof(float)),
                     [&](const auto& output) { return evaluate_all(t, output, threads); });
}

std::size_t NormalCurves::unit_normals(double t, std::span<Octahedral> result, Threads threads) const {
  assert(result.size() == size_);
  return evaluate_all(t, OctahedralOutput(result, access_of_pass(blocks_.size(), size_ * sizeof(Octahedral))), threads);
}

std::size_t NormalCurves::unit_normals(double t, std::span<Rgb10A2> result, Threads threads) const {
  assert(result.size() == size_);
  return evaluate_all(t, Rgb10A2Output(result, access_of_pass(blocks_.size(), size_ * sizeof(Rgb10A2))), threads);
}

std::size_t NormalCurves::unit_normals(std::span<const double> times, std::span<const VectorView<float>> results,
                                       Threads threads) const {
  assert(results.size() == times.size());
  const Access access = access_of_pass(blocks_.size(), times.size() * size_ * 3 * sizeof(float));
  if (std::all_of(results.begin(), results.end(), is_packed)) {
    std::vector<PackedOutput> outputs;
    for (const auto& result : results) outputs.emplace_back(result, access);
    return evaluate_many<PackedOutput>(times, outputs, many_times_step(access), threads);
  }
  if (std::all_of(results.begin(), results.end(), [](const auto& result) { return result.stride == 1; })) {
    std::vector<PlanesOutput> outputs;
    for (const auto& result : results) outputs.emplace_back(result, access);
    return evaluate_many<PlanesOutput>(times, outputs, many_times_step(access), threads);
  }
  std::size_t without_direction = 0;
  for (std::size_t k = 0; k < times.size(); ++k) without_direction += unit_normals(times[k], results[k], threads);
  return without_direction;
}

std::size_t NormalCurves::unit_normals(std::span<const double> times, std::span<const std::span<Octahedral>> results,
                                       Threads threads) const {
  assert(results.size() == times.size());
  std::vector<OctahedralOutput> outputs;
  const Access access = access_of_pass(blocks_.size(), times.size() * size_ * sizeof(Octahedral));
  for (const auto& result : results) {
    assert(result.size() == size_);
    outputs.emplace_back(result, access);
  }
  return evaluate_many<OctahedralOutput>(times, outputs, many_times_step(access), threads);
}

void NormalCurves::normals(double t, VectorView<float> result) const noexcept {
  assert(result.count == size_ && keeps_lengths_);
  const CurveWeights weights = CurveWeights::at(t, !keeps_lengths_);
  for (const Run& run : runs_) {
    const auto kind = static_cast<BlockKind>(run.kind);
    const std::size_t first = run.first_block * kTile, end = std::min(first + run.block_count * kTile, size_);
    for (std::size_t i = first; i < end; ++i) {
      const float* const p =
          reinterpret_cast<const float*>(blocks_.data() + run.offset + (i - first) / kTile * kTile * bytes_of(kind)) +
          i % kTile;
      const auto vector = [p](std::size_t k) {
        const float* const x = p + 3 * k * kTile;
        return Vec3f{x[0], x[kTile], x[2 * kTile]};
      };
      Vec3f n;
      if (kind == BlockKind::kUnitLength) {
        n = p[3 * kTile] * vector(0);
      } else if (kind == BlockKind::kLinear32) {
        n = weights.linear[0] * vector(0) + weights.linear[1] * vector(1);
      } else {
        n = weights.quadratic[0] * vector(0) + weights.quadratic[1] * vector(1) + weights.quadratic[2] * vector(2);
      }
      const int exponent = exponents_.empty() ? 0 : exponents_[i / kTile];
      result.set(i, exponent == 0 ? n : clamped_to_float(std::ldexp(1.0, exponent) * to_double(n)));
    }
  }
  for (std::size_t k = 0; k < flagged_.size(); ++k) result.set(flagged_[k], clamped_to_float(normal_at(exact_[k], t)));
}

std::size_t NormalCurves::bytes() const noexcept {
  const std::size_t filling = runs_.empty() ? 0 : (kTile - size_ % kTile) % kTile;
  const std::size_t unused = filling == 0 ? 0 : filling * bytes_of(static_cast<BlockKind>(runs_.back().kind));
  return blocks_.size() - unused + runs_.size() * sizeof(Run) + exponents_.size() * sizeof(std::int16_t) +
         flagged_.size() * (sizeof(std::size_t) + sizeof(ControlNormals));
}

std::vector<NormalCurves::ByteCount> NormalCurves::byte_counts() const {
  std::vector<ByteCount> counts;
  for (const Run& run : runs_) {
    const std::size_t first = run.first_block * kTile, end = std::min(first + run.block_count * kTile, size_);
    const std::size_t bytes = bytes_of(static_cast<BlockKind>(run.kind));
    const auto at = std::lower_bound(counts.begin(), counts.end(), bytes,
                                     [](const ByteCount& count, std::size_t b) { return count.bytes < b; });
    if (at != counts.end() && at->bytes == bytes) {
      at->elements += end - first;
    } else {
      counts.insert(at, {bytes, end - first});
    }
  }
  return counts;
}

}  // namespace chronormal
