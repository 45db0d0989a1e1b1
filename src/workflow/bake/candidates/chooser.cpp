#include "workflow/bake/candidates/chooser.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>

#include "workflow/bake/candidates/makers.h"

namespace chronormal::inline internal {
namespace {

// The largest number of products w_i w_j of two weights for which correction targets are tried. Each product takes a
// correction target.
constexpr std::size_t kMostProducts = 48;
// The number of attempts to get below the limit of bytes with fewer correction targets.
constexpr int kTries = 5;
// The relative difference up to which two mean errors count as equal.
constexpr double kAlike = 1e-3;
// The largest number of times that candidates are made again for a smaller tolerance. This is done if a skin makes
// errors so large that all candidates are beyond the tolerance.
constexpr int kMostTightened = 3;
constexpr double kPartOfMissed = 0.9, kLeastPart = 0.01;
// Factors for a glance, which measures a candidate in only a few of the poses. A candidate is given up if its mean
// error in the glance is more than kHopeless times that of the best candidate. If the best candidate meets all criteria
// except the tolerance, a smaller factor suffices: a candidate that is also beyond the tolerance is given up if its
// mean error is more than kFarther times that of the best candidate.
constexpr double kHopeless = 2, kFarther = 1.25;
// kFewExtras is the largest number of correction targets with which deltas may take more bytes than the file.
// kBytesOfExtra is roughly the number of bytes that a correction target takes for each vertex.
constexpr std::size_t kFewExtras = 8, kBytesOfExtra = 9;
// A candidate is better than the deltas of the file only if its mean error is below kBetter times the mean error of
// these deltas.
constexpr double kBetter = 0.95;
// The largest part of the mean error that may remain after the number of correction targets of a rig is doubled. If a
// larger part remains, larger numbers are not tried.
constexpr double kWorthIt = 0.9;

bool has_new_base(const DeltaSource& source) {
  return !source.base_normals.empty() && source.base_normals.data() != source.shading.normals.data();
}

bool has_unit(std::span<const Viewer> viewers) {
  return std::any_of(viewers.begin(), viewers.end(),
                     [](const Viewer& viewer) { return viewer.normals == NormalRule::kUnit; });
}

// Returns the largest number of correction targets that the options allow and that all viewers support.
std::size_t most_extras(const BakeOptions& options, std::size_t targets) {
  std::size_t most = 10000;
  const auto limit = [&](std::size_t all) { most = std::min(most, all - std::min(all, targets)); };
  for (const Viewer& viewer : options.viewers)
    if (viewer.most_targets > 0) limit(viewer.most_targets);
  if (options.most_targets) limit(*options.most_targets);
  return most;
}

// Returns true if an error has grown more than is allowed. The mean error may grow up to the tolerance (or, if the poses
// do not decide, by the tolerance), and each other error by the tolerance. Also returns true if too many more edges are
// torn beyond one of the angles 10, 20 and 40 degrees, of which only the first `thresholds` count. For each hundred
// edges torn before (beyond 10 degrees), one more edge may be torn.
bool grows(const ShownErrors& before, const ShownErrors& after, bool decides, double tolerance,
           std::size_t thresholds) {
  constexpr std::size_t kOneOf = 100;
  const double turn = std::fmax(tolerance, kHarmless);
  bool is_torn = false;
  for (std::size_t k = 0; k < thresholds; ++k) is_torn |= after.tears[k] > before.tears[k] + before.tears[0] / kOneOf;
  const double most_mean = std::fmax(before.mean + (decides ? kHarmless : tolerance), tolerance);
  return is_torn || after.mean > most_mean || after.most > before.most + turn || after.worst > before.worst + turn;
}

// A candidate, and how the chooser has judged it.
struct Judged {
  BakedCandidate choice;
  // The number of named viewers in which the candidate is better than the stored deltas, and the number of other
  // viewers in which it is no worse.
  std::size_t better = 0, unharmed = 0;
  bool is_affordable = true, is_bearable = true;
  double mean = 0, mean_of_spared = 0;  // mean error in the worst of the named viewers, and in the worst of the others
};

// Compares candidates. consider() takes the candidates one after the other, and keeps the best one.
class Chooser {
 public:
  Chooser(const DeltaSource& source, const MeshWeights& weights, const BakeOptions& options, std::size_t tangent_bytes)
      : source_(source),
        weights_(weights),
        options_(options),
        viewers_(options.viewers),
        rights_(source.shading, source.terms, source.base_normals, source.plan.largest),
        tolerance_(options.tolerance.value_or(kHarmlessTolerance)),
        prefers_bytes_(source.plan.encoding == BakeEncoding::kSmallest),
        tangent_bytes_(tangent_bytes) {
    viewers_.insert(viewers_.end(), options.spared.begin(), options.spared.end());
    judge_.emplace(source, rights_, weights, viewers_, options.viewers.size(), options.animations_only);
    stored_ = stored_candidate(source);
    before_ = judge_->measure(stored_, Judge::Depth::kAll);
    if (!has_new_base(source)) consider(stored_);
  }

