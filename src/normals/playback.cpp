#include "chronormal/normals/playback.h"

#include <algorithm>
#include <cassert>

#include "normals/certificate.h"
#include "normals/curve_elements.h"

namespace chronormal {
namespace {

// docs/theory.md, section 4.9.
constexpr double kMaxShrinkage = 4;

// n and its differences: one vector per degree, and one.
std::size_t state_vectors(int degree) { return degree == 0 ? 0 : static_cast<std::size_t>(degree) + 1; }

// The control normals of element i of a run; a linear one has its middle halfway.
ControlNormals control_normals_at(const float* values, std::size_t stride, int degree) {
  const auto vector = [=](std::size_t k) {
    const float* p = values + 3 * k * stride;
    return to_double(Vec3f{p[0], p[stride], p[2 * stride]});
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

}  // namespace

NormalPlayback::NormalPlayback(const NormalCurves& curves, double start, double step, std::size_t anchor_interval)
    : curves_(&curves), start_(start), step_(step), anchor_interval_(anchor_interval) {
  std::size_t count = 0;
  for (const auto& run : curves.runs_) {
    count += 3 * state_vectors(run.degree) * run.count;
    if (run.degree == 0) continue;
    for (std::size_t i = 0; i < run.count; ++i) {
      const float* values = curves.values_.data() + run.offset + i;
      if (!can_be_played(control_normals_at(values, run.count, run.degree)))
        unplayed_.push_back({run.first + i, values, run.count, run.degree});
    }
  }
  state_.resize(count);
}

void NormalPlayback::anchor(double t) noexcept {
  float* state = state_.data();
  for (const auto& run : curves_->runs_) {
    if (run.degree == 0) continue;
    const float* values = curves_->values_.data() + run.offset;
    const auto n = three_planes(state, run.count), first = three_planes(state + 3 * run.count, run.count);
    const auto second = three_planes(state + (run.degree == 2 ? 6 : 3) * run.count, run.count);
    for (std::size_t i = 0; i < run.count; ++i) {
      const ControlNormals c = control_normals_at(values + i, run.count, run.degree);
      const Vec3d here = normal_at(c, t);
      if (run.degree == 2) second.set(i, to_float((2 * step_ * step_) * ((c.n0 - c.m) + (c.n1 - c.m))));
      n.set(i, to_float(here));
      first.set(i, to_float(normal_at(c, t + step_) - here));
    }
    state += 3 * state_vectors(run.degree) * run.count;
  }
}

std::size_t NormalPlayback::next(VectorView<float> result) noexcept {
  assert(result.count == curves_->size());
  const double t = start_ + static_cast<double>(index_) * step_;
  if (index_ == 0 || (anchor_interval_ != 0 && index_ % anchor_interval_ == 0)) anchor(t);
  ++index_;

  float* state = state_.data();
  for (const auto& run : curves_->runs_) {
    const VectorView<float> part = result.part({run.first, run.count});
    if (run.degree == 0) {
      const auto unit = three_planes(curves_->values_.data() + run.offset, run.count);
      fill(part, [unit](std::size_t i) { return unit[i]; });
      continue;
    }
    const auto n = three_planes(state, run.count), first = three_planes(state + 3 * run.count, run.count);
    if (run.degree == 1) {
      fill(part, [=](std::size_t i) {
        const Vec3f here = n[i];
        n.set(i, here + first[i]);
        return normalized(here);
      });
    } else {
      const auto second = three_planes(state + 6 * run.count, run.count);
      fill(part, [=](std::size_t i) {
        const QuadraticState<float> here{n[i], first[i], second[i]};
        const QuadraticState<float> next = here.next();
        n.set(i, next.n);
        first.set(i, next.first);
        return normalized(here.n);
      });
    }
    state += 3 * state_vectors(run.degree) * run.count;
  }
  for (const Unplayed& unplayed : unplayed_) {
    const ControlNormals c = control_normals_at(unplayed.values, unplayed.stride, unplayed.degree);
    result.set(unplayed.element, to_float(unit(normal_at(c, t))));
  }
  return curves_->flagged_unit_normals(t, result);
}

}  // namespace chronormal
