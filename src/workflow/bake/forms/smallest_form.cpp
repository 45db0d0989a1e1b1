#include "workflow/bake/forms/smallest_form.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "workflow/bake/forms/alone_deltas.h"
#include "workflow/bake/forms/errors_in_hosts.h"
#include "workflow/bake/forms/extra_shares.h"
#include "workflow/bake/forms/form_poses.h"
#include "workflow/bake/forms/worthwhile_columns.h"
#include "workflow/bake/forms/worthwhile_form.h"
#include "workflow/bake/judge/played_errors.h"
#include "workflow/bake/low_rank/low_rank_form.h"
#include "workflow/bake/undriven/quadratic_form.h"

namespace chronormal::inline internal {
namespace {

// Of the tolerance: what straight pieces may leave of it.
constexpr double kSmallestPartOfTracks = 0.2;
constexpr unsigned kFirstSeed = 1, kSecondSeed = 2;

// Poses that a choice is made by: so many, or on small meshes as many as these pairs of a vertex and a pose allow. A
// form that is within the tolerance there is held against many more, which are all key intervals of all but the longest
// animations.
constexpr std::size_t kMostPlayed = 200, kMostPlayedOfSmall = 4000, kPlayedPairs = 4000000;
constexpr std::size_t kMostVerified = 100000, kVerifiedPairs = 100000000;
// How often the limit of bytes is tried.
// Pairs of the targets of a rig that are worth a look.
constexpr std::size_t kMostSmallestPairs = 48;
constexpr int kTries = 6;
// Numbers of extra targets that are tried where bytes are limited.
constexpr std::array<std::size_t, 8> kFewExtras = {1, 2, 3, 4, 6, 8, 16, 32};
// Means that differ by no more of themselves are alike.
constexpr double kAlike = 1e-3;

constexpr std::string_view kQuadratics = "quadratics";

// Where forms miss the tolerance only because of a skin, they are made again, so often at most: for such a part of what
// should do, but for no less than so much of the tolerance.
constexpr int kMostTightened = 6;
constexpr double kPartOfMissed = 0.9, kLeastPart = 0.01;

// At how many weights of each target alone a mesh is judged that was baked before.
constexpr std::size_t kAloneSteps = 8;

enum VertexForm : std::uint8_t { kStored, kOwn, kLowRank };

bool has_new_base(const DeltaSource& source) {
  return !source.base_normals.empty() && source.base_normals.data() != source.shading.normals.data();
}

// How many pairs of the targets of a rig move a normal both; a target with itself is one. No more than one beyond the
// limit are counted.
std::size_t pairs_of_rig(const DeltaSource& source) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < source.shading.set.targets.size(); ++i)
    for (std::size_t j = i;
         moves(source.shading, i) && j < source.shading.set.targets.size() && count <= kMostSmallestPairs; ++j)
      if (moves(source.shading, j) && (i == j || source.terms.overlap(i, j))) ++count;
  return count;
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

// By how many bytes the tracks grow that drive extra targets.
std::size_t bytes_of_tracks(const MeshWeights& weights, const ExtraDrivers& drivers) {
  std::size_t bytes = 0;
  for (std::size_t t = 0; t < weights.tracks.size() && drivers.size() > 0; ++t) {
    const WeightTrack& before = weights.tracks[t];
    const ExtendedTrack after = drivers.extended(weights.names[t], before, std::numeric_limits<double>::infinity());
    const std::size_t of_key = before.interpolation == GltfInterpolation::kCubicSpline ? 3 : 1;
    bytes += sizeof(float) * (after.values.size() + after.times.size() - of_key * before.targets * before.size());
  }
  return bytes;
}

// Holds one form of a mesh against the next.
class Choice {
 public:
  // Every form takes some bytes for tangents.
  Choice(const DeltaSource& source, const MeshWeights& weights, const BakeOptions& options, std::size_t tangent_bytes)
      : shading_(source.shading),
        weights_(weights),
        options_(options),
        rights_(shading_, source.terms, source.base_normals, source.plan.largest),
        tolerance_(options.tolerance.value_or(kHarmlessTolerance)),
        made_within_(tolerance_),
        tangent_bytes_(tangent_bytes) {}

