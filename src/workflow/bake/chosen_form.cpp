// The poses that a form is chosen by are others than those that it is settled at: what holds at both will hold between
// them. Weights of extra targets between keys are what hosts play of the tracks as they will be written.
#include "workflow/bake/chosen_form.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

#include "core/blocks.h"
#include "workflow/bake/harmless_form.h"
#include "workflow/bake/played_poses.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kMostPieces = 16, kMostKeys = 20000;
// Of the tolerance: what straight pieces may leave of it.
constexpr double kPartOfTracks = 0.25;
// Poses, as many as these numbers of deltas added up allow.
constexpr double kSums = 1.2e9;
constexpr std::size_t kLeastPoses = 32, kMostPoses = 1500;
constexpr std::size_t kFewestSteps = 3, kMostSteps = 16, kFewestMixed = 8, kMostMixed = 96, kPartOfMixed = 4;
constexpr unsigned kFirstSeed = 1, kSecondSeed = 2;

std::vector<std::size_t> changing_targets(const GltfShading& shading) {
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < shading.set.targets.size(); ++i)
    if (!shading.set.targets[i].vertices.empty() || shading.turns[i]) result.push_back(i);
  return result;
}

// What the file stores, other than zero.
std::vector<VertexVectors> stored_deltas(const GltfShading& shading) {
  std::vector<VertexVectors> result(shading.normal_deltas.size());
  for (std::size_t k = 0; k < result.size(); ++k) {
    const std::vector<float>& deltas = shading.normal_deltas[k];
    for (std::size_t v = 0; 3 * v < deltas.size(); ++v) {
      const Vec3f delta = {deltas[3 * v], deltas[3 * v + 1], deltas[3 * v + 2]};
      if (shading.element_of_vertex[v] == GltfShading::kNoElement || delta == Vec3f{}) continue;
      result[k].vertices.push_back(static_cast<std::uint32_t>(v));
      result[k].vectors.push_back(delta);
    }
  }
  return result;
}

// The vertices whose normal a target may turn: by its faces, or by what is stored.
std::vector<std::uint32_t> judged_vertices(const DeltaSource& source, const std::vector<VertexVectors>& stored) {
  const GltfShading& shading = source.shading;
  std::vector<bool> element_moves(shading.groups.size(), false), is_judged(shading.element_of_vertex.size(), false);
  for (std::size_t i = 0; i < shading.set.targets.size(); ++i) {
    if (!moves(shading, i)) continue;
    for (const std::uint32_t e : source.terms.elements(i)) element_moves[e] = true;
  }
  for (const VertexVectors& column : stored)
    for (const std::uint32_t v : column.vertices) is_judged[v] = true;
  std::vector<std::uint32_t> result;
  for (std::uint32_t v = 0; v < is_judged.size(); ++v) {
    const std::uint32_t e = shading.element_of_vertex[v];
    if (e != GltfShading::kNoElement && (is_judged[v] || element_moves[e])) result.push_back(v);
  }
  return result;
}

std::vector<bool> new_bases(const DeltaSource& source) {
  std::vector<bool> result(source.shading.element_of_vertex.size(), false);
  for (std::size_t i = 0; i < source.base_normals.size(); ++i)
    if (source.base_normals[i] != source.shading.normals[i]) result[i / 3] = true;
  return result;
}

std::vector<const VertexVectors*> columns_of(const std::vector<VertexVectors>& own,
                                             const std::vector<VertexVectors>& extras = {}) {
  std::vector<const VertexVectors*> result;
  for (const VertexVectors& column : own) result.push_back(&column);
  for (const VertexVectors& column : extras) result.push_back(&column);
  return result;
}

std::size_t most_extras(std::span<const Host> hosts, std::size_t targets) {
  std::size_t most = 10000;
  for (const Host& host : hosts)
    if (host.most_targets > 0) most = std::min(most, host.most_targets - std::min(host.most_targets, targets));
  return most;
}

bool is_free_of_limits(std::span<const Host> hosts) {
  return std::all_of(hosts.begin(), hosts.end(), [](const Host& host) { return host.normals == NormalRule::kSum; });
}

// Whether two hosts play these tracks alike.
bool plays_alike(const Host& a, const Host& b, std::span<const WeightTrack> tracks) {
  if (a.tracks == b.tracks && a.weight_bits == b.weight_bits) return true;
  return std::all_of(tracks.begin(), tracks.end(), [&](const WeightTrack& track) {
    const auto is_as_specified = [&](const Host& host) {
      return PlayedTrack(host, track.keys, track.interpolation, track.targets, {}).is_as_specified();
    };
    return is_as_specified(a) && is_as_specified(b);
  });
}