  [[nodiscard]] Making making(bool animations_only) const {
    return {source_,
            rights_,
            weights_,
            *judge_,
            options_.viewers,
            lengths_for(options_.viewers, options_.spared),
            made_within_.value_or(tolerance_),
            most_extras(options_, source_.shading.set.targets.size()),
            animations_only,
            has_unit(options_.viewers)};
  }

  // Judges a candidate, and keeps the candidate if it is the best so far. Returns the bytes of the candidate's deltas.
  std::size_t consider(Candidate candidate) {
    const std::size_t targets = source_.shading.set.targets.size();
    Judged judged;
    BakedCandidate& choice = judged.choice;
    choice.name = candidate.name;
    choice.targets = targets + candidate.drivers.size();
    const std::size_t bytes = bytes_of(source_.shading, weights_, candidate);
    choice.bytes = bytes + tangent_bytes_;
    choice.animations_only = candidate.animations_only;
    choice.skinned = weights_.skins.any();
    judged.is_affordable = bytes <= most_bytes() && candidate.drivers.size() <= most_extras(options_, targets);
    judged.is_bearable = bytes <= bearable_bytes(candidate.drivers.size());
    const bool is_stored = candidate.name == stored_.name;
    const bool is_out = only_lists_ || is_hopeless(candidate);
    if (is_out && !options_.plan) return bytes;
    const std::vector<ErrorsOfKinds> after = is_stored ? before_ : judge_->measure(candidate, Judge::Depth::kAll);
    judge(after, judged);
    const bool is_best = !best_ || (!is_out && is_better(judged, of_best_));
    if (is_best) of_choice_ = candidates_.size();
    candidates_.push_back(choice);
    if (is_best) {
      best_ = std::move(candidate);
      of_best_ = std::move(judged);
      means_of_best_ = means_of(after);
    }
    return bytes;
  }

  // Returns true if a glance (a measurement in a few poses) shows that a candidate is beyond the tolerance.
  [[nodiscard]] bool is_far(const Candidate& candidate) const {
    return is_beyond(judge_->measure(candidate, Judge::Depth::kGlance));
  }
  // Returns true if a glance (a measurement in a few poses) shows that a candidate cannot be the best, since its mean
  // error is much larger in every named viewer.
  [[nodiscard]] bool is_hopeless(const Candidate& candidate) const {
    if (!best_) return false;
    const std::vector<ErrorsOfKinds> glance = judge_->measure(candidate, Judge::Depth::kGlance);
    const std::vector<double> means = means_of(glance);
    bool is_much_larger = true;
    for (std::size_t v = 0; v < means.size(); ++v)
      is_much_larger = is_much_larger && means[v] > kHopeless * std::fmax(means_of_best_[v], tolerance_ / 2);
    if (is_much_larger) return true;
    const double least = *std::min_element(means.begin(), means.end());
    return serves_all() && of_best_.is_bearable && least > kFarther * of_best_.mean && is_beyond(glance);
  }

