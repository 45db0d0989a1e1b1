#include "chronormal/analysis/blend_quality.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <optional>
#include <random>
#include <utility>

namespace chronormal {
namespace {

// Of the mean of the diagonal: pulls what the rows leave open to the end-point deltas.
constexpr double kRidge = 1e-9;

Vec3d at(const std::vector<float>& values, std::size_t i) {
  return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
}

std::vector<float> unit_normals(BlendNormals& normals, std::span<const double> weights) {
  std::vector<float> result(3 * normals.size());
  (void)normals.unit_normals(weights, VectorView<float>::packed(result.data(), normals.size()));
  return result;
}

// A positive definite system, by Cholesky's factors.
class Factors {
 public:
  // Of the rows and columns of a symmetric matrix of `size` that are named.
  Factors(const std::vector<double>& matrix, std::size_t size, std::span<const std::uint32_t> named)
      : count_(named.size()), lower_(count_ * count_) {
    double trace = 0;
    for (const std::uint32_t i : named) trace += matrix[i * size + i];
    const double ridge = trace > 0 ? kRidge * trace / static_cast<double>(count_) : 1;
    for (std::size_t i = 0; i < count_; ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        double sum = matrix[named[i] * size + named[j]] + (i == j ? ridge : 0);
        for (std::size_t k = 0; k < j; ++k) sum -= lower_[i * count_ + k] * lower_[j * count_ + k];
        lower_[i * count_ + j] = i == j ? std::sqrt(std::max(sum, ridge)) : sum / lower_[j * count_ + j];
      }
    }
  }

  void solve(std::span<Vec3d> values) const {
    for (std::size_t i = 0; i < count_; ++i) {
      for (std::size_t k = 0; k < i; ++k) values[i] = values[i] - lower_[i * count_ + k] * values[k];
      values[i] = (1 / lower_[i * count_ + i]) * values[i];
    }
    for (std::size_t i = count_; i-- > 0;) {
      for (std::size_t k = i + 1; k < count_; ++k) values[i] = values[i] - lower_[k * count_ + i] * values[k];
      values[i] = (1 / lower_[i * count_ + i]) * values[i];
    }
  }

 private:
  std::size_t count_;
  std::vector<double> lower_;
};

// Which targets have a delta at each element, and where in its list.
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

DeltaNormals endpoint_deltas(BlendNormals& normals) {
  DeltaNormals result;
  std::vector<double> weights(normals.set().targets.size());
  result.base = unit_normals(normals, weights);
  for (std::size_t k = 0; k < weights.size(); ++k) {
    weights[k] = 1;
    std::vector<float> deltas = unit_normals(normals, weights);
    weights[k] = 0;
    for (std::size_t i = 0; i < deltas.size(); ++i) deltas[i] -= result.base[i];
    result.deltas.push_back(BlendTarget::from_dense(deltas, normals.set().targets[k].name));
  }
  return result;
}

DeltaNormals best_deltas(BlendNormals& normals, std::span<const double> weights) {
  DeltaNormals result = endpoint_deltas(normals);
  const std::size_t targets = result.deltas.size(), rows = targets > 0 ? weights.size() / targets : 0;
  assert(weights.size() == rows * targets);
  // The normal equations of what has to be added to the end-point deltas: one matrix, of which each element has a part.
  std::vector<double> matrix(targets * targets);
  std::vector<std::vector<Vec3d>> right(targets);
  for (std::size_t k = 0; k < targets; ++k) right[k].resize(result.deltas[k].vertices.size());
  std::vector<Vec3d> shown(normals.size());
  for (std::size_t row = 0; row < rows; ++row) {
    const std::span<const double> w = weights.subspan(row * targets, targets);
    const std::vector<float> exact = unit_normals(normals, w);
    shown_normals(result, w, shown);
    for (std::size_t k = 0; k < targets; ++k) {
      if (w[k] == 0) continue;
      for (std::size_t j = 0; j < targets; ++j) matrix[k * targets + j] += w[k] * w[j];
      for (std::size_t n = 0; n < right[k].size(); ++n) {
        const std::size_t e = result.deltas[k].vertices[n];
        right[k][n] = right[k][n] + w[k] * (at(exact, e) - shown[e]);
      }
    }
  }
  std::optional<Factors> factors;  // of the last element: neighbours mostly have the same targets
  std::vector<std::uint32_t> factored;
  for (const std::vector<Entry>& entries : entries_of_elements(result)) {
    if (entries.empty()) continue;
    std::vector<std::uint32_t> named;
    std::vector<Vec3d> values;
    for (const Entry& entry : entries) {
      named.push_back(entry.target);
      values.push_back(right[entry.target][entry.place]);
    }
    if (!factors || named != factored) factors.emplace(matrix, targets, named);
    factored = std::move(named);
    factors->solve(values);
    for (std::size_t i = 0; i < entries.size(); ++i) {
      float* const d = result.deltas[entries[i].target].deltas.data() + 3 * entries[i].place;
      const Vec3f best = to_float(Vec3d{d[0], d[1], d[2]} + values[i]);
      d[0] = best.x, d[1] = best.y, d[2] = best.z;
    }
  }
  return result;
}

Quality delta_quality(const DeltaNormals& deltas, BlendNormals& normals, std::span<const double> weights) {
  const std::size_t targets = deltas.deltas.size(), rows = targets > 0 ? weights.size() / targets : 0;
  assert(targets == normals.set().targets.size() && weights.size() == rows * targets);
  const std::vector<float> base = unit_normals(normals, std::vector<double>(targets));
  Quality quality;
  std::vector<Vec3d> shown(normals.size());
  for (std::size_t row = 0; row < rows; ++row) {
    const std::span<const double> w = weights.subspan(row * targets, targets);
    const std::vector<float> exact = unit_normals(normals, w);
    shown_normals(deltas, w, shown);
    for (std::size_t e = 0; e < normals.size(); ++e) {
      const Vec3d u = at(exact, e);
      if (u == at(base, e) && shown[e] == at(deltas.base, e)) continue;
      const Vec3f direction = to_float(unit(shown[e]));
      float xyz[] = {direction.x, direction.y, direction.z};
      quality.add({&u, 1}, VectorView<const float>::packed(xyz, 1), {row, e, 0});
    }
  }
  return quality;
}

std::vector<double> random_blend_weights(const BlendWeightOptions& options) {
  std::mt19937_64 random(options.seed);
  const std::size_t targets = options.targets;
  const std::size_t active = options.active == 0 ? targets : std::min(options.active, targets);
  std::vector<double> weights(options.rows * targets);
  std::vector<std::size_t> order(targets);
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t row = 0; row < options.rows; ++row) {
    for (std::size_t i = 0; i < active; ++i) {
      std::swap(order[i], order[i + random() % (targets - i)]);
      const double share = static_cast<double>(random() >> 11U) * 0x1p-53;
      weights[row * targets + order[i]] = options.low + share * (options.high - options.low);
    }
  }
  return weights;
}

}  // namespace chronormal