  // Looks at a form, and returns the bytes that it takes.
  std::size_t look_at(std::string_view name, ChosenForm form) {
    BakeChoice choice = measured(name, form);
    const std::size_t bytes = choice.bytes - tangent_bytes_;
    take(std::move(choice), std::move(form));
    return bytes;
  }

  // Looks at the best of the forms that find(is_enough, take) calls take with.
  template <class Find>
  void look_at_best(std::string_view name, const Find& find) {
    std::optional<ChosenForm> nearest;
    BakeChoice of_nearest;
    const auto is_enough = [&](std::size_t bytes) {
      return nearest && of_nearest.within && of_nearest.bytes - tangent_bytes_ <= bytes;
    };
    find(is_enough, [&](ChosenForm form) {
      BakeChoice choice = measured(name, form);
      const std::size_t bytes = choice.bytes - tangent_bytes_;
      if (!nearest || is_affordable(choice) > is_affordable(of_nearest) ||
          (is_affordable(choice) == is_affordable(of_nearest) && is_better(choice, of_nearest))) {
        nearest = std::move(form);
        of_nearest = std::move(choice);
      }
      return bytes;
    });
    if (nearest) take(std::move(of_nearest), std::move(*nearest));
  }

  [[nodiscard]] const RightNormals& rights() const noexcept { return rights_; }
  // Whether no choice of each vertex between what is stored and these deltas is near enough.
  [[nodiscard]] bool is_far(const OwnForm& own) const {
    const std::array<VertexColumns, 2> forms = {by_vertex(columns_of(own.stored), own.vertices),
                                                by_vertex(columns_of(own.deltas), own.vertices)};
    const std::vector<SeenPose> poses = played_poses(weights_, {}, shading_.set.targets.size(), kMostPlayed);
    return least_worst(rights_, own.vertices, shading_.element_of_vertex, forms, poses) > tolerance_;
  }
  // How many bytes deltas and tracks may take.
  [[nodiscard]] std::size_t most_bytes() const {
    const std::size_t most = options_.most_delta_bytes.value_or(std::numeric_limits<std::size_t>::max());
    return most - std::min(most, tangent_bytes_);
  }
  [[nodiscard]] bool is_within() const { return best_ && of_best_.within; }
  // Whether a form is near enough, of no more bytes than these, and no plan asks for all the others.
  [[nodiscard]] bool is_found() const { return is_found_below(std::numeric_limits<std::size_t>::max()); }
  [[nodiscard]] bool is_found_below(std::size_t bytes) const {
    return is_within() && of_best_.bytes - tangent_bytes_ <= bytes && !options_.plan;
  }

  // Where skins keep all forms beyond the tolerance, and some of these were within what they were made for before
  // skinning: what forms should be made for next. That is less by as much as the nearest of them missed the tolerance
  // by, and less than what this one left before skinning, so that it does not come again.
  [[nodiscard]] std::optional<double> tightened() {
    const Missed missed = std::exchange(missed_, Missed());
    if (is_within() || missed.seen == INFINITY) return std::nullopt;
    const double next = std::fmin(missed.before, made_within_ * tolerance_ / missed.seen);
    made_within_ = std::fmax(kPartOfMissed * next, kLeastPart * tolerance_);
    return made_within_;
  }

  // Notes what was tried and not made.
  void note_draft(std::string_view name, std::size_t targets, std::size_t bytes, const ShownErrors& played) {
    choices_.push_back({name, targets, bytes, played, {}, false, false});
  }