  [[nodiscard]] std::size_t most_bytes() const {
    const std::size_t most = options_.most_delta_bytes.value_or(std::numeric_limits<std::size_t>::max());
    return most - std::min(most, tangent_bytes_);
  }
  // Returns the number of bytes that deltas may take. If the options give no tolerance and no limit, this number is in
  // proportion to the size of the file. Otherwise it is the limit of bytes.
  [[nodiscard]] std::size_t bearable_bytes(std::size_t extras) const {
    const bool is_asked = options_.tolerance || options_.most_targets || options_.most_delta_bytes;
    if (is_asked || options_.bytes_of_file == 0) return most_bytes();
    return extras > kFewExtras ? options_.bytes_of_file : options_.bytes_of_file + options_.bytes_of_file / 2;
  }
  // Estimates how many correction targets fit into the limit of bytes if each has deltas for all vertices. The deltas
  // of the mesh's own targets take bytes_of_own of these bytes.
  [[nodiscard]] std::size_t extras_within(std::size_t bytes_of_own) const {
    const std::size_t of_one = std::max<std::size_t>(1, kBytesOfExtra * judge_->vertices().size());
    const auto room = [&](std::size_t bytes) { return (bytes - std::min(bytes, bytes_of_own)) / of_one; };
    // Allows one correction target more than the estimate. If the deltas take too many bytes, fewer targets are tried.
    if (options_.most_delta_bytes) return room(most_bytes()) + 1;
    return std::max(std::min(kFewExtras, room(bearable_bytes(kFewExtras))), room(bearable_bytes(kFewExtras + 1)));
  }
  // Returns true if the best candidate is accurate enough and takes at most `bytes` bytes, so that no other candidate
  // needs to be tried.
  [[nodiscard]] bool is_found(std::size_t bytes = std::numeric_limits<std::size_t>::max()) const {
    return best_ && of_best_.choice.within && serves_all() && of_best_.choice.bytes - tangent_bytes_ <= bytes;
  }
  // Tells whether to look at the next candidates if a bake does so unless `is_enough`. A plan (options_.plan) looks at
  // all candidates, but until go_on() is called, it only lists those at which a bake does not look. For this reason a
  // plan recommends what a bake writes.
  [[nodiscard]] bool looks_unless(bool is_enough) noexcept {
    only_lists_ = is_closed_ || is_enough;
    return !only_lists_ || options_.plan;
  }
  void go_on() noexcept { only_lists_ = is_closed_; }
  // Ends the choice if `is_enough`. Returns true if there is nothing left to do, not even to list more candidates.
  [[nodiscard]] bool ends_if(bool is_enough) noexcept {
    only_lists_ = is_closed_ |= is_enough;
    return is_closed_ && !options_.plan;
  }
  [[nodiscard]] const Judged& of_best() const { return of_best_; }

  // Reduces the tolerance for which candidates are made, if skins make all candidates miss the given tolerance. Returns
  // false if a smaller tolerance cannot help.
  bool tighten() {
    if (!best_ || of_best_.choice.within || !weights_.skins.any()) return false;
    const double now = made_within_.value_or(tolerance_);
    const double next = kPartOfMissed * now * tolerance_ / of_best_.choice.played.worst;
    if (next < kLeastPart * tolerance_) return false;
    made_within_ = next;
    return true;
  }

  [[nodiscard]] ChosenCandidate take() {
    if (!best_) consider(stored_);
    ChosenCandidate result;
    candidates_[of_choice_].chosen = true;
    result.viewers = of_best_.choice.viewers;
    if (std::any_of(viewers_.begin(), viewers_.end(), is_rounding)) {
      const std::vector<ErrorsOfKinds> before = judge_->measure(stored_, Judge::Depth::kRounded),
                                       after = judge_->measure(*best_, Judge::Depth::kRounded);
      for (std::size_t v = 0; v < viewers_.size(); ++v) {
        if (!is_rounding(viewers_[v])) continue;
        for (std::size_t k = 0; k < kPoseKinds; ++k)
          result.viewers[v].poses[k] = {before[v][k].errors(), after[v][k].errors()};
        if (v >= options_.viewers.size()) continue;
        double& worst = candidates_[of_choice_].rounded;
        worst = std::fmax(worst, after[v][static_cast<std::size_t>(PoseKind::kFile)].spread.worst);
      }
    }
    result.candidate = std::move(*best_);
    result.candidates = std::move(candidates_);
    return result;
  }

