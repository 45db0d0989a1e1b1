// NormalPlayback: forward differences of the blocks that are kept in float32, made anew at anchors.

#include "chronormal/normals/playback.h"

#include <algorithm>
#include <cassert>
#include <vector>

#include "core/memory.h"
#include "normals/curves/certificate.h"
#include "normals/curves/curve_data.h"
#include "normals/curves/kernels/curve_blocks.h"
#include "normals/curves/kernels/play.h"
#include "normals/curves/outputs.h"

namespace chronormal {
namespace {

// docs/theory.md, section 4.9.
constexpr double kMaxShrinkage = 4;

constexpr std::size_t kVector = 3 * kTile;  // floats of one vector of a block

// The degree at which a kind of block is played; 0: not at all.
int played_degree(BlockKind kind) {
  switch (kind) {
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

struct NormalPlayback::Parts {
  // An element that is not played.
  struct Unplayed {
    std::size_t element;
    ControlNormals normals;
  };

  Parts(const CurveData& curves, double start, double step, std::size_t anchor_interval);

  void anchor(double t) noexcept;
  std::size_t next(VectorView<float> result) noexcept;

  const CurveData& curves;
  double start, step;
  std::size_t anchor_interval;
  std::size_t index = 0;      // of the current step
  AlignedArray<float> state;  // of the blocks that are played, in their order
  std::vector<Unplayed> unplayed;
};

NormalPlayback::Parts::Parts(const CurveData& of_curves, double from, double by, std::size_t interval)
    : curves(of_curves), start(from), step(by), anchor_interval(interval) {
  std::size_t count = 0;
  for (const CurveData::Run& run : curves.runs) {
    const int degree = played_degree(run.kind);
    if (degree == 0) continue;
    count += state_floats(degree) * run.block_count;
    const IndexRange elements = run.elements(curves.size);
    for (std::size_t i = elements.first; i < elements.end(); ++i) {
      const float* const block = floats(curves.blocks.data() + run.offset, degree, (i - elements.first) / kTile);
      const ControlNormals c = control_normals_at(block, i % kTile, degree);
      if (!can_be_played(c)) unplayed.push_back({i, c});
    }
  }
  state = AlignedArray<float>(count);
}

void NormalPlayback::Parts::anchor(double t) noexcept {
  float* at = state.data();
  for (const CurveData::Run& run : curves.runs) {
    const int degree = played_degree(run.kind);
    if (degree == 0) continue;
    for (std::size_t b = 0; b < run.block_count; ++b) {
      for (std::size_t lane = 0; lane < kTile; ++lane) {
        const ControlNormals c = control_normals_at(floats(curves.blocks.data() + run.offset, degree, b), lane, degree);
        const Vec3d here = normal_at(c, t);
        put(here, lane, at);
        put(normal_at(c, t + step) - here, lane, at + kVector);
        if (degree == 2) put((2 * step * step) * ((c.n0 - c.m) + (c.n1 - c.m)), lane, at + 2 * kVector);
      }
      at += state_floats(degree);
    }
  }
}

std::size_t NormalPlayback::Parts::next(VectorView<float> result) noexcept {
  assert(result.count == curves.size);
  const double t = start + static_cast<double>(index) * step;
  if (index == 0 || (anchor_interval != 0 && index % anchor_interval == 0)) anchor(t);
  ++index;

  float* at = state.data();
  const CurveWeights weights = CurveWeights::at(t, !curves.keeps_lengths);
  for (const CurveData::Run& run : curves.runs) {
    const int degree = played_degree(run.kind);
    const VectorView<float> part = result.part(run.elements(curves.size));
    if (degree == 0) {
      const BlockSpan span{curves.blocks.data() + run.offset, run.kind, part.count};
      with_output(part, MemoryAccess{}, [&](const auto& output) { output.write(span, weights, 0); });
      continue;
    }
    const std::size_t whole = is_packed(part) || part.stride == 1 ? part.count / kTile : 0;
    if (is_packed(part)) {
      play_blocks(at, whole, degree, PackedResult{part.x});
    } else {
      play_blocks(at, whole, degree, PlanesResult{part.x, part.y, part.z});
    }
    for (std::size_t b = whole; b < run.block_count; ++b) {
      alignas(64) float x[kTile], y[kTile], z[kTile];
      play_blocks(at + b * state_floats(degree), 1, degree, PlanesResult{x, y, z});
      for (std::size_t i = b * kTile; i < std::min((b + 1) * kTile, part.count); ++i)
        part.set(i, {x[i % kTile], y[i % kTile], z[i % kTile]});
    }
    at += run.block_count * state_floats(degree);
  }
  for (const Unplayed& element : unplayed) result.set(element.element, to_float(unit(normal_at(element.normals, t))));
  return write_flagged(curves, t, result);
}

NormalPlayback::NormalPlayback(const NormalCurves& curves, double start, double step, std::size_t anchor_interval)
    : parts_(std::make_unique<Parts>(curves.data(), start, step, anchor_interval)) {}

NormalPlayback::NormalPlayback(NormalPlayback&&) noexcept = default;
NormalPlayback& NormalPlayback::operator=(NormalPlayback&&) noexcept = default;
NormalPlayback::~NormalPlayback() = default;

std::size_t NormalPlayback::next(VectorView<float> result) noexcept { return parts_->next(result); }
std::size_t NormalPlayback::unplayed_count() const noexcept { return parts_->unplayed.size(); }
std::size_t NormalPlayback::bytes() const noexcept { return parts_->state.size() * sizeof(float); }

}  // namespace chronormal