  [[nodiscard]] ChosenForm take_best() {
    // The judge measures the stored deltas whenever it measures another form, so that every other form knows their
    // errors.
    const auto measured =
        std::find_if(choices_.begin(), choices_.end(), [](const auto& c) { return !c.hosts.empty(); });
    for (BakeChoice& choice : choices_) {
      if (!choice.hosts.empty() || measured == choices_.end() || is_draft(choice)) continue;
      choice.hosts = measured->hosts;
      for (HostChange& host : choice.hosts)
        for (HostChange::Errors& errors : host.poses) errors.after = errors.before;
    }
    for (BakeChoice& choice : choices_)
      choice.chosen = !is_draft(choice) && choice.form == of_best_.form && choice.targets == of_best_.targets &&
                      choice.bytes == of_best_.bytes && choice.played.worst == of_best_.played.worst &&
                      choice.played.mean == of_best_.played.mean && choice.animations_only == of_best_.animations_only;
    for (BakeChoice& choice : choices_)
      if (choice.chosen) choice.rounded = rounded_worst_of_best();
    best_->choices = std::move(choices_);
    return std::move(*best_);
  }

 private:
  [[nodiscard]] double rounded_worst_of_best() const {
    const std::vector<SeenPose> poses =
        played_poses(weights_, best_->drivers, shading_.set.targets.size(), kMostPlayed);
    return rounded_worst(rights_, shading_, options_.hosts, best_->judged(), best_->columns(shading_), poses);
  }
  static bool is_draft(const BakeChoice& choice) { return choice.form == kQuadratics && choice.hosts.empty(); }
  [[nodiscard]] bool is_affordable(const BakeChoice& choice) const {
    const std::size_t targets = shading_.set.targets.size();
    return choice.bytes - tangent_bytes_ <= most_bytes() && choice.targets - targets <= most_extras(options_, targets);
  }

  [[nodiscard]] BakeChoice measured(std::string_view name, const ChosenForm& form) {
    const std::size_t targets = shading_.set.targets.size();
    BakeChoice choice{name, targets + form.drivers.size(), form.bytes(shading_), {}, form.hosts, false, false};
    choice.bytes += bytes_of_tracks(weights_, form.drivers) + tangent_bytes_;
    choice.animations_only = form.animations_only;
    choice.skinned = weights_.skins.any();
    const VertexColumns columns = form.columns(shading_);
    const auto errors_at = [&](std::span<const SeenPose> poses) {
      return errors_in_hosts(rights_, shading_, options_.hosts, form.judged(), columns, poses);
    };
    const std::size_t vertices = std::max<std::size_t>(1, form.judged().size());
    const std::vector<SeenPose> poses = played_poses(
        weights_, form.drivers, targets, std::clamp(kPlayedPairs / vertices, kMostPlayed, kMostPlayedOfSmall));
    choice.played = errors_at(poses);
    choice.within = is_affordable(choice) && choice.played.worst <= tolerance_;
    if (choice.within) {
      const std::vector<SeenPose> all = played_poses(
          weights_, form.drivers, targets, std::clamp(kVerifiedPairs / vertices, 2 * kMostPlayed, kMostVerified));
      if (all.size() <= poses.size()) return choice;
      choice.played = errors_at(all);
      choice.within = choice.played.worst <= tolerance_;
    }
    if (choice.skinned && is_affordable(choice) && choice.played.worst > tolerance_) {
      const double before = errors_at(seen_through(different_weights_of(poses), nullptr)).worst;
      if (before <= made_within_ && choice.played.worst < missed_.seen) missed_ = {before, choice.played.worst};
    }
    return choice;
  }

  // The worst of a form that is within what it was made for before skinning, and beyond the tolerance when it is seen:
  // of all in this round, the one that is nearest then.
  struct Missed {
    double before = 0, seen = INFINITY;
  };

  // The smallest that is near enough is better, and before there is one, the nearest.
  static bool is_better(const BakeChoice& choice, const BakeChoice& than) {
    if (choice.within != than.within) return choice.within;
    if (choice.within) return choice.bytes < than.bytes;
    const bool is_alike = std::fabs(choice.played.mean - than.played.mean) <= kAlike * than.played.mean;
    return is_alike ? choice.bytes < than.bytes : choice.played.mean < than.played.mean;
  }

  void take(BakeChoice choice, ChosenForm form) {
    const bool is_known =
        made_within_ < tolerance_ && std::any_of(choices_.begin(), choices_.end(), [&](const BakeChoice& known) {
          return known.form == choice.form && known.targets == choice.targets && known.bytes == choice.bytes &&
                 known.played.worst == choice.played.worst;
        });
    if (is_known) return;
    choices_.push_back(choice);
    if (best_ && (!is_affordable(choice) || !is_better(choice, of_best_))) return;
    best_ = std::move(form);
    of_best_ = std::move(choice);
  }