 private:
  static bool is_rounding(const Viewer& viewer) { return viewer.normals == NormalRule::kClamped; }

  // Returns the errors in one viewer by which candidates are compared: the errors in all kinds of poses that decide
  // (Judge::decides()).
  [[nodiscard]] ShownErrors file_of(const ErrorsOfKinds& kinds) const {
    JudgedErrors all;
    for (std::size_t k = 0; k < kPoseKinds; ++k)
      if (judge_->decides(static_cast<PoseKind>(k))) all.add(kinds[k]);
    return all.errors();
  }

  // Returns true if the best candidate is within the limits, better in all named viewers, and no worse in all other
  // viewers.
  [[nodiscard]] bool serves_all() const {
    return of_best_.is_affordable && of_best_.better + of_best_.unharmed == viewers_.size();
  }

  // Returns true if some error in a named viewer is beyond the tolerance.
  [[nodiscard]] bool is_beyond(const std::vector<ErrorsOfKinds>& errors) const {
    return std::any_of(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(options_.viewers.size()),
                       [&](const ErrorsOfKinds& of_viewer) { return of_viewer[0].spread.worst > tolerance_; });
  }

  // Returns the mean errors in the named viewers.
  [[nodiscard]] std::vector<double> means_of(const std::vector<ErrorsOfKinds>& errors) const {
    std::vector<double> result;
    for (std::size_t v = 0; v < options_.viewers.size(); ++v) result.push_back(file_of(errors[v]).mean);
    return result;
  }

  void judge(const std::vector<ErrorsOfKinds>& after, Judged& judged) const {
    BakedCandidate& choice = judged.choice;
    choice.viewers.resize(viewers_.size());
    double least_gain = std::numeric_limits<double>::infinity(), most_harm = 0;  // changes of mean errors, in degrees
    for (std::size_t v = 0; v < viewers_.size(); ++v) {
      ViewerChange& change = choice.viewers[v];
      const bool is_named = v < options_.viewers.size();
      change.viewer = std::string(viewers_[v].name);
      change.is_named = is_named;
      bool any_grows = false;
      for (std::size_t k = 0; k < kPoseKinds; ++k) {
        change.poses[k] = {before_[v][k].errors(), after[v][k].errors()};
        if (choice.animations_only && k != static_cast<std::size_t>(PoseKind::kFile))
          change.poses[k].before = {};
        else
          any_grows |= grows(change.poses[k].before, change.poses[k].after, judge_->decides(static_cast<PoseKind>(k)),
                             tolerance_, is_named ? change.poses[k].before.tears.size() : 1);
      }
      const auto all_of = [&](const ErrorsOfKinds& kinds) {
        return choice.animations_only ? kinds[0].errors() : errors_of_all(kinds).errors();
      };
      const ShownErrors then = all_of(before_[v]), now = all_of(after[v]);
      most_harm = std::fmax(most_harm, now.mean - then.mean);
      // If the caller has requested an encoding, a candidate is better than the deltas of the file under two
      // conditions. Its mean error must be smaller, in the poses of the file or in all poses. In addition, it must not
      // tear more edges, or none of its errors may have grown.
      const bool is_asked = source_.plan.encoding != BakeEncoding::kSmallest;
      const bool is_nearer = now.mean < then.mean || file_of(after[v]).mean < file_of(before_[v]).mean;
      change.is_better = is_asked ? is_nearer && (now.tears[0] <= then.tears[0] || !any_grows)
                                  : !any_grows && now.mean < kBetter * then.mean;
      if (is_named && change.is_better) {
        ++judged.better;
        least_gain = std::fmin(least_gain, then.mean - now.mean);
      }
      if (!is_named && (is_asked || !any_grows)) ++judged.unharmed;
      if (!is_named) judged.mean_of_spared = std::fmax(judged.mean_of_spared, file_of(after[v]).mean);
      if (!is_named) continue;
      const ShownErrors played = file_of(after[v]);
      choice.played = {std::max(choice.played.judged, played.judged), std::fmax(choice.played.mean, played.mean),
                       std::fmax(choice.played.most, played.most), std::fmax(choice.played.worst, played.worst),
                       choice.played.tears};
      for (std::size_t k = 0; k < played.tears.size(); ++k)
        choice.played.tears[k] = std::max(choice.played.tears[k], played.tears[k]);
    }
    judged.mean = choice.played.mean;
    choice.within = judged.is_affordable && choice.played.worst <= tolerance_;
    // If the mean error grows by more than the tolerance in some viewer, and falls by less in a named viewer in which the
    // candidate is better, the candidate counts as better in no viewer, unless the caller asked for this candidate.
    const bool is_asked = source_.plan.encoding != BakeEncoding::kSmallest || (options_.tolerance && choice.within);
    if (!is_asked && most_harm > tolerance_ && most_harm > least_gain) judged.better = 0;
  }