// How the poses of one look at a form are taken.
struct Sampling {
  std::size_t between_keys = 4, most = kMostPoses;
  double phase = 0;
  unsigned seed = kFirstSeed;
};

std::vector<PoseSet> pose_sets(const GltfShading& shading, const MeshWeights& weights,
                               std::span<const DrivingTrack> tracks, std::span<const ExtraWeight> extras,
                               std::span<const Host> hosts, const Sampling& sampling) {
  const std::size_t targets = shading.set.targets.size();
  std::vector<std::size_t> all(hosts.size());
  for (std::size_t h = 0; h < all.size(); ++h) all[h] = h;
  std::vector<PoseSet> sets;
  std::vector<WeightTrack> of_tracks;
  for (const DrivingTrack& driving : tracks) of_tracks.push_back(driving.track);
  for (std::size_t h = 0; h < hosts.size() && !tracks.empty(); ++h) {
    const auto like_me = [&](const PoseSet& set) { return plays_alike(hosts[set.hosts[0]], hosts[h], of_tracks); };
    const auto found = std::find_if(sets.begin(), sets.end(), like_me);
    if (found != sets.end()) {
      found->hosts.push_back(h);
      continue;
    }
    PoseSet& set = sets.emplace_back();
    set.hosts = {h};
    for (const DrivingTrack& driving : tracks)
      add_played_poses(driving, hosts[h], sampling.between_keys, sampling.phase,
                       std::max<std::size_t>(2, sampling.most / tracks.size()), set.poses);
  }
  const std::vector<std::size_t> changing = changing_targets(shading);
  const std::size_t steps = std::clamp(sampling.most / (changing.size() + 1), kFewestSteps, kMostSteps);
  PoseSet& still = sets.emplace_back();
  still.hosts = all;
  for (const std::vector<double>& pose : weights.poses) still.poses.push_back(with_extras(pose, extras));
  for (std::vector<double>& pose : alone_poses(changing, targets, extras, steps, sampling.phase))
    still.poses.push_back(std::move(pose));
  const std::size_t mixed = std::clamp(sampling.most / kPartOfMixed, kFewestMixed, kMostMixed);
  sets.push_back({PoseSet::Kind::kRandom, all, random_poses(changing, targets, extras, mixed, sampling.seed)});
  sets.push_back({PoseSet::Kind::kFades, all, cross_fades(tracks, mixed, sampling.seed)});
  return sets;
}

// Where the straight line of an extra weight between two keys is farthest from what it should be, in the middle, it is
// off by a quarter of its second difference; this is what that turns.
double middle_error(const RightNormals& rights, const WeightTrack& track, const HarmlessForm& form,
                    std::span<const std::uint32_t> vertices, const VertexColumns& columns,
                    std::vector<double>& of_gaps) {
  PoseList middles;
  std::vector<std::vector<double>> lack;
  for (std::size_t key = 0; key + 1 < track.size(); ++key) {
    std::vector<double> from(track.targets), to(track.targets), middle(track.targets);
    for (std::size_t i = 0; i < track.targets; ++i) {
      from[i] = track.value(key, i);
      to[i] = track.value(key + 1, i);
      middle[i] = (from[i] + to[i]) / 2;
    }
    const std::vector<double> at_start = with_extras(from, form.weights), at_end = with_extras(to, form.weights);
    middles.push_back(with_extras(middle, form.weights));
    std::vector<double>& missing = lack.emplace_back(middles.back().size(), 0.0);
    for (std::size_t c = track.targets; c < missing.size(); ++c)
      missing[c] = (at_start[c] + at_end[c]) / 2 - middles.back()[c];
  }
  std::vector<std::atomic<float>> worst(middles.size());
  rights.for_each(vertices, middles, [&](std::size_t n, std::size_t first, std::span<const Vec3f> right) {
    const Vec3d stored = rights.stored(vertices[n]);
    for (std::size_t p = 0; p < right.size(); ++p) {
      if (right[p] == Vec3f{}) continue;
      Vec3d shown = stored, off;
      for (const auto& [column, delta] : columns.of(n)) {
        const double w = middles[first + p][column], q = lack[first + p][column];
        if (w != 0) shown = shown + w * to_double(delta);
        if (q != 0) off = off + q * to_double(delta);
      }
      if (off == Vec3d{}) continue;
      const auto angle = static_cast<float>(angle_between(shown, shown + off));
      std::atomic<float>& most = worst[first + p];
      for (float known = most; known < angle && !most.compare_exchange_weak(known, angle);) continue;
    }
  });
  of_gaps.assign(worst.begin(), worst.end());
  return of_gaps.empty() ? 0 : *std::max_element(of_gaps.begin(), of_gaps.end());
}

