#include "chronormal/normals/playback.h"

#include <cassert>

#include "normals/curve_elements.h"

namespace chronormal {
namespace {

// n and its differences: one vector per degree, and one.
std::size_t state_vectors(int degree) { return degree == 0 ? 0 : static_cast<std::size_t>(degree) + 1; }

}  // namespace

NormalPlayback::NormalPlayback(const NormalCurves& curves, double start, double step, std::size_t anchor_interval)
    : curves_(&curves), start_(start), step_(step), anchor_interval_(anchor_interval) {
  std::size_t count = 0;
  for (const auto& run : curves.runs_) count += 3 * state_vectors(run.degree) * run.count;
  state_.resize(count);
}

void NormalPlayback::anchor(double t) noexcept {
  float* state = state_.data();
  for (const auto& run : curves_->runs_) {
    if (run.degree == 0) continue;
    const float* values = curves_->values_.data() + run.offset;
    const auto c0 = three_planes(values, run.count), c1 = three_planes(values + 3 * run.count, run.count);
    const auto c2 = run.degree == 2 ? three_planes(values + 6 * run.count, run.count) : c1;
    const auto n = three_planes(state, run.count), first = three_planes(state + 3 * run.count, run.count);
    for (std::size_t i = 0; i < run.count; ++i) {
      const Vec3d start = to_double(c0[i]), end = to_double(c2[i]);
      const Vec3d middle = run.degree == 2 ? to_double(c1[i]) : 0.5 * (start + end);
      const ControlNormals curve{start, middle, end};
      const Vec3d here = normal_at(curve, t);
      n.set(i, to_float(here));
      first.set(i, to_float(normal_at(curve, t + step_) - here));
    }
    if (run.degree == 2) {
      const auto second = three_planes(state + 6 * run.count, run.count);
      for (std::size_t i = 0; i < run.count; ++i) {
        const Vec3d middle = to_double(c1[i]);
        const Vec3d bend = (to_double(c0[i]) - middle) + (to_double(c2[i]) - middle);
        second.set(i, to_float((2 * step_ * step_) * bend));
      }
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
  return curves_->flagged_unit_normals(t, result);
}

}  // namespace chronormal