  const GltfShading& shading_;
  const MeshWeights& weights_;
  const BakeOptions& options_;
  RightNormals rights_;
  double tolerance_, made_within_;  // of what is seen, and that which forms are made for before skinning
  Missed missed_;
  std::size_t tangent_bytes_;
  std::optional<ChosenForm> best_;
  BakeChoice of_best_;
  std::vector<BakeChoice> choices_;
};

}  // namespace

OwnForm own_form(const DeltaSource& source, const RightNormals& rights, const BakeOptions& options,
                 FormLengths lengths) {
  OwnForm own;
  own.stored = stored_deltas(source.shading);
  own.vertices = judged_vertices(source, own.stored);
  double unused = 0;  // the judge measures what is left
  own.deltas = lengths == FormLengths::kFree ? endpoint_deltas(source, unused)
                                             : end_point_form(source.shading, source.terms, rights, lengths).own;
  if (!options.animations_only)
    make_harmless_alone(source, own.stored, lengths, options.tolerance.value_or(kHarmlessTolerance), own.deltas);
  return own;
}

namespace {

// The stored deltas of the vertices whose choice is 0, and the others of the rest. Lists have ascending vertices.
std::vector<VertexVectors> mixed_deltas(const OwnForm& own, std::span<const std::uint8_t> choice) {
  std::vector<std::uint32_t> stored;
  for (std::size_t n = 0; n < choice.size(); ++n)
    if (choice[n] == kStored) stored.push_back(own.vertices[n]);
  std::vector<VertexVectors> result(own.deltas.size());
  for (std::size_t i = 0; i < result.size(); ++i) {
    std::vector<std::pair<std::uint32_t, Vec3f>> of_target;
    const auto take = [&](const VertexVectors& from, bool of_stored) {
      for (std::size_t n = 0; n < from.vertices.size(); ++n)
        if (std::binary_search(stored.begin(), stored.end(), from.vertices[n]) == of_stored)
          of_target.emplace_back(from.vertices[n], from.vectors[n]);
    };
    take(own.stored[i], true);
    take(own.deltas[i], false);
    std::sort(of_target.begin(), of_target.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [vertex, vector] : of_target) {
      result[i].vertices.push_back(vertex);
      result[i].vectors.push_back(vector);
    }
  }
  return result;
}

}  // namespace

