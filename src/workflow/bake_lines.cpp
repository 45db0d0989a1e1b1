#include "workflow/bake_lines.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "chronormal/analysis/delta_fit.h"
#include "chronormal/normals/end_delta.h"

namespace chronormal {
namespace {

// A host scales what it adds up to length 1, so that any length will do: each round takes those that come nearest to
// what the round before shows.
constexpr int kRounds = 8;
// What points away from the right normal is asked to have this much of its length along it.
constexpr double kLeastPart = 0.1;
// Below this part of the terms that it is made of the direction of a normal is not judged.
constexpr double kLeastLength = 1e-4;

// Elements that two targets move which are active at once somewhere.
std::vector<bool> moved_together(const GltfShading& shading, const NormalTerms& terms, const WeightUse& use,
                                 const std::vector<bool>& is_shown) {
  const std::size_t targets = use.targets();
  std::vector<std::vector<std::uint32_t>> targets_of(shading.groups.size());
  for (std::size_t i = 0; i < targets; ++i) {
    if (shading.set.targets[i].vertices.empty()) continue;
    for (const std::uint32_t e : terms.elements(i)) {
      if (is_shown[e]) targets_of[e].push_back(static_cast<std::uint32_t>(i));
    }
  }
  std::vector<bool> together(targets * targets);
  for (std::size_t i = 0; i < targets; ++i) {
    for (std::size_t j = 0; j < i; ++j) together[i * targets + j] = use.together(i, j);
  }
  std::vector<bool> result(shading.groups.size(), false);
  for (std::size_t e = 0; e < result.size(); ++e) {
    const std::vector<std::uint32_t>& of = targets_of[e];
    for (std::size_t a = 0; a < of.size() && !result[e]; ++a) {
      for (std::size_t b = 0; b < a && !result[e]; ++b) result[e] = together[of[a] * targets + of[b]];
    }
  }
  return result;
}

// The best that each target has alone.
DeltaNormals lone_deltas(const GltfShading& shading, const NormalTerms& terms, const std::vector<bool>& is_fitted) {
  DeltaNormals result;
  result.base.resize(3 * shading.groups.size());
  for (std::uint32_t e = 0; e < shading.groups.size(); ++e) {
    const Vec3f base = to_float(is_fitted[e] ? unit(terms.base_of(e)) : Vec3d{});
    result.base[3 * std::size_t{e}] = base.x;
    result.base[3 * std::size_t{e} + 1] = base.y;
    result.base[3 * std::size_t{e} + 2] = base.z;
  }
  for (std::size_t i = 0; i < shading.set.targets.size(); ++i) {
    BlendTarget& target = result.deltas.emplace_back();
    if (shading.set.targets[i].vertices.empty()) continue;
    const NormalTerms::Term linear = terms.linear_by_element(i), square = terms.pair_by_element(i, i);
    for (const std::uint32_t e : terms.elements(i)) {
      Vec3d a, c;
      if (!is_fitted[e]) continue;
      const bool has_linear = linear.find(e, a), has_square = square.find(e, c);
      if (!has_linear && !has_square) continue;
      const ControlNormals normals = of_powers(terms.base_of(e), a, c);
      // Where there is no base to begin at, the sum is to be right at the end.
      const Vec3d delta =
          max_abs(unit(normals.n0)) > 0 ? best_end_delta(normals).delta : unit_normal_at(normals, 1).vector;
      const Vec3f rounded = to_float(delta);
      target.vertices.push_back(e);
      target.deltas.insert(target.deltas.end(), {rounded.x, rounded.y, rounded.z});
    }
  }
  return result;
}

}  // namespace

FittedLines::FittedLines(const GltfShading& shading, const NormalTerms& terms, const WeightUse& use,
                         const std::vector<std::vector<double>>& poses, const std::vector<bool>& is_shown,
                         const std::vector<double>& largest) {
  const std::vector<bool> is_fitted = moved_together(shading, terms, use, is_shown);
  std::vector<std::uint32_t> fitted;
  for (std::uint32_t e = 0; e < is_fitted.size(); ++e) {
    if (is_fitted[e]) fitted.push_back(e);
  }
  elements_ = fitted.size();
  if (fitted.empty()) return;
  DeltaFit fit(lone_deltas(shading, terms, is_fitted));
  std::vector<Vec3d> shown(shading.groups.size()), missing(shown.size());
  // Calls body(e, the right direction) for each element that is fitted and judged, with what is shown in `shown`.
  const auto visit = [&](const std::vector<double>& pose, const auto& body) {
    const std::vector<Vec3d> exact = terms.exact_at(pose);
    shown_normals(fit.deltas(), pose, shown);
    for (const std::uint32_t e : fitted) {
      const double size = length(exact[e]);
      if (size > kLeastLength * std::fmax(length(terms.base_of(e)), largest[e])) body(e, (1 / size) * exact[e]);
    }
  };
  for (int round = 0; round < kRounds; ++round) {
    for (const std::vector<double>& pose : poses) {
      std::fill(missing.begin(), missing.end(), Vec3d{});
      visit(pose, [&](std::uint32_t e, const Vec3d& right) {
        const double along = std::fmax(dot(shown[e], right), kLeastPart * length(shown[e]));
        missing[e] = along * right - shown[e];
      });
      fit.add(pose, missing);
    }
    fit.solve();
  }
  for (const std::vector<double>& pose : poses) {
    visit(pose, [&](std::uint32_t e, const Vec3d& right) {
      if (max_abs(shown[e]) > 0) largest_error_ = std::fmax(largest_error_, angle_between(shown[e], right));
    });
  }
  deltas_ = fit.deltas().deltas;
}

bool FittedLines::find(std::size_t target, std::uint32_t element, Vec3d& delta) const {
  if (target >= deltas_.size()) return false;
  const BlendTarget& found = deltas_[target];
  const auto at = std::lower_bound(found.vertices.begin(), found.vertices.end(), element);
  if (at == found.vertices.end() || *at != element) return false;
  const float* const d = found.deltas.data() + 3 * (at - found.vertices.begin());
  delta = to_double(Vec3f{d[0], d[1], d[2]});
  return true;
}

}  // namespace chronormal
