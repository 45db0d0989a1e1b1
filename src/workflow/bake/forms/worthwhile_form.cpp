// What is offered is looked at with weights as they should be. Tracks that stay LINEAR have extra weights that are
// straight between keys, so that each selection is judged once more as it would be written.
#include "workflow/bake/forms/worthwhile_form.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "workflow/bake/exact/shared_parts.h"
#include "workflow/bake/forms/alone_deltas.h"
#include "workflow/bake/forms/form_poses.h"
#include "workflow/bake/forms/worthwhile_columns.h"
#include "workflow/bake/judge/played_errors.h"

namespace chronormal::inline internal {
namespace {

// Vectors of all products that are looked at, pairs of a vertex and a pose, and poses of one kind.
constexpr std::size_t kMostVectors = 3000000, kMostComparedPairs = 6000000;
constexpr std::size_t kFewestPoses = 24, kMostPoses = 400, kFewestSteps = 3, kMostSteps = 16;
constexpr unsigned kSeed = 2;

using Corrections = std::map<std::pair<std::size_t, std::size_t>, std::vector<Column>>;

// The pairs of targets that need something of their own, a target with itself among them; none where that is too much.
std::vector<std::pair<std::size_t, std::size_t>> products_of(const DeltaSource& source, const MeshWeights& weights) {
  const std::size_t targets = source.shading.set.targets.size();
  std::vector<std::size_t> sizes(targets, 0);
  for (std::size_t i = 0; i < targets; ++i)
    if (moves(source.shading, i)) sizes[i] = source.terms.elements(i).size();
  std::vector<std::pair<std::size_t, std::size_t>> result;
  std::size_t vectors = 0;
  for (std::size_t i = 0; i < targets; ++i) {
    for (std::size_t j = i; j < targets && sizes[i] > 0; ++j) {
      if (sizes[j] == 0 || !weights.use.together(i, j) || (i != j && !source.terms.overlap(i, j))) continue;
      vectors += std::min(sizes[i], sizes[j]);
      if (vectors > kMostVectors) return {};
      result.emplace_back(i, j);
    }
  }
  return result;
}

double largest_turn(const Column& column, const WeightUse& use) {
  double most = 0;
  for (const Vec3f& delta : column.deltas.vectors) most = std::fmax(most, static_cast<double>(dot(delta, delta)));
  return std::sqrt(most) * use.largest(column.weight.i) * use.largest(column.weight.j);
}

// Leaves the largest corrections, no more than so many.
void limit_corrections(std::size_t most, const WeightUse& use, Corrections& corrections) {
  std::vector<std::pair<double, std::pair<std::size_t, std::size_t>>> order;
  for (const auto& [pair, columns] : corrections) {
    double turn = 0;
    for (const Column& column : columns) turn = std::fmax(turn, largest_turn(column, use));
    order.emplace_back(-turn, pair);
  }
  std::sort(order.begin(), order.end());
  std::size_t count = 0;
  for (const auto& [turn, pair] : order) {
    const std::size_t of_pair = corrections[pair].size();
    if (count + of_pair > most)
      corrections.erase(pair);
    else
      count += of_pair;
  }
}

}  // namespace

// Makes forms of what is offered.
class WorthwhileForms {
 public:
  // needs_extras: without extra targets there is nothing to offer.
  WorthwhileForms(const DeltaSource& source, const MeshWeights& weights, const BakeOptions& options,
                  FormLengths lengths, bool needs_extras)
      : source_(source),
        weights_(weights),
        options_(options),
        lengths_(lengths),
        rights_(source.shading, source.terms, source.base_normals, source.plan.largest),
        tolerance_(options.tolerance.value_or(kHarmlessTolerance)),
        stored_(stored_deltas(source.shading)),
        vertices_(judged_vertices(source, stored_)),
        numbers_(numbers_of_targets(source, stored_, vertices_)),
        parts_(source.shading) {
    Corrections all = corrections();
    have_extras_ = !all.empty();
    if (have_extras_ || !needs_extras) offer(std::move(all));
  }

  void find(std::size_t most_bytes, const std::function<bool(std::size_t)>& is_enough,
            const std::function<std::size_t(ChosenForm)>& take) const {
    find_worthwhile(rights_, vertices_, source_.shading.element_of_vertex, offered_, asked_poses(), options_.hosts,
                    tolerance_, most_bytes, [&](const Selection& selection) -> std::optional<std::size_t> {
                      std::size_t bytes = 0;
                      for (std::size_t s = 0; s < selection.size(); ++s) bytes += offered_.slots[s][selection[s]].bytes;
                      if (is_enough(bytes)) return std::nullopt;
                      return take(form_of(selection));
                    });
  }

  [[nodiscard]] bool have_extras() const { return have_extras_; }

 private:
  [[nodiscard]] std::size_t targets() const { return source_.shading.set.targets.size(); }