ChosenForm choose_low_rank(const DeltaSource& source, const RightNormals& rights, const MeshWeights& weights,
                           const BakeOptions& options, FormLengths lengths, const OwnForm& own,
                           std::size_t most_extras) {
  const GltfShading& shading = source.shading;
  const std::span<const Host> hosts = options.hosts;
  const double tolerance = options.tolerance.value_or(kHarmlessTolerance);

  ChosenForm result;
  result.animations_only = options.animations_only;
  result.vertices_ = own.vertices;
  const std::vector<std::uint32_t>& vertices = result.vertices_;
  std::vector<VertexColumns> forms = {by_vertex(columns_of(own.stored), vertices),
                                      by_vertex(columns_of(own.deltas), vertices)};
  const std::vector<bool> is_new = new_bases(source);
  const HostJudge judge(rights, vertices, shading.element_of_vertex, is_new, hosts,
                        std::vector<bool>(hosts.size(), true), tolerance);
  const auto numbers = numbers_of_targets(source, own.stored, vertices);
  std::vector<VertexVectors> deltas = own.deltas;
  if (!rights.are_by_area() && most_extras > 0) {
    // Extra targets are fitted to what is left of deltas that do no harm by themselves.
    const std::vector<PoseSet> sets =
        pose_sets(shading, weights, {}, hosts, numbers,
                  {4, enough_poses(shading, forms), 0, kFirstSeed, options.animations_only});
    deltas = mixed_deltas(own, judge.choose(forms, sets, FormPreference::kNearestInFile));
    forms[1] = by_vertex(columns_of(deltas), vertices);
  }
  result.own_of_form_.push_back(deltas);
  ExtraDrivers& drivers = result.drivers;
  const bool refits_own = options.animations_only && lengths == FormLengths::kFree && source.plan.products_fit;
  if ((most_extras > 0 || refits_own) && source.plan.is_driven) {
    const std::size_t for_each = lengths == FormLengths::kFree ? 1 : 2;
    LowRankForm form = low_rank_form(rights, weights, vertices, shading.element_of_vertex, deltas,
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
    cut_tracks(rights, weights, hosts, vertices, forms.back(), kSmallestPartOfTracks * tolerance / kDegreesPerRadian,
               drivers, result.track_error);
  }
  const auto sets = [&](const Sampling& sampling) {
    return pose_sets(shading, weights, drivers, hosts, numbers, sampling);
  };
  const std::size_t most = enough_poses(shading, forms);
  result.choice_ =
      judge.choose(forms, sets({4, most, 0, kFirstSeed, options.animations_only}), FormPreference::kNearestInFile);
  // What is no quadratic in the weights is fitted to the file, and to nothing that a program may mix.
  result.hosts = judge.settle(forms, sets({3, most, 0.37, kSecondSeed, options.animations_only}), result.choice_,
                              rights.are_by_area());
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

// Looks at extra targets for a mesh that nothing drives: for all pairs where these are few, and quadratics.
void look_at_rig(const DeltaSource& source, const MeshWeights& weights, const BakeOptions& options, FormLengths lengths,
                 const ChosenForm& own, Choice& choice) {
  const std::size_t targets = source.shading.set.targets.size();
  if (pairs_of_rig(source) <= kMostSmallestPairs)
    choice.look_at("pairs", choose_of_lengths(source, weights, options, lengths));
  const ShownErrors without =
      played_errors(choice.rights(), own.judged(), source.shading.element_of_vertex, own.columns(source.shading),
                    played_poses(weights, own.drivers, targets, kMostPlayed));
  QuadraticChoice chosen =
      choose_quadratics(source, weights, options, lengths, own,
                        {most_extras(options, targets), choice.most_bytes(), kMostPlayed, without.mean});
  for (const QuadraticGain& gain : chosen.gains) choice.note_draft(kQuadratics, gain.targets, gain.bytes, gain.played);
  if (chosen.form) choice.look_at(kQuadratics, std::move(*chosen.form));
}

// Looks at all forms but what is stored. looks_at_low_rank: whether extra targets of low rank are among them.
void look_at_forms(const DeltaSource& source, const MeshWeights& weights, const BakeOptions& options,
                   bool looks_at_low_rank, Choice& choice) {
  // About how much of the time has gone by.
  const auto reach = [&options](std::size_t percent) {
    if (options.progress) options.progress(percent, 100);
  };
  const FormLengths lengths = lengths_for(options.hosts);
  const std::size_t most = most_extras(options, source.shading.set.targets.size());
  const RightNormals& rights = choice.rights();
  reach(5);
  const OwnForm own = own_form(source, rights, options, lengths);
  reach(20);
  const bool has_extras = looks_at_low_rank && source.plan.is_driven && source.plan.products_fit && most > 0;
  // All other forms with extra targets that nothing but animations drive have the deltas of all targets. Where no
  // choice between these and what is stored is near enough, they are looked at when nothing else is.
  const bool waits =
      has_extras && !has_new_base(source) && !options.plan && lengths == FormLengths::kFree && choice.is_far(own);
  std::optional<std::size_t> of_deltas;
  const auto look_at_own = [&] {
    of_deltas = choice.look_at("own deltas", choose_low_rank(source, rights, weights, options, lengths, own, 0));
  };
  if (!waits) look_at_own();
  bool have_products = false;
  const auto look_at_products = [&](const BakeOptions& limits) {
    choice.look_at_best("pruned", [&](const auto& is_enough, const auto& take) {
      have_products |= find_worthwhile_forms(source, weights, limits, lengths, choice.is_within(), choice.most_bytes(),
                                             is_enough, take);
    });
  };
  look_at_products(options);
  // Under a limit of bytes a few of the largest corrections may be nearer than what is left of all of them.
  const bool is_limited = options.most_delta_bytes.has_value();
  for (const std::size_t extras : kFewExtras) {
    if (!is_limited || choice.is_within() || !have_products || extras >= most) break;
    BakeOptions few = options;
    few.most_targets = source.shading.set.targets.size() + extras;
    look_at_products(few);
  }
  reach(40);
  if (!of_deltas && choice.is_found()) look_at_own();
  if (weights.rig && !choice.is_found() && source.plan.products_fit && most > 0)
    look_at_rig(source, weights, options, lengths, choose_low_rank(source, rights, weights, options, lengths, own, 0),
                choice);
  if (has_extras && !(of_deltas && choice.is_found_below(*of_deltas))) {
    std::size_t extras = most;
    for (int tries = 0; tries < kTries && extras > 0; ++tries) {
      ChosenForm form = choose_low_rank(source, rights, weights, options, lengths, own, extras);
      reach(70);
      const std::size_t count = form.drivers.size();
      const std::size_t bytes = choice.look_at("low rank", std::move(form));
      if (bytes <= choice.most_bytes() || count == 0) break;
      const double part = static_cast<double>(choice.most_bytes()) / static_cast<double>(bytes);
      extras = std::min(count - 1, static_cast<std::size_t>(std::ceil(part * static_cast<double>(count))));
    }
  }
  reach(90);
  if (!of_deltas && !choice.is_within()) look_at_own();
  // Where nothing is near enough, nothing may be farther off than harmless, but where that has too many products.
  if (!choice.is_found() && !options.animations_only && (have_products || !source.plan.is_driven))
    choice.look_at("harmless", choose_harmless(source, weights, options));
}

// Looks at all forms but what is stored, with deltas fitted to animations and without.
void look_at_all_forms(const DeltaSource& source, const MeshWeights& weights, const BakeOptions& options,
                       Choice& choice) {
  // Only hosts that add up deltas of any length gain by deltas that are fitted to animations. What targets alone allow
  // may be smaller or nearer all the same, but for extra targets of low rank, which fitted deltas need fewer of.
  if (options.animations_only && source.plan.is_driven && lengths_for(options.hosts) == FormLengths::kFree)
    look_at_forms(source, weights, options, true, choice);
  const bool has_fitted = options.animations_only && choice.is_within();
  BakeOptions for_all = options;
  for_all.animations_only = false;
  look_at_forms(source, weights, for_all, !has_fitted || options.plan, choice);
}

ChosenForm choose_smallest(const DeltaSource& source, const MeshWeights& weights, const BakeOptions& options,
                           std::size_t tangent_bytes) {
  Choice choice(source, weights, options, tangent_bytes);
  if (!has_new_base(source)) choice.look_at("as it is", keep_stored(source));
  if (choice.is_found_below(0)) return choice.take_best();
  BakeOptions made_for = options;
  for (int tries = 0; tries <= kMostTightened; ++tries) {
    look_at_all_forms(source, weights, made_for, choice);
    made_for.tolerance = choice.tightened();
    if (!made_for.tolerance) break;
  }
  return choice.take_best();
}

BakeChoice judge_baked(const DeltaSource& source, const MeshWeights& weights, const BakeOptions& options) {
  const GltfShading& shading = source.shading;
  MeshWeights played = weights;
  if (!weights.is_driven) {
    std::vector<std::size_t> own(shading.own_targets());
    std::iota(own.begin(), own.end(), std::size_t{0});
    const PoseList alone = alone_poses(own, shading.set.targets.size(), {}, kAloneSteps, 0);
    played.poses.insert(played.poses.end(), alone.begin(), alone.end());
    for (std::vector<double>& pose : played.poses) fill_extra_weights(shading, pose);
    played.is_driven = true;  // so that no extra target is judged alone
  }
  Choice choice(source, played, options, 0);
  choice.look_at("as it is", keep_stored(source));
  return choice.take_best().choices.front();
}

}  // namespace chronormal::inline internal