  [[nodiscard]] bool is_better(const Judged& judged, const Judged& than) const {
    // The deltas of the file lose to any candidate that is better in some viewer. There is one exception: the deltas of
    // the file win if they are within the tolerance and the smallest file is preferred.
    const bool is_stored = judged.choice.name == stored_.name, was_stored = than.choice.name == stored_.name;
    if (was_stored && !is_stored)
      return judged.is_affordable && judged.better > 0 && !(than.choice.within && prefers_bytes_);
    if (is_stored && !was_stored) return false;
    // A tolerance that the caller gave counts more than viewers that the caller did not name.
    const auto rank = [is_asked = options_.tolerance.has_value()](const Judged& of) {
      return std::tuple(of.is_affordable, of.better, is_asked && of.choice.within, of.unharmed, of.is_bearable,
                        of.choice.within);
    };
    if (rank(judged) != rank(than)) return rank(judged) > rank(than);
    if (judged.choice.within && prefers_bytes_) {
      const double in_others = judged.mean_of_spared, in_others_than = than.mean_of_spared;
      if (in_others < in_others_than / 2 || in_others_than < in_others / 2) return in_others < in_others_than;
      return judged.choice.bytes < than.choice.bytes;
    }
    const bool is_alike = std::fabs(judged.mean - than.mean) <= kAlike * than.mean;
    return is_alike ? judged.choice.bytes < than.choice.bytes : judged.mean < than.mean;
  }

