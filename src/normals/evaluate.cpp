#include "chronormal/normals/evaluate.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "chronormal/core/polynomial.h"
#include "normals/certificate.h"
#include "normals/curve_elements.h"

namespace chronormal {
namespace {

// docs/theory.md, section 5: below this ratio of sum w_k |c_k| to |n(t)|, float32 is within 1e-6 rad.
constexpr double kMaxCancellation = 3;

// Planes are scaled so that the largest component is near 2^50 and none that counts is below 2^-58: then |n(t)|^2 stays
// between 2^-122 and 2^104.
constexpr int kLargestExponent = 50;
constexpr double kSmallestShare = 0x1p-108;
// Below this, that scale itself would leave the range of double.
constexpr double kSmallestMesh = 0x1p-900;

constexpr std::size_t kShortestRun = 8;

// Whether float32 can be trusted with this element at every t. `largest` is that of all elements.
bool float_suffices(const ControlNormals& normals, double largest) {
  const double smallest_end = std::min(max_abs(normals.n0), max_abs(normals.n1));
  if (!(smallest_end >= kSmallestShare * largest) || !(largest >= kSmallestMesh)) return false;

  const double scale = 1 / largest_component(normals);
  const Bernstein<Vec3d, 2> n = {scale * normals.n0, scale * normals.m, scale * normals.n1};
  return stays_above(n, kMaxCancellation, {length(n[0]), length(n[1]), length(n[2])});
}

struct DegreeRun {
  std::size_t count;
  int degree;
};

// Joins runs of `degree` that are too short to pay into the neighbour of the next higher degree.
std::vector<DegreeRun> raise_short_runs(const std::vector<DegreeRun>& runs, int degree) {
  std::vector<DegreeRun> result;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    DegreeRun run = runs[i];
    if (run.degree == degree && run.count < kShortestRun) {
      int raised = 3;
      if (i > 0 && runs[i - 1].degree > degree) raised = std::min(raised, runs[i - 1].degree);
      if (i + 1 < runs.size() && runs[i + 1].degree > degree) raised = std::min(raised, runs[i + 1].degree);
      if (raised < 3) run.degree = raised;
    }
    if (!result.empty() && result.back().degree == run.degree)
      result.back().count += run.count;
    else
      result.push_back(run);
  }
  return result;
}

std::size_t planes_of(int degree) { return degree == 0 ? 4 : 3 * (static_cast<std::size_t>(degree) + 1); }

float clamped_to_float(double value) {
  constexpr double kLargest = std::numeric_limits<float>::max();
  return static_cast<float>(std::clamp(value, -kLargest, kLargest));
}

Vec3f clamped_to_float(const Vec3d& v) { return {clamped_to_float(v.x), clamped_to_float(v.y), clamped_to_float(v.z)}; }

}  // namespace

NormalCurves::NormalCurves(std::span<const ControlNormals> normals) : size_(normals.size()) {
  double largest = 0;
  for (const ControlNormals& c : normals) largest = std::fmax(largest, largest_component(c));
  exponent_ = largest >= kSmallestMesh ? std::ilogb(largest) - kLargestExponent : 0;

  // Find the degree of every element, flag those that float32 cannot carry, and collect runs.
  std::vector<DegreeRun> runs;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    int element_degree = degree(normals[i]);
    ++degree_counts_[static_cast<std::size_t>(element_degree)];
    if (!float_suffices(normals[i], largest)) {
      flagged_.push_back({i, normals[i]});
      element_degree = runs.empty() ? 0 : runs.back().degree;  // its place in the planes is not read: join any run
    }
    if (!runs.empty() && runs.back().degree == element_degree)
      ++runs.back().count;
    else
      runs.push_back({1, element_degree});
  }
  runs = raise_short_runs(raise_short_runs(runs, 0), 1);

  std::size_t value_count = 0;
  for (const DegreeRun& run : runs) value_count += run.count * planes_of(run.degree);
  values_.assign(value_count, 1.0f);

  std::size_t first = 0, offset = 0, next_flagged = 0;
  for (const DegreeRun& run : runs) {
    runs_.push_back({first, run.count, offset, run.degree});
    for (std::size_t i = 0; i < run.count; ++i) {
      if (next_flagged < flagged_.size() && flagged_[next_flagged].element == first + i) {
        ++next_flagged;
        continue;
      }
      float* value = values_.data() + offset + i;
      const auto put = [&](const Vec3d& v) {
        for (const double component : {v.x, v.y, v.z}) {
          *value = static_cast<float>(component);
          value += run.count;
        }
      };
      const auto scaled = [this](const Vec3d& v) { return std::ldexp(1.0, -exponent_) * v; };
      const ControlNormals& c = normals[first + i];
      if (run.degree == 0) {
        put(unit(c.n0));
        *value = static_cast<float>(std::ldexp(length(c.n0), -exponent_));
      } else {
        put(scaled(c.n0));
        if (run.degree == 2) put(scaled(c.m));
        put(scaled(c.n1));
      }
    }
    first += run.count;
    offset += run.count * planes_of(run.degree);
  }
}

