// Makes candidates whose correction targets have weights that are quadratic in the weights of the mesh's own targets.
// Viewers that keep only directions need weights from 0 to 1. For these viewers each vector becomes two correction
// targets, one for the positive terms of the weight, and one for the negative terms.

#include "workflow/bake/candidates/makers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "workflow/bake/deltas/unit_targets.h"
#include "workflow/bake/fits/quadratic_fit.h"

namespace chronormal::inline internal {
namespace {

constexpr unsigned kSizeSeed = 5;
constexpr std::size_t kSizePoses = 1000;
// The numbers of correction targets for which a candidate is made.
constexpr std::array<std::size_t, 7> kExtraCounts = {2, 4, 8, 16, 32, 64, 128};

GltfExtraTarget scaled(GltfExtraTarget weight, double factor) {
  for (auto& term : weight.linear) term.a *= factor;
  for (auto& term : weight.quadratic) term.q *= factor;
  return weight;
}

// Returns the terms of a weight whose factors have the given sign. Multiplies these factors by the sign, so that all of
// them are positive.
GltfExtraTarget terms_of_sign(const GltfExtraTarget& weight, double sign) {
  GltfExtraTarget result;
  for (const auto& term : weight.linear)
    if (sign * term.a > 0) result.linear.push_back({term.i, sign * term.a});
  for (const auto& term : weight.quadratic)
    if (sign * term.q > 0) result.quadratic.push_back({term.i, term.j, sign * term.q});
  return result;
}

// Returns correction targets whose vectors have lengths that viewers keep (`lengths`). Scales the weights of the
// targets to match the scaled vectors.
QuadraticFit::Extras kept_by_viewers(const RightNormals& rights, const RigPoses& rig, QuadraticFit::Extras extras,
                                     Lengths lengths) {
  QuadraticFit::Extras result;
  if (lengths != Lengths::kUnit) {
    const double factor = weight_factor(lengths);
    for (GltfExtraTarget& weight : extras.weights) weight = scaled(std::move(weight), factor);
    for (VertexVectors& column : extras.vectors)
      for (Vec3f& vector : column.vectors) vector = static_cast<float>(1 / factor) * vector;
    return extras;
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

// Makes drivers of correction targets whose weights are sums of terms. The tracks of a mesh with a rig move nothing, so
// correction targets have weight 0 in all tracks.
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

void quadratics_candidates(const Making& making, const Candidate& own,
                           const std::function<bool(Candidate candidate)>& take) {
  const std::size_t of_each = making.lengths == Lengths::kUnit ? 2 : 1;
  const RigPoses& rig = *making.weights.rig;
  const QuadraticFit fit(making.source, making.rights, making.judge.vertices(), own.own, rig, making.weights.poses,
                         std::min(making.most_extras / of_each, kExtraCounts.back()), making.tolerance);
  for (const std::size_t asked : kExtraCounts) {
    const std::size_t count = std::min(asked, fit.extras());
    if (count == 0) return;
    QuadraticFit::Extras extras =
        kept_by_viewers(making.rights, rig, fit.best(count, making.lengths != Lengths::kUnit), making.lengths);
    Candidate candidate = own;
    candidate.name = "quadratics";
    candidate.extras = std::move(extras.vectors);
    candidate.drivers = drivers_of(making.weights, std::move(extras.weights));
    if (!take(std::move(candidate)) || asked >= fit.extras()) return;
  }
}

}  // namespace chronormal::inline internal
