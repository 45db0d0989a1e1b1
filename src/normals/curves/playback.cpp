#include "chronormal/normals/playback.h"

#include <algorithm>
#include <cassert>

#include "normals/curves/certificate.h"
#include "normals/curves/kernels/curve_blocks.h"
#include "normals/curves/kernels/play.h"
#include "normals/curves/outputs.h"

namespace chronormal {
namespace {

// docs/theory.md, section 4.9.
constexpr double kMaxShrinkage = 4;

constexpr std::size_t kVector = 3 * kTile;  // floats of one vector of a block

// The degree at which a kind of block is played; 0: not at all.
int played_degree(int kind) {
  switch (static_cast<BlockKind>(kind)) {
    case BlockKind::kLinear32:
      return 1;
    case BlockKind::kQuadratic32:
      return 2;
    default:
      return 0;
  }
}

std::size_t state_floats(int degree) { return degree == 0 ? 0 : static_cast<std::size_t>(degree + 1) * kVector; }

// A block of a run that is played.
const float* floats(const std::byte* run, int degree, std::size_t block) {
  return reinterpret_cast<const float*>(run) + block * static_cast<std::size_t>(degree + 1) * kVector;
}

// The control normals of one lane of a block of float32; a linear one has its middle halfway.
ControlNormals control_normals_at(const float* block, std::size_t lane, int degree) {
  const auto vector = [=](std::size_t k) {
    const float* p = block + k * kVector + lane;
    return to_double(Vec3f{p[0], p[kTile], p[2 * kTile]});
  };
  const Vec3d start = vector(0), end = vector(static_cast<std::size_t>(degree));
  return {start, degree == 2 ? vector(1) : 0.5 * (start + end), end};
}

bool can_be_played(const ControlNormals& c) {
  const double scale = 1 / largest_component(c);
  const Bernstein<Vec3d, 2> n = {scale * c.n0, scale * c.m, scale * c.n1};
  const double largest = std::max({length(n[0]), length(n[1]), length(n[2])});
  return stays_above(n, kMaxShrinkage, {largest, largest, largest});
}

void put(const Vec3d& v, std::size_t lane, float* plane) {
  plane[lane] = static_cast<float>(v.x);
  plane[kTile + lane] = static_cast<float>(v.y);
  plane[2 * kTile + lane] = static_cast<float>(v.z);
}

}  // namespace

NormalPlayback::NormalPlayback(const NormalCurves& curves, double start, double step, std::size_t anchor_interval)
    : curves_(&curves), start_(start), step_(step), anchor_interval_(anchor_interval) {
  std::size_t count = 0;
  for (const auto& run : curves.runs_) {
    const int degree = played_degree(run.kind);
    if (degree == 0) continue;
    count += state_floats(degree) * run.block_count;
    const std::size_t first = run.first_block * kTile;
    const std::size_t end = std::min(first + run.block_count * kTile, curves.size());
    for (std::size_t i = first; i < end; ++i) {
      const ControlNormals c = control_normals_at(
          floats(curves.blocks_.data() + run.offset, degree, (i - first) / kTile), i % kTile, degree);
      if (!can_be_played(c)) unplayed_.push_back({i, c});
    }
  }
  state_ = AlignedArray<float>(count);
}

void NormalPlayback::anchor(double t) noexcept {
  float* state = state_.data();
  for (const auto& run : curves_->runs_) {
    const int degree = played_degree(run.kind);
    if (degree == 0) continue;
    for (std::size_t b = 0; b < run.block_count; ++b) {
      for (std::size_t lane = 0; lane < kTile; ++lane) {
        const ControlNormals c =
            control_normals_at(floats(curves_->blocks_.data() + run.offset, degree, b), lane, degree);
        const Vec3d here = normal_at(c, t);
        put(here, lane, state);
        put(normal_at(c, t + step_) - here, lane, state + kVector);
        if (degree == 2) put((2 * step_ * step_) * ((c.n0 - c.m) + (c.n1 - c.m)), lane, state + 2 * kVector);
      }
      state += state_floats(degree);
    }
  }
}

std::size_t NormalPlayback::next(VectorView<float> result) noexcept {
  assert(result.count == curves_->size());
  const double t = start_ + static_cast<double>(index_) * step_;
  if (index_ == 0 || (anchor_interval_ != 0 && index_ % anchor_interval_ == 0)) anchor(t);
  ++index_;

  float* state = state_.data();
  const CurveWeights weights = CurveWeights::at(t, !curves_->keeps_lengths());
  for (const auto& run : curves_->runs_) {
    const int degree = played_degree(run.kind);
    const std::size_t first = run.first_block * kTile;
    const std::size_t end = std::min(first + run.block_count * kTile, curves_->size());
    const VectorView<float> part = result.part({first, end - first});
    if (degree == 0) {
      const BlockSpan span{curves_->blocks_.data() + run.offset, static_cast<BlockKind>(run.kind), part.count};
      with_output(part, Access{}, [&](const auto& output) { output.write(span, weights, 0); });
      continue;
    }
    const std::size_t whole = is_packed(part) || part.stride == 1 ? part.count / kTile : 0;
    if (is_packed(part)) {
      play_blocks(state, whole, degree, PackedResult{part.x});
    } else {
      play_blocks(state, whole, degree, PlanesResult{part.x, part.y, part.z});
    }
    for (std::size_t b = whole; b < run.block_count; ++b) {
      alignas(64) float x[kTile], y[kTile], z[kTile];
      play_blocks(state + b * state_floats(degree), 1, degree, PlanesResult{x, y, z});
      for (std::size_t i = b * kTile; i < std::min((b + 1) * kTile, part.count); ++i)
        part.set(i, {x[i % kTile], y[i % kTile], z[i % kTile]});
    }
    state += run.block_count * state_floats(degree);
  }
  for (const Unplayed& unplayed : unplayed_)
    result.set(unplayed.element, to_float(unit(normal_at(unplayed.normals, t))));
  return curves_->write_flagged(t, result);
}

}  // namespace chronormal
