#include "analysis/quality/blend_quality.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <random>

namespace chronormal::inline internal {
namespace {

Vec3d at(const std::vector<float>& values, std::size_t i) {
  return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
}

std::vector<float> unit_normals(BlendNormals& normals, std::span<const double> weights) {
  std::vector<float> result(3 * normals.size());
  (void)normals.unit_normals(weights, VectorView<float>::packed(result.data(), normals.size()));
  return result;
}

}  // namespace

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
  DeltaFit fit(endpoint_deltas(normals));
  const std::size_t targets = fit.deltas().deltas.size(), rows = targets > 0 ? weights.size() / targets : 0;
  assert(weights.size() == rows * targets);
  std::vector<Vec3d> missing(normals.size());
  for (std::size_t row = 0; row < rows; ++row) {
    const std::span<const double> w = weights.subspan(row * targets, targets);
    const std::vector<float> exact = unit_normals(normals, w);
    shown_normals(fit.deltas(), w, missing);
    for (std::size_t e = 0; e < missing.size(); ++e) missing[e] = at(exact, e) - missing[e];
    fit.add(w, missing);
  }
  fit.solve();
  return fit.deltas();
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
      std::swap(order[i], order[i + static_cast<std::size_t>(random() % (targets - i))]);
      const double share = static_cast<double>(random() >> 11U) * 0x1p-53;
      weights[row * targets + order[i]] = options.low + share * (options.high - options.low);
    }
  }
  return weights;
}

}  // namespace chronormal::inline internal
