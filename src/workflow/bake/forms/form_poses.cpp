// The poses are those that hosts play of the tracks as they will be written, and what a program may mix of them.
#include "workflow/bake/forms/form_poses.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

#include "core/blocks.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kMostPieces = 16, kMostKeys = 20000;
// Of what straight pieces may leave: what cubics may, whose bound is the sum of all that might be off at once.
constexpr double kPartOfSplines = 2;
// Poses, as many as these numbers of deltas added up allow.
constexpr double kSums = 1e9;
constexpr std::size_t kLeastPoses = 12, kMostPoses = 1500;
// Weights of poses that are held: of files with thousands of targets, not all are looked at alone.
constexpr std::size_t kMostWeights = 8000000;
constexpr std::size_t kFewestSteps = 3, kMostSteps = 16, kFewestMixed = 8, kMostMixed = 96, kPartOfMixed = 4;

std::vector<std::size_t> changing_targets(const GltfShading& shading) {
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < shading.set.targets.size(); ++i)
    if (!shading.set.targets[i].vertices.empty() || shading.turns[i]) result.push_back(i);
  return result;
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

// The tracks of a mesh as they will be written.
std::vector<DrivingTrack> written_tracks(const MeshWeights& weights, const ExtraDrivers& extras) {
  std::vector<DrivingTrack> result;
  for (std::size_t t = 0; t < weights.tracks.size(); ++t) {
    const WeightTrack& track = weights.tracks[t];
    const ExtendedTrack extended = extras.extended(weights.names[t], track, std::numeric_limits<double>::infinity());
    result.push_back({as_track(track, extended, extras.size()), weights.ranges[t]});
  }
  return result;
}

// Where the straight line of an extra weight between two keys is farthest from what it should be, in the middle, it is
// off by a quarter of its second difference; this is what that turns, in radians, for each gap.
std::vector<double> middle_errors(const RightNormals& rights, const WeightTrack& track, std::size_t extra_count,
                                  const ExtrasAt& extras_at, std::span<const std::uint32_t> vertices,
                                  const VertexColumns& columns) {
  PoseList middles;
  std::vector<std::vector<double>> lack;
  const auto pose_at = [&](std::size_t key, double part) {
    std::vector<double> pose(track.targets);
    for (std::size_t i = 0; i < track.targets; ++i)
      pose[i] = (1 - part) * track.value(key, i) + part * track.value(key + 1, i);
    std::vector<double> extras(extra_count);
    extras_at(key, part, pose, extras);
    pose.insert(pose.end(), extras.begin(), extras.end());
    return pose;
  };
  for (std::size_t key = 0; key + 1 < track.size(); ++key) {
    const std::vector<double> at_start = pose_at(key, 0), at_end = pose_at(key, 1);
    middles.push_back(pose_at(key, 0.5));
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
  return {worst.begin(), worst.end()};
}

// Cuts the gaps of a LINEAR track until straight pieces of extra weights turn no normal by more than the tolerance
// (radians), as far as a limit of pieces allows; `left` becomes no less than what they turn.
std::vector<std::uint32_t> pieces_of(const RightNormals& rights, const WeightTrack& track, std::size_t extra_count,
                                     const ExtrasAt& extras_at, std::span<const std::uint32_t> vertices,
                                     const VertexColumns& columns, double tolerance, double& left) {
  const std::vector<double> of_gaps = middle_errors(rights, track, extra_count, extras_at, vertices, columns);
  // No gap gets more pieces than all of them may have.
  for (std::size_t most = kMostPieces;; --most) {
    std::vector<std::uint32_t> pieces;
    std::size_t keys = 1;
    double of_pieces = 0;
    for (const double error : of_gaps) {
      const double count = std::clamp(std::ceil(std::sqrt(error / tolerance)), 1.0, static_cast<double>(most));
      pieces.push_back(static_cast<std::uint32_t>(count));
      keys += pieces.back();
      of_pieces = std::fmax(of_pieces, error / (count * count));
    }
    if (most > 1 && keys > std::max(kMostKeys, track.size())) continue;
    left = std::fmax(left, of_pieces);
    return pieces;
  }
}

// Says of each formula how far a normal turns, at most, where its weight is off by 1 and the normal is as long as the
// stored one.
void set_gains(const RightNormals& rights, std::span<const std::uint32_t> vertices, const VertexColumns& columns,
               ExtraDrivers& drivers) {
  const std::size_t own = rights.targets();
  for (ExtraWeight& formula : drivers.formulas) formula.gain = 0;
  for (std::size_t n = 0; n < vertices.size(); ++n) {
    const double size = length(rights.stored(vertices[n]));
    for (const auto& [column, delta] : columns.of(n)) {
      if (column < own || !(size > 0)) continue;
      double& gain = drivers.formulas[column - own].gain;
      gain = std::fmax(gain, length(to_double(delta)) / size);
    }
  }
}

}  // namespace

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