  // What an array of these deltas takes, as it will be written.
  [[nodiscard]] std::size_t bytes_of(const VertexVectors& deltas) const { return parts_.bytes_of(deltas); }

  std::size_t add(Column column) {
    offered_.columns.push_back(std::move(column));
    return offered_.columns.size() - 1;
  }

  // The deltas to the ends of targets, where lengths are not free.
  [[nodiscard]] std::vector<VertexVectors> ends_that_fit() const {
    return end_point_form(source_.shading, source_.terms, rights_, lengths_).own;
  }

  [[nodiscard]] Corrections corrections() const {
    Corrections result;
    if (!source_.plan.is_driven || !source_.plan.products_fit || options_.animations_only) return result;
    const auto products = products_of(source_, weights_);
    const std::size_t most = most_extras(options_, targets());
    if (products.empty() || most == 0) return result;
    if (lengths_ == FormLengths::kFree) {
      for (const auto& [i, j] : products) {
        const ExtraWeight weight = i == j ? ExtraWeight{i, i, 1, -1} : ExtraWeight{i, j, 0, 1};
        VertexVectors deltas = as_column(source_.shading, extra_target_deltas(source_, weight));
        if (!deltas.vertices.empty()) result[{i, j}].push_back({std::move(deltas), weight, false});
      }
    } else {
      HarmlessForm form;
      form.own = ends_that_fit();
      const std::vector<VertexColumns> forms = {by_vertex(columns_of(form.own), vertices_)};
      const PoseList samples = weights_.use.samples_with_keys(enough_poses(source_.shading, forms));
      const std::vector<bool> is_new = new_bases(source_);
      const HostJudge judge(rights_, vertices_, source_.shading.element_of_vertex, is_new, options_.hosts,
                            std::vector<bool>(options_.hosts.size(), true), tolerance_);
      add_corrections(source_.shading, source_.terms, rights_, samples, vertices_, judge.worst(forms[0], samples),
                      {lengths_, most, tolerance_}, form);
      for (std::size_t k = 0; k < form.extras.size(); ++k)
        result[{form.weights[k].i, form.weights[k].j}].push_back({std::move(form.extras[k]), form.weights[k], false});
    }
    limit_corrections(most, weights_.use, result);
    return result;
  }

  // Offers each target in all ways, with these corrections. Cost: a search for the best delta of each vertex and target.
  void offer(Corrections all) {
    MeshPlan plan = source_.plan;
    plan.lines = FittedLines();
    const DeltaSource alone{source_.shading, source_.terms, plan, source_.base_normals};
    std::vector<VertexVectors> ends, single;
    if (lengths_ == FormLengths::kFree) {
      double error = 0;
      single = endpoint_deltas(alone, error);
      plan.is_line.assign(plan.is_line.size(), false);
      ends = endpoint_deltas(alone, error);
    } else {
      ends = ends_that_fit();
      single = ends;
    }
    make_harmless_alone(source_, stored_, lengths_, tolerance_, single);
    std::size_t keys = 0;
    for (const WeightTrack& track : weights_.tracks)
      keys += (track.interpolation == GltfInterpolation::kCubicSpline ? 3 : 1) * track.size();
    const auto add_corrections_of = [&](std::size_t i, std::size_t j, Option& option) {
      const auto found = all.find({i, j});
      if (found == all.end()) return;
      for (Column& column : found->second) {
        option.bytes += bytes_of(column.deltas) + sizeof(float) * keys;
        option.columns.push_back(add(std::move(column)));
      }
    };
    for (std::size_t i = 0; i < targets(); ++i) {
      const ExtraWeight own{i, i, 1, 0};
      Slot slot = {{{add({stored_[i], own, true})}, 0}};
      if (!ends[i].vertices.empty() || !stored_[i].vertices.empty()) {
        const std::size_t of_single = bytes_of(single[i]), of_ends = bytes_of(ends[i]);
        slot.push_back({{add({std::move(single[i]), own, false})}, of_single});
        Option with_corrections{{add({std::move(ends[i]), own, false})}, of_ends};
        slot.push_back(with_corrections);
        add_corrections_of(i, i, with_corrections);
        if (with_corrections.columns.size() > 1) slot.push_back(std::move(with_corrections));
      }
      offered_.slots.push_back(std::move(slot));
    }
    for (const auto& [pair, columns] : all) {
      if (pair.first == pair.second) continue;
      Slot slot = {{}, {}};
      add_corrections_of(pair.first, pair.second, slot.back());
      offered_.slots.push_back(std::move(slot));
    }
  }

