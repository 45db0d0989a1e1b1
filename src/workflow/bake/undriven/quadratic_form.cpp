// What a weight does to the vectors is linear, so that where hosts keep directions alone each vector becomes two: one
// with the terms above zero, and one with those below.
#include "workflow/bake/undriven/quadratic_form.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "workflow/bake/forms/form_poses.h"
#include "workflow/bake/forms/opposite_targets.h"
#include "workflow/bake/forms/unit_targets.h"
#include "workflow/bake/judge/played_errors.h"

namespace chronormal::inline internal {
namespace {

constexpr unsigned kFirstSeed = 1, kSecondSeed = 2, kSizeSeed = 5;
constexpr std::size_t kSizePoses = 1000;
// Numbers of extra targets, each of which is looked at; more than kMostUnasked where a number of targets is asked for.
constexpr std::array<std::size_t, 7> kCounts = {2, 4, 8, 16, 32, 64, 128};
constexpr std::size_t kMostUnasked = 32;
// Of the mean error: what more extra targets must leave at most to be worth it.
constexpr double kWorthIt = 0.9;

enum Choice : std::uint8_t { kStored, kOwn, kQuadratic };

GltfExtraTarget scaled(GltfExtraTarget weight, double factor) {
  for (auto& term : weight.linear) term.a *= factor;
  for (auto& term : weight.quadratic) term.q *= factor;
  return weight;
}

// The terms of one sign, made positive.
GltfExtraTarget terms_of_sign(const GltfExtraTarget& weight, double sign) {
  GltfExtraTarget result;
  for (const auto& term : weight.linear)
    if (sign * term.a > 0) result.linear.push_back({term.i, sign * term.a});
  for (const auto& term : weight.quadratic)
    if (sign * term.q > 0) result.quadratic.push_back({term.i, term.j, sign * term.q});
  return result;
}

// Weights and vectors as hosts keep them.
QuadraticFit::Extras kept_by_hosts(const RightNormals& rights, const RigPoses& rig, QuadraticFit::Extras extras,
                                   FormLengths lengths) {
  QuadraticFit::Extras result;
  if (lengths == FormLengths::kFree) return extras;
  if (lengths == FormLengths::kOpposite) {
    std::vector<ExtraWeight> factors;
    for (std::size_t k = 0; k < extras.vectors.size(); ++k) factors.push_back({k, k, 1, 0});
    result.vectors = std::move(extras.vectors);
    split_into_opposites(rights, factors, result.vectors);
    for (const ExtraWeight& factor : factors) result.weights.push_back(scaled(extras.weights[factor.i], factor.linear));
    return result;
  }
  const PoseList poses = rig.sample(kSizePoses, kSizeSeed);
  for (std::size_t k = 0; k < extras.vectors.size(); ++k) {
    for (const double sign : {1.0, -1.0}) {
      const GltfExtraTarget weight = terms_of_sign(extras.weights[k], sign);
      double largest = 0;
      for (const std::vector<double>& pose : poses) largest = std::fmax(largest, weight.weight(pose));
      if (largest == 0) continue;
      VertexVectors vectors = extras.vectors[k];
      for (std::size_t n = 0; n < vectors.vertices.size(); ++n) {
        const BaseNormal base(rights.stored(vectors.vertices[n]));
        const Vec3d vector = (sign * largest / base.length) * to_double(vectors.vectors[n]);
        vectors.vectors[n] = to_float(base.length * unit_delta(base.direction, vector));
      }
      result.weights.push_back(scaled(weight, 1 / largest));
      result.vectors.push_back(std::move(vectors));
    }
  }
  return result;
}

// Sums drive the extra targets; along tracks, which move nothing, they are at rest.
ExtraDrivers drivers_of(const MeshWeights& weights, std::vector<GltfExtraTarget> sums) {
  ExtraDrivers drivers;
  const std::size_t extras = sums.size();
  drivers.sums = std::move(sums);
  drivers.formulas.assign(extras, ExtraWeight{0, 0, 0, 0});
  for (std::size_t t = 0; t < weights.tracks.size() && extras > 0; ++t) {
    const WeightTrack& track = weights.tracks[t];
    drivers.curves[weights.names[t]] = {extras, std::vector<double>(extras * CurveNodes(track).size(), 0.0)};
    if (track.interpolation == GltfInterpolation::kLinear)
      drivers.pieces[weights.names[t]] = std::vector<std::uint32_t>(track.size() - 1, 1);
  }
  return drivers;
}

}  // namespace

// A form in which all vertices take part in the extra targets.
ChosenForm with_quadratics(const DeltaSource& source, const MeshWeights& weights, FormLengths lengths,
                           const ChosenForm& own, QuadraticFit::Extras fitted) {
  const RightNormals rights(source.shading, source.terms, source.base_normals, source.plan.largest);
  QuadraticFit::Extras extras = kept_by_hosts(rights, *weights.rig, std::move(fitted), lengths);
  ChosenForm result = own;
  result.choice_.assign(result.choice_.size(), kQuadratic);
  result.hosts.clear();
  result.extras_ = std::move(extras.vectors);
  result.drivers = drivers_of(weights, std::move(extras.weights));
  return result;
}

// Keeps extra targets for the vertices where they do no harm and are nearer.
ChosenForm settled_quadratics(const DeltaSource& source, const MeshWeights& weights, const BakeOptions& options,
                              ChosenForm form) {
  const GltfShading& shading = source.shading;
  const RightNormals rights(shading, source.terms, source.base_normals, source.plan.largest);
  const std::vector<std::uint32_t>& vertices = form.vertices_;
  const std::vector<VertexVectors> stored = stored_deltas(shading);
  const std::vector<VertexColumns> forms = {by_vertex(columns_of(stored), vertices),
                                            by_vertex(columns_of(form.own()), vertices),
                                            by_vertex(columns_of(form.own(), form.extras_), vertices)};
  const auto numbers = numbers_of_targets(source, stored, vertices);
  const std::size_t most = enough_poses(shading, forms);
  const auto sets = [&](const Sampling& sampling) {
    return pose_sets(shading, weights, form.drivers, options.hosts, numbers, sampling);
  };
  const std::vector<bool> is_new = new_bases(source);
  const HostJudge judge(rights, vertices, shading.element_of_vertex, is_new, options.hosts,
                        std::vector<bool>(options.hosts.size(), true), options.tolerance.value_or(kHarmlessTolerance));
  form.choice_ = judge.choose(forms, sets({4, most, 0, kFirstSeed}), FormPreference::kNearest);
  form.hosts = judge.settle(forms, sets({3, most, 0.37, kSecondSeed}), form.choice_);

  std::vector<VertexVectors> vectors;
  std::vector<GltfExtraTarget> sums;
  for (std::size_t k = 0; k < form.extras_.size(); ++k) {
    VertexVectors used;
    const VertexVectors& all = form.extras_[k];
    for (std::size_t n = 0, at = 0; n < all.vertices.size(); ++n) {
      while (vertices[at] < all.vertices[n]) ++at;
      if (form.choice_[at] != kQuadratic) continue;
      used.vertices.push_back(all.vertices[n]);
      used.vectors.push_back(all.vectors[n]);
    }
    if (used.vertices.empty()) continue;
    vectors.push_back(std::move(used));
    sums.push_back(std::move(form.drivers.sums[k]));
  }
  form.extras_ = std::move(vectors);
  form.drivers = drivers_of(weights, std::move(sums));
  form.kept = kept_elements(shading, vertices, form.choice_);
  return form;
}

QuadraticChoice choose_quadratics(const DeltaSource& source, const MeshWeights& weights, const BakeOptions& options,
                                  FormLengths lengths, const ChosenForm& own, const QuadraticLimits& limits) {
  const GltfShading& shading = source.shading;
  const std::size_t targets = shading.set.targets.size(), of_each = lengths == FormLengths::kFree ? 1 : 2;
  const RightNormals rights(shading, source.terms, source.base_normals, source.plan.largest);
  const double tolerance = options.tolerance.value_or(kHarmlessTolerance);
  const std::size_t most = std::min(limits.most_extras / of_each, options.most_targets ? kCounts.back() : kMostUnasked);
  const QuadraticFit fit(source, rights, own.judged(), own.own(), *weights.rig, weights.poses, most, tolerance);
  QuadraticChoice result;
  std::optional<ChosenForm> taken;
  double mean = limits.mean_without;
  for (const std::size_t asked : kCounts) {
    const std::size_t count = std::min(asked, fit.extras());
    if (count == 0) break;
    ChosenForm form = with_quadratics(source, weights, lengths, own, fit.best(count, lengths != FormLengths::kUnit));
    const ShownErrors played = played_errors(rights, form.judged(), shading.element_of_vertex, form.columns(shading),
                                             played_poses(weights, form.drivers, targets, limits.most_poses));
    result.gains.push_back({count, targets + form.drivers.size(), form.bytes(shading), played});
    const bool is_near = played.worst <= tolerance;
    if (result.gains.back().bytes <= limits.most_bytes && (is_near || played.mean <= kWorthIt * mean)) {
      taken = std::move(form);
      mean = played.mean;
    }
    if ((is_near && !options.plan) || asked >= fit.extras()) break;
  }
  if (taken) result.form = settled_quadratics(source, weights, options, std::move(*taken));
  return result;
}

}  // namespace chronormal::inline internal
