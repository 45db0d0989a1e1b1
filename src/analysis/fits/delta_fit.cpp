#include "analysis/fits/delta_fit.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "core/cholesky.h"

namespace chronormal::inline internal {
namespace {

// The weight of the penalty that keeps deltas near the start deltas if the rows of the fit do not determine the deltas.
// The weight is relative to the mean of the matrix's diagonal.
constexpr double kRidge = 1e-9;

Vec3d at(const std::vector<float>& values, std::size_t i) {
  return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
}

// Factors the linear system of some targets, whose indices are `named`. The matrix is a part of the normal equations of
// all targets.
Cholesky factor(const std::vector<double>& matrix, std::size_t size, std::span<const std::uint32_t> named) {
  const std::size_t count = named.size();
  std::vector<double> part(count * count);
  double trace = 0;
  for (const std::uint32_t i : named) trace += matrix[i * size + i];
  const double ridge = trace > 0 ? kRidge * trace / static_cast<double>(count) : 1;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j <= i; ++j)
      part[i * count + j] = matrix[named[i] * size + named[j]] + (i == j ? ridge : 0);
  }
  return Cholesky(std::move(part), count, ridge);
}

// A target with a delta at an element, and the place of the delta in the target's list.
struct Entry {
  std::uint32_t target = 0;
  std::size_t place = 0;
};

std::vector<std::vector<Entry>> entries_of_elements(const DeltaNormals& deltas) {
  std::vector<std::vector<Entry>> result(deltas.base.size() / 3);
  for (std::size_t k = 0; k < deltas.deltas.size(); ++k) {
    for (std::size_t n = 0; n < deltas.deltas[k].vertices.size(); ++n)
      result[deltas.deltas[k].vertices[n]].push_back({static_cast<std::uint32_t>(k), n});
  }
  return result;
}

}  // namespace

void shown_normals(const DeltaNormals& deltas, std::span<const double> weights, std::span<Vec3d> result) noexcept {
  assert(weights.size() == deltas.deltas.size() && 3 * result.size() == deltas.base.size());
  for (std::size_t e = 0; e < result.size(); ++e) result[e] = at(deltas.base, e);
  for (std::size_t k = 0; k < weights.size(); ++k) {
    if (weights[k] == 0) continue;
    const BlendTarget& target = deltas.deltas[k];
    for (std::size_t n = 0; n < target.vertices.size(); ++n) {
      Vec3d& sum = result[target.vertices[n]];
      sum = sum + weights[k] * at(target.deltas, n);
    }
  }
}

DeltaFit::DeltaFit(DeltaNormals start)
    : deltas_(std::move(start)), matrix_(deltas_.deltas.size() * deltas_.deltas.size()), right_(deltas_.deltas.size()) {
  for (std::size_t k = 0; k < right_.size(); ++k) right_[k].resize(deltas_.deltas[k].vertices.size());
}

void DeltaFit::add(std::span<const double> weights, std::span<const Vec3d> missing) {
  const std::size_t targets = right_.size();
  assert(weights.size() == targets && 3 * missing.size() == deltas_.base.size());
  for (std::size_t k = 0; k < targets; ++k) {
    if (weights[k] == 0) continue;
    for (std::size_t j = 0; j < targets; ++j) matrix_[k * targets + j] += weights[k] * weights[j];
    const std::vector<std::uint32_t>& elements = deltas_.deltas[k].vertices;
    for (std::size_t n = 0; n < elements.size(); ++n) right_[k][n] = right_[k][n] + weights[k] * missing[elements[n]];
  }
}

void DeltaFit::solve() {
  const std::size_t targets = right_.size();
  std::optional<Cholesky> factors;  // the factors for the last element, since neighbours mostly have the same targets
  std::vector<std::uint32_t> factored;
  for (const std::vector<Entry>& entries : entries_of_elements(deltas_)) {
    if (entries.empty()) continue;
    std::vector<std::uint32_t> named;
    std::vector<Vec3d> values;
    for (const Entry& entry : entries) {
      named.push_back(entry.target);
      values.push_back(right_[entry.target][entry.place]);
    }
    if (!factors || named != factored) factors = factor(matrix_, targets, named);
    factored = std::move(named);
    factors->solve(values);
    for (std::size_t i = 0; i < entries.size(); ++i) {
      float* const d = deltas_.deltas[entries[i].target].deltas.data() + 3 * entries[i].place;
      const Vec3f best = to_float(Vec3d{d[0], d[1], d[2]} + values[i]);
      d[0] = best.x, d[1] = best.y, d[2] = best.z;
    }
  }
  std::fill(matrix_.begin(), matrix_.end(), 0.0);
  for (std::vector<Vec3d>& of_target : right_) std::fill(of_target.begin(), of_target.end(), Vec3d{});
}

}  // namespace chronormal::inline internal
