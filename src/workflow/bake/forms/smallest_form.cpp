#include "workflow/bake/forms/smallest_form.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "workflow/bake/forms/alone_deltas.h"
#include "workflow/bake/forms/form_poses.h"
#include "workflow/bake/forms/opposite_targets.h"
#include "workflow/bake/forms/unit_targets.h"
#include "workflow/bake/judge/played_errors.h"
#include "workflow/bake/low_rank/low_rank_form.h"
#include "workflow/bake/undriven/quadratic_form.h"

namespace chronormal::inline internal {
namespace {

// Of the tolerance: what straight pieces may leave of it.
constexpr double kPartOfTracks = 0.2;
constexpr unsigned kFirstSeed = 1, kSecondSeed = 2;

// Poses that a choice is made by, pairs of targets that are worth a look, and how often the limit of bytes is tried.
constexpr std::size_t kMostPlayed = 200, kMostPairs = 48;
constexpr int kTries = 4;
constexpr double kPartOfBytes = 0.95;

enum Choice : std::uint8_t { kStored, kOwn, kLowRank };

// How many pairs of targets the file has active at once (of a rig all) where both move a normal; a target with itself is
// one.
std::size_t active_pairs(const DeltaSource& source, const MeshWeights& weights) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < source.shading.set.targets.size(); ++i)
    for (std::size_t j = i; moves(source.shading, i) && j < source.shading.set.targets.size() && count <= kMostPairs;
         ++j)
      if (moves(source.shading, j) && (weights.rig || weights.use.together(i, j)) &&
          (i == j || source.terms.overlap(i, j)))
        ++count;
  return count;
}

// One extra target made of another: its weight is `factor` times that one's, or what of this is above zero.
struct Share {
  std::size_t of = 0;
  double factor = 1;
  bool above_zero = false;
  VertexVectors vectors;
};

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
  if (!options.animations_only) make_harmless_alone(source, stored, lengths, tolerance, result.own_of_form_[0]);
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
      drivers.pieces[weights.names[t]] = pieces_of(rights, track, shares.size(), extras_at, vertices, forms.back(),
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
  result.choice_ =
      judge.choose(forms, sets({4, most, 0, kFirstSeed, options.animations_only}), FormPreference::kNearestInFile);
  result.hosts = judge.settle(forms, sets({3, most, 0.37, kSecondSeed, options.animations_only}), result.choice_);
  drop_unused(vertices, result.choice_, result.extras_, drivers);
  result.kept = kept_elements(shading, vertices, result.choice_);
  return result;
}

ChosenForm keep_stored(const DeltaSource& source) {
  ChosenForm result;
  result.vertices_ = judged_vertices(source, stored_deltas(source.shading));
  result.choice_.assign(result.vertices_.size(), kStored);
  result.own_of_form_.emplace_back(source.shading.set.targets.size());
  return result;
}

ChosenForm choose_smallest(const DeltaSource& source, const MeshWeights& weights, const BakeOptions& options) {
  const GltfShading& shading = source.shading;
  const std::size_t targets = shading.set.targets.size(), most = most_extras(options, targets);
  const FormLengths lengths = lengths_for(options.hosts);
  const RightNormals rights(shading, source.terms, source.base_normals, source.plan.largest);
  const double tolerance = options.tolerance.value_or(kHarmlessTolerance);
  const std::size_t most_bytes = options.most_delta_bytes.value_or(std::numeric_limits<std::size_t>::max());

  std::optional<ChosenForm> best;
  BakeChoice of_best;
  std::vector<BakeChoice> choices;
  // Looks at a form: the smallest that is near enough is the best, and before there is one, the nearest.
  const auto look_at = [&](std::string_view name, ChosenForm form) {
    BakeChoice choice{name, targets + form.drivers.size(), form.bytes(shading), {}, form.hosts, false, false};
    for (const auto& [track, curve] : form.drivers.curves) choice.bytes += sizeof(float) * curve.values.size();
    choice.played = played_errors(rights, form.judged(), shading.element_of_vertex, form.columns(shading),
                                  played_poses(weights, form.drivers, targets, kMostPlayed));
    const bool is_affordable = choice.bytes <= most_bytes && form.drivers.size() <= most;
    choice.within = is_affordable && choice.played.worst <= tolerance;
    choices.push_back(choice);
    if (best && !is_affordable) return;
    const bool is_better = !best || (choice.within != of_best.within ? choice.within
                                     : choice.within                 ? choice.bytes < of_best.bytes
                                                                     : choice.played.mean < of_best.played.mean);
    if (!is_better) return;
    best = std::move(form);
    of_best = std::move(choice);
  };
  const auto is_found = [&] { return of_best.within && !options.plan; };
  const bool has_new_base = !source.base_normals.empty() && source.base_normals.data() != shading.normals.data();
  if (!has_new_base) look_at("as it is", keep_stored(source));
  if (!is_found() && !weights.rig) {
    look_at("own deltas", choose_low_rank(source, weights, options, lengths, 0));
  } else if (!is_found()) {
    const ChosenForm own = choose_low_rank(source, weights, options, lengths, 0);
    look_at("own deltas", own);
    const double mean = choices.back().played.mean;
    if (!is_found() && source.plan.products_fit && most > 0) {
      if (active_pairs(source, weights) <= kMostPairs)
        look_at("pairs", choose_of_lengths(source, weights, options, lengths));
      QuadraticChoice chosen =
          choose_quadratics(source, weights, options, lengths, own, {most, most_bytes, kMostPlayed, mean});
      for (const QuadraticGain& gain : chosen.gains)
        choices.push_back({"quadratics", gain.targets, gain.bytes, gain.played, {}, false, false});
      if (chosen.form) look_at("quadratics", std::move(*chosen.form));
    }
  }
  if (!is_found() && source.plan.is_driven && source.plan.products_fit && most > 0) {
    if (active_pairs(source, weights) <= kMostPairs && !options.animations_only)
      look_at("pairs", choose_of_lengths(source, weights, options, lengths));
    std::size_t extras = most;
    for (int tries = 0; tries < kTries && extras > 0; ++tries) {
      ChosenForm form = choose_low_rank(source, weights, options, lengths, extras);
      const std::size_t bytes = form.bytes(shading), count = form.drivers.size();
      look_at("low rank", std::move(form));
      if (bytes <= most_bytes || count == 0) break;
      const double part = static_cast<double>(most_bytes) / static_cast<double>(bytes);
      extras = static_cast<std::size_t>(kPartOfBytes * part * static_cast<double>(count));
    }
  }
  for (BakeChoice& choice : choices)
    choice.chosen = choice.form == of_best.form && choice.targets == of_best.targets && choice.bytes == of_best.bytes &&
                    choice.hosts.size() == of_best.hosts.size();
  best->choices = std::move(choices);
  return std::move(*best);
}

}  // namespace chronormal::inline internal
