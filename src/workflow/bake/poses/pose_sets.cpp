#include "workflow/bake/poses/pose_sets.h"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

namespace chronormal::inline internal {
namespace {

// kMostWeights is the largest number of weights that all poses together may have in memory, so only some targets of a
// file with thousands of targets are judged alone. The other constants limit the number of weights at which a target is
// judged alone.
constexpr std::size_t kMostWeights = 8000000, kMostSteps = 8, kFewestSteps = 2;
constexpr unsigned kRigSeed = 3;

// Returns true if two viewers play the same weights from these tracks.
bool plays_alike(const Viewer& a, const Viewer& b, std::span<const WeightTrack> tracks) {
  if (a.tracks == b.tracks && a.weight_bits == b.weight_bits && a.least_weight == b.least_weight) return true;
  return std::all_of(tracks.begin(), tracks.end(), [&](const WeightTrack& track) {
    const auto is_as_specified = [&](const Viewer& viewer) {
      return PlayedTrack(viewer, track.keys, track.interpolation, track.targets, {}).is_as_specified();
    };
    return is_as_specified(a) && is_as_specified(b);
  });
}

PlayedPose standing_pose(std::vector<double> weights, const MeshSkin* skin, std::size_t number = PlayedPose::kNone) {
  PlayedPose pose;
  pose.seen = {std::move(weights), skin, 0};
  pose.standing = number;
  return pose;
}

}  // namespace

std::vector<PoseSet> pose_sets(const MeshWeights& weights, std::span<const Viewer> viewers,
                               std::span<const std::vector<std::uint32_t>> numbers, std::size_t most,
                               bool animations_only) {
  std::vector<std::size_t> all(viewers.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  std::vector<PoseSet> sets;
  for (std::size_t h = 0; h < viewers.size() && !weights.tracks.empty(); ++h) {
    const auto like_me = [&](const PoseSet& set) {
      return plays_alike(viewers[set.viewers[0]], viewers[h], weights.tracks);
    };
    const auto found = std::find_if(sets.begin(), sets.end(), like_me);
    if (found != sets.end())
      found->viewers.push_back(h);
    else
      sets.push_back({PoseKind::kFile, {h}, played_tracks(weights, viewers[h], most)});
  }
  const MeshSkin* const skin = weights.skins.as_standing();
  PoseSet standing{PoseKind::kFile, all, {}};
  const std::size_t room = std::min(most, weights.poses.size());
  for (std::size_t n = 0; n < room; ++n) standing.poses.push_back(standing_pose(weights.poses[n], skin, n));
  if (!standing.poses.empty()) sets.push_back(std::move(standing));
  std::vector<std::size_t> turning;
  for (std::size_t i = 0; i < numbers.size() && !animations_only; ++i)
    if (!numbers[i].empty()) turning.push_back(i);
  const std::size_t steps = std::clamp(most / (turning.size() + 1), kFewestSteps, kMostSteps);
  const std::size_t count =
      std::min(turning.size(), std::max<std::size_t>(1, kMostWeights / (steps * (numbers.size() + 1))));
  for (std::size_t n = 0; n < count; ++n) {
    const std::size_t i = turning[n * turning.size() / count];
    PoseSet& alone = sets.emplace_back(PoseSet{PoseKind::kAlone, all, {}, numbers[i]});
    for (std::vector<double>& pose : alone_poses({&i, 1}, numbers.size(), steps))
      alone.poses.push_back(standing_pose(std::move(pose), skin));
  }
  if (!weights.rig) return sets;
  PoseSet posed{PoseKind::kPosed, all, {}};
  for (std::vector<double>& pose : weights.rig->sample(most, kRigSeed))
    posed.poses.push_back(standing_pose(std::move(pose), skin));
  if (!posed.poses.empty()) sets.push_back(std::move(posed));
  return sets;
}

std::vector<SeenPose> with_extra_targets(const PoseSet& set, const MeshWeights& weights, const ExtraDrivers& drivers,
                                         const Viewer& viewer, bool are_sliders_driven) {
  const PoseList standing = drivers.standing(weights.poses);
  std::map<std::size_t, PlayedTrack> tracks;
  const auto track_of = [&](std::size_t t) -> const PlayedTrack& {
    const auto known = tracks.find(t);
    if (known != tracks.end()) return known->second;
    const WeightTrack& track = weights.tracks[t];
    const ExtendedTrack extended = drivers.extended(weights.names[t], track, std::numeric_limits<double>::infinity());
    const WeightTrack written = as_track(track, extended, drivers.size());
    return tracks
        .emplace(t, PlayedTrack(viewer, written.keys, written.interpolation, written.targets, weights.ranges[t]))
        .first->second;
  };
  std::vector<SeenPose> result;
  for (const PlayedPose& pose : set.poses) {
    SeenPose& seen = result.emplace_back(pose.seen);
    if (drivers.size() == 0) continue;
    if (pose.track != PlayedPose::kNone) {
      const std::size_t own = seen.weights.size();
      std::vector<double> all(own + drivers.size());
      track_of(pose.track).at(pose.time, false, all);
      seen.weights.insert(seen.weights.end(), all.begin() + static_cast<std::ptrdiff_t>(own), all.end());
    } else if (pose.standing != PlayedPose::kNone) {
      seen.weights = standing[pose.standing];
    } else if (set.kind == PoseKind::kAlone && !are_sliders_driven && weights.is_driven) {
      seen.weights.resize(seen.weights.size() + drivers.size());  // only animations drive the correction targets
    } else {
      seen.weights = drivers.with_extras(std::move(seen.weights));
    }
  }
  return result;
}

}  // namespace chronormal::inline internal