// Cuts the gaps of a track until straight pieces are near enough, and says what they leave.
std::vector<std::uint32_t> pieces_of(const RightNormals& rights, const WeightTrack& track, const HarmlessForm& form,
                                     std::span<const std::uint32_t> vertices, const VertexColumns& columns,
                                     double tolerance, double& left) {
  std::vector<double> of_gaps;
  (void)middle_error(rights, track, form, vertices, columns, of_gaps);
  const double most = std::clamp(static_cast<double>(kMostKeys) / static_cast<double>(track.size()), 1.0,
                                 static_cast<double>(kMostPieces));
  std::vector<std::uint32_t> pieces;
  for (const double error : of_gaps) {
    const double count = std::clamp(std::ceil(std::sqrt(error / tolerance)), 1.0, std::floor(most));
    pieces.push_back(static_cast<std::uint32_t>(count));
    left = std::fmax(left, error / (count * count));
  }
  return pieces;
}

// The tracks of a mesh as they will be written.
std::vector<DrivingTrack> written_tracks(const MeshWeights& weights, std::span<const ExtraWeight> extras,
                                         const TrackPieces& pieces) {
  std::vector<DrivingTrack> result;
  for (std::size_t t = 0; t < weights.tracks.size(); ++t) {
    const WeightTrack& track = weights.tracks[t];
    const auto cut = pieces.find(weights.names[t]);
    const ExtendedTrack extended = cut != pieces.end()
                                       ? straight_track(track, extras, cut->second)
                                       : extended_track(track, extras, std::numeric_limits<double>::infinity());
    result.push_back({as_track(track, extended, extras.size()), weights.ranges[t]});
  }
  return result;
}

// How many poses may be looked at.
std::size_t enough_poses(const GltfShading& shading, std::span<const VertexColumns> forms) {
  constexpr std::size_t kOfVertex = 10, kOfCorner = 6;
  std::size_t of_pose = 1 + kOfCorner * shading.set.topology.corner_count();
  for (const VertexColumns& form : forms) of_pose += kOfVertex * form.first.size() + form.entries.size();
  return std::clamp(static_cast<std::size_t>(kSums / static_cast<double>(of_pose)), kLeastPoses, kMostPoses);
}

// The forms with extra targets: those of each target alone, or all.
enum Choice : std::uint8_t { kStored, kEnds, kSelf, kAll };

bool is_of_one(const ExtraWeight& weight) { return weight.i == weight.j; }

// Keeps of the extra targets those that some vertex takes part in.
void drop_unused(std::span<const std::uint32_t> vertices, std::span<const std::uint8_t> choice, HarmlessForm& form) {
  std::size_t kept = 0;
  for (std::size_t k = 0; k < form.extras.size(); ++k) {
    VertexVectors used;
    const VertexVectors& all = form.extras[k];
    for (std::size_t n = 0, at = 0; n < all.vertices.size(); ++n) {
      while (vertices[at] < all.vertices[n]) ++at;
      if (choice[at] != kAll && !(choice[at] == kSelf && is_of_one(form.weights[k]))) continue;
      used.vertices.push_back(all.vertices[n]);
      used.vectors.push_back(all.vectors[n]);
    }
    if (used.vertices.empty()) continue;
    form.extras[kept] = std::move(used);
    form.weights[kept++] = form.weights[k];
  }
  form.extras.resize(kept);
  form.weights.resize(kept);
}

