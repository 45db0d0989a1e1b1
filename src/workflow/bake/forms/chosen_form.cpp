// The poses that a form is chosen by are others than those that it is settled at: what holds at both will hold between
// them. Weights of extra targets between keys are what hosts play of the tracks as they will be written.
#include "workflow/bake/forms/chosen_form.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "workflow/bake/exact/shared_parts.h"
#include "workflow/bake/forms/form_poses.h"

namespace chronormal::inline internal {
namespace {

// Of the errors: what twice as many targets must leave at most.
constexpr double kBetterByFar = 0.6;
constexpr unsigned kFirstSeed = 1, kSecondSeed = 2, kRigSeed = 4;

// The forms with extra targets: those of each target alone, or all.
enum Choice : std::uint8_t { kStored, kEnds, kSelf, kAll };

bool is_of_one(const ExtraWeight& weight) { return weight.i == weight.j; }

// Keeps of the extra targets those that some vertex takes part in.
void drop_unused(std::span<const std::uint32_t> vertices, std::span<const std::uint8_t> choice, HarmlessForm& form,
                 ExtraDrivers& drivers) {
  std::size_t kept = 0;
  for (std::size_t k = 0; k < form.extras.size(); ++k) {
    VertexVectors used;
    const VertexVectors& all = form.extras[k];
    for (std::size_t n = 0, at = 0; n < all.vertices.size(); ++n) {
      while (vertices[at] < all.vertices[n]) ++at;
      if (choice[at] != kAll && !(choice[at] == kSelf && is_of_one(drivers.formulas[k]))) continue;
      used.vertices.push_back(all.vertices[n]);
      used.vectors.push_back(all.vectors[n]);
    }
    if (used.vertices.empty()) continue;
    form.extras[kept] = std::move(used);
    drivers.formulas[kept++] = drivers.formulas[k];
  }
  form.extras.resize(kept);
  drivers.formulas.resize(kept);
}

std::vector<std::vector<float>> of_parts(const GltfShading& shading, const std::vector<float>& all) {
  std::vector<std::vector<float>> result;
  for (const GltfPart& part : shading.parts) {
    const auto first = all.begin() + static_cast<std::ptrdiff_t>(3 * part.first_vertex);
    const auto last = first + static_cast<std::ptrdiff_t>(3 * part.vertex_count);
    const bool any = std::any_of(first, last, [](float c) { return c != 0; });
    result.push_back(any ? std::vector<float>(first, last) : std::vector<float>());
  }
  return result;
}

void set_vector(std::vector<float>& all, std::size_t vertex, const Vec3f& vector) {
  VectorView<float>::packed(all.data(), all.size() / 3).set(vertex, vector);
}

}  // namespace

const std::vector<VertexVectors>& ChosenForm::own_of(std::uint8_t form) const {
  return own_of_form_[std::min<std::size_t>(form, own_of_form_.size()) - 1];
}

bool ChosenForm::changes(const GltfShading& shading) const {
  if (drivers.size() > 0) return true;
  for (std::size_t i = 0; i < shading.set.targets.size(); ++i)
    if (own_deltas(shading, i)) return true;
  return false;
}

VertexColumns ChosenForm::columns(const GltfShading& shading) const {
  std::vector<VertexVectors> own(shading.set.targets.size());
  const std::vector<VertexVectors> stored = stored_deltas(shading);
  for (std::size_t i = 0; i < own.size(); ++i) {
    for (std::size_t n = 0; n < vertices_.size(); ++n) {
      const Vec3f delta = (choice_[n] > 0 ? own_of(choice_[n]) : stored)[i].at(vertices_[n]);
      if (delta == Vec3f{}) continue;
      own[i].vertices.push_back(vertices_[n]);
      own[i].vectors.push_back(delta);
    }
  }
  return by_vertex(columns_of(own, extras_), vertices_);
}

std::size_t ChosenForm::bytes(const GltfShading& shading) const {
  constexpr std::size_t kTerm = 40;  // a term stands in the mesh and in its node
  std::size_t total = 0;
  for (const GltfExtraTarget& sum : drivers.sums) total += kTerm * (sum.linear.size() + sum.quadratic.size());
  const SharedParts parts(shading);
  const auto add = [&](TargetDeltas deltas) {
    parts.join(deltas);
    total += parts.bytes_of(deltas);
  };
  for (std::size_t i = 0; i < shading.set.targets.size(); ++i)
    if (std::optional<TargetDeltas> deltas = own_deltas(shading, i)) add(std::move(*deltas));
  for (std::size_t k = 0; k < extras_.size(); ++k) add(extra_deltas(shading, k));
  return total;
}

std::optional<TargetDeltas> ChosenForm::own_deltas(const GltfShading& shading, std::size_t target) const {
  const std::vector<float>& stored = shading.normal_deltas[target];
  std::vector<float> all = stored.empty() ? std::vector<float>(shading.normals.size()) : stored;
  for (float& c : all)
    if (!std::isfinite(c)) c = 0;
  for (std::size_t n = 0; n < vertices_.size(); ++n) {
    if (choice_[n] > 0) set_vector(all, vertices_[n], own_of(choice_[n])[target].at(vertices_[n]));
  }
  const bool is_as_it_was =
      stored.empty() ? std::all_of(all.begin(), all.end(), [](float c) { return c == 0; }) : all == stored;
  if (is_as_it_was) return std::nullopt;
  return TargetDeltas{of_parts(shading, all), 0};
}

TargetDeltas ChosenForm::extra_deltas(const GltfShading& shading, std::size_t extra) const {
  std::vector<float> all(shading.normals.size());
  const auto& [vertices, vectors] = extras_[extra];
  for (std::size_t n = 0; n < vertices.size(); ++n) set_vector(all, vertices[n], vectors[n]);
  return {of_parts(shading, all), 0};
}

ChosenForm choose_of_lengths(const DeltaSource& source, const MeshWeights& weights, const BakeOptions& options,
                             FormLengths lengths) {
  const GltfShading& shading = source.shading;
  const RightNormals rights(shading, source.terms, source.base_normals, source.plan.largest);
  const std::span<const Host> hosts = options.hosts;
  const std::size_t targets = shading.set.targets.size();
  const double tolerance = options.tolerance.value_or(kHarmlessTolerance);
  const HarmlessLimits limits{lengths, most_extras(options, targets), tolerance};

  ChosenForm result;
  const std::vector<VertexVectors> stored = stored_deltas(shading);
  result.vertices_ = judged_vertices(source, stored);
  const std::vector<std::uint32_t>& vertices = result.vertices_;
  const std::vector<bool> is_new = new_bases(source);
  const HostJudge judge(rights, vertices, shading.element_of_vertex, is_new, hosts,
                        std::vector<bool>(hosts.size(), true), tolerance);

  HarmlessForm form = end_point_form(shading, source.terms, rights, limits.lengths);
  std::vector<VertexColumns> forms = {by_vertex(columns_of(stored), vertices),
                                      by_vertex(columns_of(form.own), vertices)};
  if ((source.plan.is_driven || weights.rig) && source.plan.products_fit) {
    const std::size_t enough = enough_poses(shading, forms);
    const PoseList samples =
        weights.rig ? weights.rig->sample(enough, kRigSeed) : weights.use.samples_with_keys(enough);
    add_corrections(shading, source.terms, rights, samples, vertices, judge.worst(forms[1], samples), limits, form);
  }
  result.left_out = form.left_out;
  const std::vector<const VertexVectors*> all = columns_of(form.own, form.extras);
  std::vector<const VertexVectors*> of_one = all;
  const VertexVectors none;
  for (std::size_t k = 0; k < form.extras.size(); ++k)
    if (!is_of_one(form.weights[k])) of_one[targets + k] = &none;
  forms.push_back(by_vertex(of_one, vertices));
  forms.push_back(by_vertex(all, vertices));
  ExtraDrivers& drivers = result.drivers;
  drivers.formulas = std::move(form.weights);
  cut_tracks(rights, weights, hosts, vertices, forms.back(), kPartOfTracks * tolerance / kDegreesPerRadian, drivers,
             result.track_error);
  const auto numbers = numbers_of_targets(source, stored, vertices);
  const auto sets = [&](const Sampling& sampling) {
    return pose_sets(shading, weights, drivers, hosts, numbers, sampling);
  };
  const std::size_t most = enough_poses(shading, forms);
  result.choice_ = judge.choose(forms, sets({4, most, 0, kFirstSeed}), FormPreference::kNearest);
  result.hosts = judge.settle(forms, sets({3, most, 0.37, kSecondSeed}), result.choice_);
  drop_unused(vertices, result.choice_, form, drivers);
  result.kept = kept_elements(shading, vertices, result.choice_);
  result.extras_ = std::move(form.extras);
  result.own_of_form_.push_back(std::move(form.own));
  return result;
}

ChosenForm choose_harmless(const DeltaSource& source, const MeshWeights& weights, const BakeOptions& options) {
  const FormLengths lengths = lengths_for(options.hosts);
  if (lengths != FormLengths::kOpposite) return choose_of_lengths(source, weights, options, lengths);
  ChosenForm unit = choose_of_lengths(source, weights, options, FormLengths::kUnit);
  if (unit.drivers.size() == 0) return unit;
  ChosenForm opposite = choose_of_lengths(source, weights, options, FormLengths::kOpposite);
  const auto error = [](const ChosenForm& form) {
    double sum = 0;
    for (const HostChange& host : form.hosts) sum += host.poses[0].after.mean;
    return sum;
  };
  return error(opposite) < kBetterByFar * error(unit) ? opposite : unit;
}

ChosenForm choose_endpoint(const DeltaSource& source, const MeshWeights& weights, const BakeOptions& options) {
  const GltfShading& shading = source.shading;
  const RightNormals rights(shading, source.terms, source.base_normals, source.plan.largest);
  std::vector<bool> is_binding;
  for (const Host& host : options.hosts) is_binding.push_back(host.normals == NormalRule::kSum);

  ChosenForm result;
  const std::vector<VertexVectors> stored = stored_deltas(shading);
  result.vertices_ = judged_vertices(source, stored);
  const std::vector<std::uint32_t>& vertices = result.vertices_;
  MeshPlan plan_of_alone = source.plan;
  plan_of_alone.lines = FittedLines();
  const DeltaSource alone{shading, source.terms, plan_of_alone, source.base_normals};
  result.own_of_form_.push_back(endpoint_deltas(alone, result.fit_error));
  if (source.plan.lines.elements() > 0) {
    result.fit_error = 0;
    result.own_of_form_.push_back(endpoint_deltas(source, result.fit_error));
  }
  result.fit_error = std::fmax(result.fit_error, source.plan.lines.largest_error());
  std::vector<VertexColumns> forms = {by_vertex(columns_of(stored), vertices)};
  for (const std::vector<VertexVectors>& own : result.own_of_form_)
    forms.push_back(by_vertex(columns_of(own), vertices));

  const std::vector<bool> is_new = new_bases(source);
  // Keys of a file whose author is known may be right as they are: then no tolerance lets one be turned.
  const double tolerance = rights.are_by_area() ? options.tolerance.value_or(kHarmlessTolerance) : kHarmless;
  const HostJudge judge(rights, vertices, shading.element_of_vertex, is_new, options.hosts, is_binding, tolerance);
  const std::size_t most = enough_poses(shading, forms);
  const auto numbers = numbers_of_targets(source, stored, vertices);
  const auto sets = [&](const Sampling& sampling) {
    return pose_sets(shading, weights, {}, options.hosts, numbers, sampling);
  };
  result.choice_ = judge.choose(forms, sets({4, most, 0, kFirstSeed}), FormPreference::kLast);
  result.hosts = judge.settle(forms, sets({3, most, 0.37, kSecondSeed}), result.choice_);
  result.kept = kept_elements(shading, vertices, result.choice_);
  const bool is_last_form = std::all_of(result.choice_.begin(), result.choice_.end(),
                                        [&](std::uint8_t form) { return form == result.own_of_form_.size(); });
  if (is_last_form) return result;
  // Nothing is known of the rest but what was measured.
  result.fit_error = 0;
  for (std::size_t h = 0; h < result.hosts.size(); ++h)
    if (is_binding[h])
      result.fit_error = std::fmax(result.fit_error, result.hosts[h].poses[0].after.worst / kDegreesPerRadian);
  return result;
}

}  // namespace chronormal::inline internal