std::size_t NormalCurves::unit_normals(double t, VectorView<float> result) const noexcept {
  assert(result.count == size_);
  const auto weights = QuadraticWeights<float>::at(t);
  const float start_weight = static_cast<float>(1 - t), end_weight = static_cast<float>(t);

  for (const Run& run : runs_) {
    const VectorView<float> part = result.part({run.first, run.count});
    const auto c0 = three_planes(values_.data() + run.offset, run.count);
    if (run.degree == 0) {
      fill(part, [c0](std::size_t i) { return c0[i]; });
      continue;
    }
    const auto c1 = three_planes(c0.z + run.count, run.count);
    if (run.degree == 1) {
      fill(part, [=](std::size_t i) { return normalized(start_weight * c0[i] + end_weight * c1[i]); });
      continue;
    }
    const auto c2 = three_planes(c1.z + run.count, run.count);
    fill(part, [=](std::size_t i) { return normalized(quadratic_normal(c0[i], c1[i], c2[i], weights)); });
  }

  return flagged_unit_normals(t, result);
}

std::size_t NormalCurves::flagged_unit_normals(double t, VectorView<float> result) const noexcept {
  std::size_t without_direction = 0;
  for (const Flagged& flagged : flagged_) {
    const UnitNormal u = unit_normal_at(flagged.exact, t);
    result.set(flagged.element, to_float(u.vector));
    if (u.direction == Direction::kNone) ++without_direction;
  }
  return without_direction;
}

void NormalCurves::normals(double t, VectorView<float> result) const noexcept {
  assert(result.count == size_);
  const auto weights = QuadraticWeights<float>::at(t);
  const float start_weight = static_cast<float>(1 - t), end_weight = static_cast<float>(t);
  const double scale = std::ldexp(1.0, exponent_);
  const auto unscaled = [scale](const Vec3f& v) { return clamped_to_float(scale * to_double(v)); };

  for (const Run& run : runs_) {
    const VectorView<float> part = result.part({run.first, run.count});
    const auto c0 = three_planes(values_.data() + run.offset, run.count);
    if (run.degree == 0) {
      const float* lengths = c0.z + run.count;
      fill(part, [=](std::size_t i) { return unscaled(lengths[i] * c0[i]); });
      continue;
    }
    const auto c1 = three_planes(c0.z + run.count, run.count);
    if (run.degree == 1) {
      fill(part, [=](std::size_t i) { return unscaled(start_weight * c0[i] + end_weight * c1[i]); });
      continue;
    }
    const auto c2 = three_planes(c1.z + run.count, run.count);
    fill(part, [=](std::size_t i) { return unscaled(quadratic_normal(c0[i], c1[i], c2[i], weights)); });
  }
  for (const Flagged& flagged : flagged_) result.set(flagged.element, clamped_to_float(normal_at(flagged.exact, t)));
}

std::size_t NormalCurves::bytes() const noexcept {
  return values_.size() * sizeof(float) + runs_.size() * sizeof(Run) + flagged_.size() * sizeof(Flagged);
}

}  // namespace chronormal