std::size_t kept_elements(const GltfShading& shading, std::span<const std::uint32_t> vertices,
                          std::span<const std::uint8_t> choice) {
  std::vector<bool> is_kept(shading.groups.size(), false);
  for (std::size_t n = 0; n < vertices.size(); ++n)
    if (choice[n] == 0) is_kept[shading.element_of_vertex[vertices[n]]] = true;
  return static_cast<std::size_t>(std::count(is_kept.begin(), is_kept.end(), true));
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

// The deltas of all targets, and the largest error that they are stated with.
std::vector<VertexVectors> endpoint_deltas(const DeltaSource& source, double& error) {
  std::vector<VertexVectors> result(source.shading.set.targets.size());
  for (std::size_t i = 0; i < result.size(); ++i) {
    const TargetDeltas deltas = own_target_deltas(source, i);
    error = std::fmax(error, deltas.error);
    for (std::size_t p = 0; p < deltas.of_parts.size(); ++p) {
      const std::vector<float>& all = deltas.of_parts[p];
      for (std::size_t v = 0; 3 * v < all.size(); ++v) {
        const Vec3f delta = {all[3 * v], all[3 * v + 1], all[3 * v + 2]};
        if (delta == Vec3f{}) continue;
        result[i].vertices.push_back(static_cast<std::uint32_t>(source.shading.parts[p].first_vertex + v));
        result[i].vectors.push_back(delta);
      }
    }
  }
  return result;
}

}  // namespace

const std::vector<VertexVectors>& ChosenForm::own_of(std::uint8_t form) const {
  return own_of_form_[std::min<std::size_t>(form, own_of_form_.size()) - 1];
}

bool ChosenForm::changes(const GltfShading& shading) const {
  if (!weights.empty()) return true;
  for (std::size_t i = 0; i < shading.set.targets.size(); ++i)
    if (own_deltas(shading, i)) return true;
  return false;
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

ChosenForm choose_harmless(const DeltaSource& source, const MeshWeights& weights, const BakeOptions& options) {
  const GltfShading& shading = source.shading;
  const RightNormals rights(shading, source.terms, source.base_normals, source.plan.largest);
  const std::span<const Host> hosts = options.hosts;
  const std::size_t targets = shading.set.targets.size();
  const double tolerance = options.tolerance.value_or(kHarmlessTolerance);
  const HarmlessLimits limits{is_free_of_limits(hosts), most_extras(hosts, targets), tolerance};

  ChosenForm result;
  const std::vector<VertexVectors> stored = stored_deltas(shading);
  result.vertices_ = judged_vertices(source, stored);
  const std::vector<std::uint32_t>& vertices = result.vertices_;
  const std::vector<bool> is_new = new_bases(source);
  const HostJudge judge(rights, vertices, shading.element_of_vertex, is_new, hosts,
                        std::vector<bool>(hosts.size(), true), tolerance);

  HarmlessForm form = end_point_form(shading, source.terms, rights, limits.has_free_lengths);
  std::vector<VertexColumns> forms = {by_vertex(columns_of(stored), vertices),
                                      by_vertex(columns_of(form.own), vertices)};
  if (source.plan.is_driven && source.plan.products_fit) {
    const PoseList samples = weights.use.samples_with_keys(enough_poses(shading, forms));
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
  for (std::size_t t = 0; t < weights.tracks.size() && !form.extras.empty(); ++t) {
    if (weights.tracks[t].interpolation != GltfInterpolation::kLinear) continue;
    result.pieces[weights.names[t]] = pieces_of(rights, weights.tracks[t], form, vertices, forms[2],
                                                kPartOfTracks * tolerance / kDegreesPerRadian, result.track_error);
  }
  const auto sets = [&](const Sampling& sampling) {
    return pose_sets(shading, weights, written_tracks(weights, form.weights, result.pieces), form.weights, hosts,
                     sampling);
  };
  const std::size_t most = enough_poses(shading, forms);
  result.choice_ = judge.choose(forms, sets({4, most, 0, kFirstSeed}), false);
  result.hosts = judge.settle(forms, sets({3, most, 0.37, kSecondSeed}), result.choice_);
  drop_unused(vertices, result.choice_, form);
  result.kept = kept_elements(shading, vertices, result.choice_);
  result.weights = std::move(form.weights);
  result.extras_ = std::move(form.extras);
  result.own_of_form_.push_back(std::move(form.own));
  return result;
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
  const HostJudge judge(rights, vertices, shading.element_of_vertex, is_new, options.hosts, is_binding,
                        options.tolerance.value_or(kHarmlessTolerance));
  const std::size_t most = enough_poses(shading, forms);
  const std::vector<DrivingTrack> tracks = written_tracks(weights, {}, {});
  const auto sets = [&](const Sampling& sampling) {
    return pose_sets(shading, weights, tracks, {}, options.hosts, sampling);
  };
  result.choice_ = judge.choose(forms, sets({4, most, 0, kFirstSeed}), true);
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