  // What the file shows, and its targets alone.
  [[nodiscard]] std::vector<AskedPose> asked_poses() const {
    const std::size_t most =
        std::clamp(kMostComparedPairs / std::max<std::size_t>(1, vertices_.size()), kFewestPoses, kMostPoses);
    std::vector<AskedPose> poses;
    const auto add_poses = [&](const PoseList& list, bool must_be_near, std::size_t limit) {
      const std::size_t count = std::min(limit, list.size());
      for (std::size_t n = 0; n < count; ++n) poses.push_back({list[n * list.size() / count], must_be_near});
    };
    for (const auto& [between, phase] : {std::pair(std::size_t{4}, 0.0), std::pair(std::size_t{3}, 0.37)})
      for (const PoseSet& set :
           pose_sets(source_.shading, weights_, {}, options_.hosts, numbers_, {between, most / 4, phase, kSeed, true}))
        add_poses(different_weights_of(set.poses), source_.plan.is_driven, most / 4);
    add_poses(different_weights_of(played_poses(weights_, {}, targets(), most / 4)), true, most / 2);
    std::vector<std::size_t> all;
    for (std::size_t i = 0; i < targets(); ++i)
      if (!numbers_[i].empty()) all.push_back(i);
    const std::size_t steps = std::clamp(most / 2 / (all.size() + 1), kFewestSteps, kMostSteps);
    add_poses(alone_poses(all, targets(), {}, steps, 0), !source_.plan.is_driven, most);
    return poses;
  }

  [[nodiscard]] ChosenForm form_of(const Selection& selection) const {
    ChosenForm result;
    result.animations_only = options_.animations_only;
    result.vertices_ = vertices_;
    std::vector<VertexVectors>& own = result.own_of_form_.emplace_back();
    for (std::size_t s = 0; s < selection.size(); ++s) {
      const Option& option = offered_.slots[s][selection[s]];
      for (std::size_t n = 0; n < option.columns.size(); ++n) {
        const Column& column = offered_.columns[option.columns[n]];
        if (s < targets() && n == 0) {
          own.push_back(column.deltas);
        } else {
          result.extras_.push_back(column.deltas);
          result.drivers.formulas.push_back(column.weight);
        }
      }
    }
    const std::vector<VertexColumns> forms = {by_vertex(columns_of(stored_), vertices_),
                                              by_vertex(columns_of(own, result.extras_), vertices_)};
    cut_tracks(rights_, weights_, options_.hosts, vertices_, forms[1], kPartOfTracks * tolerance_ / kDegreesPerRadian,
               result.drivers, result.track_error);
    const std::vector<bool> is_new = new_bases(source_);
    const HostJudge judge(rights_, vertices_, source_.shading.element_of_vertex, is_new, options_.hosts,
                          std::vector<bool>(options_.hosts.size(), true), tolerance_);
    result.choice_.assign(vertices_.size(), 1);
    const std::size_t most = enough_poses(source_.shading, forms);
    result.hosts = judge.settle(forms,
                                pose_sets(source_.shading, weights_, result.drivers, options_.hosts, numbers_,
                                          {3, most, 0.37, kSeed, options_.animations_only}),
                                result.choice_);
    keep_chosen(result);
    result.kept = kept_elements(source_.shading, vertices_, result.choice_);
    return result;
  }

  // Vertices that keep what is stored take no part in extra targets.
  void keep_chosen(ChosenForm& result) const {
    std::size_t kept = 0;
    for (std::size_t k = 0; k < result.extras_.size(); ++k) {
      VertexVectors used;
      for (std::size_t n = 0, at = 0; n < result.extras_[k].vertices.size(); ++n) {
        while (vertices_[at] < result.extras_[k].vertices[n]) ++at;
        if (result.choice_[at] == 0) continue;
        used.vertices.push_back(result.extras_[k].vertices[n]);
        used.vectors.push_back(result.extras_[k].vectors[n]);
      }
      if (used.vertices.empty()) continue;
      result.extras_[kept] = std::move(used);
      result.drivers.formulas[kept++] = result.drivers.formulas[k];
    }
    result.extras_.resize(kept);
    result.drivers.formulas.resize(kept);
  }

  const DeltaSource& source_;
  const MeshWeights& weights_;
  const BakeOptions& options_;
  FormLengths lengths_;
  RightNormals rights_;
  double tolerance_;
  std::vector<VertexVectors> stored_;
  std::vector<std::uint32_t> vertices_;
  std::vector<std::vector<std::uint32_t>> numbers_;
  SharedParts parts_;
  Worthwhile offered_;
  bool have_extras_ = false;
};

bool find_worthwhile_forms(const DeltaSource& source, const MeshWeights& weights, const BakeOptions& options,
                           FormLengths lengths, bool are_near_alone, std::size_t most_bytes,
                           const std::function<bool(std::size_t bytes)>& is_enough,
                           const std::function<std::size_t(ChosenForm)>& take) {
  const WorthwhileForms forms(source, weights, options, lengths, !are_near_alone);
  if (are_near_alone || forms.have_extras()) forms.find(most_bytes, is_enough, take);
  return forms.have_extras();
}

}  // namespace chronormal::inline internal