  const DeltaSource& source_;
  const MeshWeights& weights_;
  const BakeOptions& options_;
  std::vector<Viewer> viewers_;  // the named viewers, then the others
  RightNormals rights_;
  double tolerance_;
  std::optional<double> made_within_;  // the tolerance for which candidates are made, if smaller than tolerance_
  bool prefers_bytes_;
  std::size_t tangent_bytes_;
  std::optional<Judge> judge_;
  Candidate stored_;
  std::vector<ErrorsOfKinds> before_;
  std::optional<Candidate> best_;
  Judged of_best_;
  std::size_t of_choice_ = 0;                    // the index of the best candidate in candidates_
  std::vector<double> means_of_best_;            // the mean errors of the best candidate in the named viewers
  bool is_closed_ = false, only_lists_ = false;  // if true, no candidate, or not the next one, can become the best
  std::vector<BakedCandidate> candidates_;
};

// Tries correction targets of low rank (low_rank.cpp): as many as the tolerance needs, within the bytes by which the
// file may grow. If their deltas take too many bytes, tries fewer targets.
void look_at_low_rank(const Making& making, const Candidate& own, std::size_t bytes_of_own, Chooser& chooser) {
  Making of_try = making;
  of_try.most_extras = std::min(of_try.most_extras, chooser.extras_within(bytes_of_own));
  for (int tries = 0; tries < kTries && (of_try.most_extras > 0 || (tries == 0 && making.animations_only)); ++tries) {
    Candidate candidate = low_rank_candidate(of_try, own);
    const std::size_t count = candidate.drivers.size();
    const std::size_t bytes = chooser.consider(std::move(candidate));
    const std::size_t most = chooser.bearable_bytes(count);
    if (bytes <= most || count == 0) return;
    const double part = static_cast<double>(most - std::min(most, bytes_of_own)) /
                        static_cast<double>(bytes - std::min(bytes - 1, bytes_of_own));
    of_try.most_extras = std::min(count - 1, static_cast<std::size_t>(std::ceil(part * static_cast<double>(count))));
  }
}

// Tries correction targets for a mesh that no animation drives. Tries larger and larger numbers of correction targets,
// as long as each step reduces the mean error enough (kWorthIt).
void look_at_quadratics(const Making& making, const Candidate& own, Chooser& chooser) {
  double mean = std::numeric_limits<double>::infinity();
  quadratics_candidates(making, own, [&](Candidate candidate) {
    chooser.consider(std::move(candidate));
    if (chooser.ends_if(chooser.is_found() || chooser.of_best().mean > kWorthIt * mean)) return false;
    mean = chooser.of_best().mean;
    return true;
  });
}

// Returns true if there are so few pairs of targets that each pair can have a correction target.
bool has_few_products(const Making& making, const MeshWeights& weights) {
  const MeshPlan& plan = making.source.plan;
  return making.most_extras > 0 && (plan.is_driven || weights.rig) && plan.products_fit &&
         count_products(making, kMostProducts) <= kMostProducts;
}

// Makes deltas of any length for the mesh's own targets. Each delta is the sum of the linear and the square term of its
// target, so no best single delta is searched as in the plan of the source.
Candidate similar_to_own(const DeltaSource& source, const RightNormals& rights) {
  MeshPlan plan = source.plan;
  plan.is_line.assign(plan.is_line.size(), false);
  return own_candidate({source.shading, source.terms, plan, source.base_normals}, rights, Lengths::kFree);
}

void look_at_all(const DeltaSource& source, const MeshWeights& weights, const Making& making, Chooser& chooser,
                 const std::function<void(std::size_t)>& reach) {
  Candidate own = own_candidate(source, making.rights, making.lengths);
  own.animations_only = false;
  // If a glance finds the deltas of the mesh's own targets beyond the tolerance, and correction targets may help, these
  // deltas are judged after the candidates with correction targets.
  const bool has_extras = source.plan.is_driven && source.plan.products_fit && making.most_extras > 0;
  const bool waits = has_extras && chooser.is_far(own);
  if (!waits) chooser.consider(own);
  const std::size_t bytes = bytes_of(source.shading, weights, own);
  reach(20);
  if (chooser.ends_if(chooser.is_found())) return;
  if (has_few_products(making, weights)) chooser.consider(products_candidate(making));
  // Deltas of any length may be closer than deltas that are right at weight 1, even if the terms of n(w) are a fit.
  const bool any_length = making.lengths != Lengths::kUnit && !has_unit(making.viewers);
  if (any_length && !making.rights.are_by_area() && chooser.looks_unless(chooser.is_found()))
    chooser.consider(fitted_candidate(source));
  std::optional<Candidate> similar;  // if set, own deltas of any length are judged last
  if (making.lengths == Lengths::kShort && any_length && chooser.looks_unless(chooser.is_found())) {
    // Tries deltas of any length too. Viewers that add deltas as stored render the true normals with them, and in many
    // files other viewers render such deltas no worse than the file before the bake.
    Making of_any = making;
    of_any.lengths = Lengths::kFree;
    if (making.rights.are_by_area()) {
      if (has_extras) similar = similar_to_own(source, making.rights);
      if (similar && !chooser.is_far(*similar)) similar.reset();
      if (!similar) chooser.consider(own_candidate(source, making.rights, of_any.lengths));
    }
    if (has_few_products(of_any, weights) && chooser.looks_unless(chooser.is_found()))
      chooser.consider(products_candidate(of_any));
  }
  chooser.go_on();
  if (making.most_extras == 0) return;
  reach(40);
  if (weights.rig && source.plan.products_fit && chooser.looks_unless(chooser.is_found()))
    look_at_quadratics(making, own, chooser);
  chooser.go_on();
  if (has_extras) {
    // All viewers render the same normals if corrections are perpendicular to the stored normal N. Such corrections may
    // need more correction targets.
    Making across = making;
    across.keeps_across |= making.lengths == Lengths::kShort;
    look_at_low_rank(across, own, bytes, chooser);
    if (across.keeps_across != making.keeps_across && chooser.looks_unless(chooser.is_found()))
      look_at_low_rank(making, own, bytes, chooser);
  }
  chooser.go_on();
  if (waits) chooser.consider(own);
  if (similar && !chooser.is_hopeless(*similar)) chooser.consider(own_candidate(source, making.rights, Lengths::kFree));
  reach(90);
}

}  // namespace

ChosenCandidate choose_candidate(const DeltaSource& source, const MeshWeights& weights, const BakeOptions& options,
                                 std::size_t tangent_bytes) {
  const auto reach = [&options](std::size_t percent) {
    if (options.progress) options.progress(percent, 100);
  };
  Chooser chooser(source, weights, options, tangent_bytes);
  reach(10);
  if (source.plan.encoding == BakeEncoding::kEndpoint) {
    MeshPlan alone = source.plan;
    alone.lines = FittedLines();
    const RightNormals& rights = chooser.making(false).rights;
    chooser.consider(own_candidate({source.shading, source.terms, alone, source.base_normals}, rights, Lengths::kFree));
    // Tries no deltas that are fitted to animations if the author's normals are known. The deltas of the file may then
    // be right at its keys, and fitted deltas would change the normals there.
    const bool has_author = source.terms.follow_keys() && !options.weighting;
    if (source.plan.lines.elements() == 0 || has_author) return chooser.take();
    chooser.consider(own_candidate(source, rights, Lengths::kFree));
    ChosenCandidate chosen = chooser.take();
    // If targets are played together, the errors of their deltas are known only in the poses that were measured. For
    // this reason the error of the fit is raised to the largest error in these poses.
    if (chosen.candidate.fit_error < source.plan.lines.largest_error())
      for (const ViewerChange& change : chosen.viewers)
        if (change.is_named)
          chosen.candidate.fit_error =
              std::fmax(chosen.candidate.fit_error, change.poses[0].after.worst / kDegreesPerRadian);
    return chosen;
  }
  if (source.plan.encoding == BakeEncoding::kHarmless) {
    Making making = chooser.making(false);
    making.lengths = Lengths::kUnit;
    chooser.consider(own_candidate(source, making.rights, making.lengths));
    chooser.consider(products_candidate(making));
    return chooser.take();
  }
  if (chooser.ends_if(chooser.is_found(0))) return chooser.take();
  for (int tries = 0; tries <= kMostTightened; ++tries) {
    // Deltas that are fitted to animations help only viewers that add up deltas of any length.
    Making making = chooser.making(options.animations_only);
    if (options.animations_only && source.plan.is_driven && making.lengths == Lengths::kFree) {
      look_at_low_rank(making, own_candidate(source, making.rights, making.lengths), 0, chooser);
      making.animations_only = false;
    }
    look_at_all(source, weights, making, chooser, reach);
    if (!chooser.tighten()) break;
  }
  return chooser.take();
}

BakedCandidate judge_baked(const DeltaSource& source, const MeshWeights& weights, const BakeOptions& options) {
  constexpr std::size_t kSteps = 8;
  const GltfShading& shading = source.shading;
  MeshWeights played = weights;
  if (!weights.is_driven) {
    std::vector<std::size_t> own(shading.own_targets());
    for (std::size_t i = 0; i < own.size(); ++i) own[i] = i;
    const PoseList alone = alone_poses(own, shading.set.targets.size(), kSteps);
    played.poses.insert(played.poses.end(), alone.begin(), alone.end());
    for (std::vector<double>& pose : played.poses) fill_extra_weights(shading, pose);
    played.is_driven = true;
  }
  BakeOptions without_alone = options;
  without_alone.animations_only = true;  // leaves out the poses with one target alone
  Chooser chooser(source, played, without_alone, 0);
  return chooser.take().candidates.front();
}

}  // namespace chronormal::inline internal
