#include "workflow/bake/smallest_form.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "workflow/bake/alone_deltas.h"
#include "workflow/bake/form_poses.h"
#include "workflow/bake/low_rank_form.h"
#include "workflow/bake/opposite_targets.h"
#include "workflow/bake/unit_targets.h"

namespace chronormal::inline internal {
namespace {

// Of the tolerance: what straight pieces may leave of it.
constexpr double kPartOfTracks = 0.2;
constexpr unsigned kFirstSeed = 1, kSecondSeed = 2;

enum Choice : std::uint8_t { kStored, kOwn, kLowRank };

// One extra target made of another: its weight is `factor` times that one's, or what of this is above zero.
struct Share {
  std::size_t of = 0;
  double factor = 1;
  bool above_zero = false;
  VertexVectors vectors;
};

// The delta u - N of a unit normal u whose part across N is this vector, as far as that goes.
Vec3d unit_delta(const Vec3d& base, const Vec3d& vector) {
  Vec3d across = vector - dot(vector, base) * base;
  const double size = length(across);
  if (size > 1) across = (1 / size) * across;
  const Vec3d u = across + std::sqrt(std::fmax(0, 1 - dot(across, across))) * base;
  return farthest_that_fits(base, unit(u)) - base;
}

// Vectors of any length as those that hosts keep.
std::vector<Share> shares_of(const RightNormals& rights, std::vector<VertexVectors> extras, FormLengths lengths) {
  std::vector<Share> shares;
  if (lengths == FormLengths::kFree) {
    for (std::size_t k = 0; k < extras.size(); ++k) shares.push_back({k, 1, false, std::move(extras[k])});
  } else if (lengths == FormLengths::kOpposite) {
    std::vector<ExtraWeight> factors;
    for (std::size_t k = 0; k < extras.size(); ++k) factors.push_back({k, k, 1, 0});
    split_into_opposites(rights, factors, extras);
    for (std::size_t k = 0; k < extras.size(); ++k)
      shares.push_back({factors[k].i, factors[k].linear, false, std::move(extras[k])});
  } else {
    for (std::size_t k = 0; k < extras.size(); ++k) {
      for (const double sign : {1.0, -1.0}) {
        Share share{k, sign, true, extras[k]};
        for (std::size_t n = 0; n < share.vectors.vertices.size(); ++n) {
          const BaseNormal base(rights.stored(share.vectors.vertices[n]));
          const Vec3d vector = (sign / base.length) * to_double(share.vectors.vectors[n]);
          share.vectors.vectors[n] = to_float(base.length * unit_delta(base.direction, vector));
        }
        shares.push_back(std::move(share));
      }
    }
  }
  return shares;
}

void take_shares(std::span<const Share> shares, std::size_t extras, std::vector<double>& values) {
  std::vector<double> result;
  for (std::size_t first = 0; first < values.size(); first += extras) {
    for (const Share& share : shares) {
      const double value = share.factor * values[first + share.of];
      result.push_back(share.above_zero ? std::fmax(value, 0) : value);
    }
  }
  values = std::move(result);
}

// Keeps of the extra targets what some vertex takes part in, and the targets of which something is left.
void drop_unused(std::span<const std::uint32_t> vertices, std::span<const std::uint8_t> choice,
                 std::vector<VertexVectors>& extras, ExtraDrivers& drivers) {
  std::vector<Share> kept;
  const std::size_t before = extras.size();
  for (std::size_t k = 0; k < before; ++k) {
    VertexVectors used;
    for (std::size_t n = 0, at = 0; n < extras[k].vertices.size(); ++n) {
      while (vertices[at] < extras[k].vertices[n]) ++at;
      if (choice[at] != kLowRank) continue;
      used.vertices.push_back(extras[k].vertices[n]);
      used.vectors.push_back(extras[k].vectors[n]);
    }
    if (!used.vertices.empty()) kept.push_back({k, 1, false, std::move(used)});
  }
  extras.clear();
  for (auto& [name, curves] : drivers.curves) {
    take_shares(kept, before, curves.values);
    curves.extras = kept.size();
  }
  for (std::vector<double>& pose : drivers.rest) take_shares(kept, before, pose);
  for (Share& share : kept) extras.push_back(std::move(share.vectors));
  drivers.formulas.assign(kept.size(), ExtraWeight{0, 0, 0, 0});
  if (!kept.empty()) return;
  drivers = ExtraDrivers();
}

}  // namespace

ChosenForm choose_low_rank(const DeltaSource& source, const MeshWeights& weights, const BakeOptions& options,
                           FormLengths lengths, std::size_t most_extras) {
  const GltfShading& shading = source.shading;
  const RightNormals rights(shading, source.terms, source.base_normals, source.plan.largest);
  const std::span<const Host> hosts = options.hosts;
  const double tolerance = options.tolerance.value_or(kHarmlessTolerance);

  ChosenForm result;
  const std::vector<VertexVectors> stored = stored_deltas(shading);
  result.vertices_ = judged_vertices(source, stored);
  const std::vector<std::uint32_t>& vertices = result.vertices_;
  result.own_of_form_.push_back(lengths == FormLengths::kFree
                                    ? endpoint_deltas(source, result.fit_error)
                                    : end_point_form(shading, source.terms, rights, lengths).own);
  result.fit_error = 0;  // the judge measures what is left
  if (!options.animations_only) make_harmless_alone(source, stored, tolerance, result.own_of_form_[0]);
  std::vector<VertexColumns> forms = {by_vertex(columns_of(stored), vertices),
                                      by_vertex(columns_of(result.own_of_form_[0]), vertices)};
  ExtraDrivers& drivers = result.drivers;
  if (most_extras > 0 && source.plan.is_driven) {
    const bool refits_own = options.animations_only && lengths == FormLengths::kFree;
    const std::size_t for_each = lengths == FormLengths::kFree ? 1 : 2;
    LowRankForm form = low_rank_form(rights, weights, vertices, shading.element_of_vertex, result.own_of_form_[0],
                                     {most_extras / for_each, tolerance, refits_own});
    const std::size_t extras = form.extras.size();
    std::vector<Share> shares = shares_of(rights, std::move(form.extras), lengths);
    drivers.curves = std::move(form.curves);
    drivers.rest = std::move(form.rest);
    for (auto& [name, curves] : drivers.curves) {
      take_shares(shares, extras, curves.values);
      curves.extras = shares.size();
    }
    for (std::vector<double>& pose : drivers.rest) take_shares(shares, extras, pose);
    for (Share& share : shares) result.extras_.push_back(std::move(share.vectors));
    drivers.formulas.assign(shares.size(), ExtraWeight{0, 0, 0, 0});
    if (refits_own) result.own_of_form_.push_back(std::move(form.own));
    forms.push_back(by_vertex(columns_of(result.own_of_form_.back(), result.extras_), vertices));
    for (std::size_t t = 0; t < weights.tracks.size() && !shares.empty(); ++t) {
      const WeightTrack& track = weights.tracks[t];
      if (track.interpolation != GltfInterpolation::kLinear) continue;
      const CurveNodes nodes(track);
      const ExtraCurves& curves = drivers.curves[weights.names[t]];
      const auto extras_at = [&](std::size_t key, double part, std::span<const double>, std::span<double> of_extras) {
        curves.at(nodes, key, part, of_extras);
      };
      drivers.pieces[weights.names[t]] =
          pieces_of(rights, track, shares.size(), extras_at, vertices, forms.back(),
                    kPartOfTracks * tolerance / kDegreesPerRadian, result.track_error);
    }
  }
  const std::vector<bool> is_new = new_bases(source);
  const HostJudge judge(rights, vertices, shading.element_of_vertex, is_new, hosts,
                        std::vector<bool>(hosts.size(), true), tolerance);
  const auto numbers = numbers_of_targets(source, stored, vertices);
  const auto sets = [&](const Sampling& sampling) {
    return pose_sets(shading, weights, drivers, hosts, numbers, sampling);
  };
  const std::size_t most = enough_poses(shading, forms);
  result.choice_ = judge.choose(forms, sets({4, most, 0, kFirstSeed, options.animations_only}),
                                FormPreference::kNearestInFile);
  result.hosts = judge.settle(forms, sets({3, most, 0.37, kSecondSeed, options.animations_only}), result.choice_);
  drop_unused(vertices, result.choice_, result.extras_, drivers);
  result.kept = kept_elements(shading, vertices, result.choice_);
  return result;
}

ChosenForm choose_smallest(const DeltaSource& source, const MeshWeights& weights, const BakeOptions& options) {
  const std::size_t targets = source.shading.set.targets.size();
  std::size_t most = most_extras(options.hosts, targets);
  if (options.most_targets) most = std::min(most, *options.most_targets - std::min(*options.most_targets, targets));
  return choose_low_rank(source, weights, options, lengths_for(options.hosts), most);
}

}  // namespace chronormal::inline internal