VertexVectors as_column(const GltfShading& shading, const TargetDeltas& deltas) {
  VertexVectors result;
  for (std::size_t p = 0; p < deltas.of_parts.size(); ++p) {
    const std::vector<float>& all = deltas.of_parts[p];
    for (std::size_t v = 0; 3 * v < all.size(); ++v) {
      const Vec3f delta = {all[3 * v], all[3 * v + 1], all[3 * v + 2]};
      if (delta == Vec3f{}) continue;
      result.vertices.push_back(static_cast<std::uint32_t>(shading.parts[p].first_vertex + v));
      result.vectors.push_back(delta);
    }
  }
  return result;
}

std::vector<VertexVectors> endpoint_deltas(const DeltaSource& source, double& error) {
  std::vector<VertexVectors> result(source.shading.set.targets.size());
  for (std::size_t i = 0; i < result.size(); ++i) {
    const TargetDeltas deltas = own_target_deltas(source, i);
    error = std::fmax(error, deltas.error);
    result[i] = as_column(source.shading, deltas);
  }
  return result;
}

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

std::vector<std::vector<std::uint32_t>> numbers_of_targets(const DeltaSource& source,
                                                           const std::vector<VertexVectors>& stored,
                                                           std::span<const std::uint32_t> vertices) {
  const GltfShading& shading = source.shading;
  std::vector<std::vector<std::uint32_t>> result(shading.set.targets.size());
  for (std::size_t i = 0; i < result.size(); ++i) {
    std::vector<bool> element_moves(shading.groups.size(), false);
    if (moves(shading, i))
      for (const std::uint32_t e : source.terms.elements(i)) element_moves[e] = true;
    for (std::uint32_t n = 0; n < vertices.size(); ++n) {
      const bool is_turned = element_moves[shading.element_of_vertex[vertices[n]]];
      if (is_turned || stored[i].at(vertices[n]) != Vec3f{}) result[i].push_back(n);
    }
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
                                             const std::vector<VertexVectors>& extras) {
  std::vector<const VertexVectors*> result;
  result.reserve(own.size() + extras.size());
  for (const VertexVectors& column : own) result.push_back(&column);
  for (const VertexVectors& column : extras) result.push_back(&column);
  return result;
}

std::size_t most_extras(const BakeOptions& options, std::size_t targets) {
  std::size_t most = 10000;
  const auto limit = [&](std::size_t all) { most = std::min(most, all - std::min(all, targets)); };
  for (const Host& host : options.hosts)
    if (host.most_targets > 0) limit(host.most_targets);
  if (options.most_targets) limit(*options.most_targets);
  return most;
}

FormLengths lengths_for(std::span<const Host> hosts) {
  const auto adds_up = [](const Host& host) { return host.normals == NormalRule::kSum; };
  const auto keeps_weights = [](const Host& host) { return host.weight_bits == 32; };
  if (std::all_of(hosts.begin(), hosts.end(), adds_up)) return FormLengths::kFree;
  return std::all_of(hosts.begin(), hosts.end(), keeps_weights) ? FormLengths::kOpposite : FormLengths::kUnit;
}

std::vector<PoseSet> pose_sets(const GltfShading& shading, const MeshWeights& weights, const ExtraDrivers& extras,
                               std::span<const Host> hosts, std::span<const std::vector<std::uint32_t>> numbers,
                               const Sampling& sampling) {
  const std::vector<DrivingTrack> tracks = written_tracks(weights, extras);
  const std::size_t targets = shading.set.targets.size();
  std::vector<std::size_t> all(hosts.size());
  for (std::size_t h = 0; h < all.size(); ++h) all[h] = h;
  std::vector<PoseSet> sets;
  std::vector<WeightTrack> of_tracks;
  of_tracks.reserve(tracks.size());
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
    set.poses = seen_tracks(tracks, weights.skins, hosts[h], sampling.between_keys, sampling.phase, sampling.most);
  }
  const MeshSkin* const skin = weights.skins.as_standing();
  sets.push_back({PoseSet::Kind::kFile, all, seen_through(extras.standing(weights.poses), skin)});
  if (sampling.animations_only) return sets;
  const std::vector<std::size_t> changing = changing_targets(shading);
  const std::size_t steps = std::clamp(sampling.most / (changing.size() + 1), kFewestSteps, kMostSteps);
  const std::size_t room = std::max<std::size_t>(1, kMostWeights / (steps * (targets + extras.size() + 1)));
  const std::size_t count = std::min(changing.size(), room);
  for (std::size_t n = 0; n < count; ++n) {
    const std::size_t i = changing[n * changing.size() / count];
    if (!numbers[i].empty())
      sets.push_back({PoseSet::Kind::kFile, all,
                      seen_through(alone_poses({&i, 1}, targets, extras, steps, sampling.phase), skin), numbers[i]});
  }
  const std::size_t mixed = std::clamp(sampling.most / kPartOfMixed, kFewestMixed, kMostMixed);
  PoseList random;
  if (weights.rig) {
    for (std::vector<double>& pose : weights.rig->sample(mixed, sampling.seed))
      random.push_back(extras.with_extras(std::move(pose)));
  } else {
    random = random_poses(changing, targets, extras, mixed, sampling.seed);
  }
  sets.push_back({PoseSet::Kind::kRandom, all, seen_through(std::move(random), skin), {}});
  sets.push_back({PoseSet::Kind::kFades, all, seen_through(cross_fades(tracks, mixed, sampling.seed), skin), {}});
  return sets;
}

void cut_tracks(const RightNormals& rights, const MeshWeights& weights, std::span<const Host> hosts,
                std::span<const std::uint32_t> vertices, const VertexColumns& columns, double tolerance,
                ExtraDrivers& drivers, double& left) {
  const bool play_splines = std::all_of(hosts.begin(), hosts.end(), [](const Host& host) {
    return host.tracks == TrackRule::kSpecified && host.weight_bits == 32;
  });
  const std::size_t extras = drivers.size();
  for (std::size_t t = 0; t < weights.tracks.size() && extras > 0; ++t) {
    const WeightTrack& track = weights.tracks[t];
    if (track.interpolation == GltfInterpolation::kCubicSpline && track.size() > 1 && play_splines) {
      set_gains(rights, vertices, columns, drivers);
      drivers.spline_tolerance = kPartOfSplines * tolerance;
    }
    if (track.interpolation != GltfInterpolation::kLinear || track.size() < 2) continue;
    const auto curve = drivers.curves.find(weights.names[t]);
    const CurveNodes nodes(track);
    const auto extras_at = [&](std::size_t key, double part, std::span<const double> own, std::span<double> of_extras) {
      if (curve != drivers.curves.end()) return curve->second.at(nodes, key, part, of_extras);
      for (std::size_t k = 0; k < extras; ++k)
        of_extras[k] = drivers.formulas[k].at(own[drivers.formulas[k].i], own[drivers.formulas[k].j]);
    };
    double of_pieces = 0;
    std::vector<std::uint32_t> pieces =
        pieces_of(rights, track, extras, extras_at, vertices, columns, tolerance, of_pieces);
    std::size_t keys = 1;
    for (const std::uint32_t count : pieces) keys += count;
    const std::size_t in_key = track.targets + extras;
    const bool are_fewer = keys * (in_key + 1) <= 3 * track.size() * in_key;
    if (play_splines && (!are_fewer || of_pieces > tolerance)) continue;
    drivers.pieces[weights.names[t]] = std::move(pieces);
    left = std::fmax(left, of_pieces);
  }
}

std::size_t enough_poses(const GltfShading& shading, std::span<const VertexColumns> forms) {
  constexpr std::size_t kOfVertex = 10, kOfCorner = 6;
  std::size_t of_pose = 1 + kOfCorner * shading.set.topology.corner_count();
  for (const VertexColumns& form : forms) of_pose += kOfVertex * form.first.size() + form.entries.size();
  const std::size_t most = std::min(kMostPoses, kMostWeights / (1 + shading.set.targets.size()));
  return std::clamp(static_cast<std::size_t>(kSums / static_cast<double>(of_pose)), kLeastPoses,
                    std::max(kLeastPoses, most));
}

std::size_t kept_elements(const GltfShading& shading, std::span<const std::uint32_t> vertices,
                          std::span<const std::uint8_t> choice) {
  std::vector<bool> is_kept(shading.groups.size(), false);
  for (std::size_t n = 0; n < vertices.size(); ++n)
    if (choice[n] == 0) is_kept[shading.element_of_vertex[vertices[n]]] = true;
  return static_cast<std::size_t>(std::count(is_kept.begin(), is_kept.end(), true));
}

}  // namespace chronormal::inline internal
