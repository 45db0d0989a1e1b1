// Chooses the times of tracks at which a bake is judged. If there are too many, prefers the keys and tracks in which
// weights, or products of two weights, are largest.
#include "workflow/bake/poses/played_poses.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "workflow/bake/poses/mesh_skins.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kMostProducts = 24, kBetweenSkinnedKeys = 8;
constexpr double kSkinnedPhase = 0.61;

bool moves_after(const WeightTrack& track, std::size_t key) {
  if (key + 1 >= track.size() || track.interpolation == GltfInterpolation::kStep) return false;
  for (std::size_t i = 0; i < track.targets; ++i) {
    const std::array<double, 4> piece = track.piece(key, i);
    if (std::any_of(piece.begin(), piece.end(), [&](double b) { return b != piece[0]; })) return true;
  }
  return false;
}

// Tells whether the weights of a STEP track change at a key.
bool jumps_at(const WeightTrack& track, std::size_t key) {
  if (key == 0 || track.interpolation != GltfInterpolation::kStep) return false;
  for (std::size_t i = 0; i < track.targets; ++i)
    if (track.value(key, i) != track.value(key - 1, i)) return true;
  return false;
}

struct Peak {
  double size = 0;
  std::size_t number = 0;
};

// Returns the targets that have a weight between a key and the next key, with bounds of these weights. The largest
// weights come first, and small weights are left out.
std::vector<Peak> active_after(const WeightTrack& track, std::size_t key) {
  std::vector<Peak> result;
  for (std::size_t i = 0; i < track.targets; ++i) {
    double most = std::fabs(track.value(key, i));
    if (key + 1 < track.size())
      for (const double b : track.piece(key, i)) most = std::fmax(most, std::fabs(b));
    if (most > 0) result.push_back({most, i});
  }
  std::stable_sort(result.begin(), result.end(), [](const Peak& a, const Peak& b) { return a.size > b.size; });
  if (result.size() > kMostProducts) result.resize(kMostProducts);
  return result;
}

// The peaks of weights: for each weight and each product of two weights, the largest value, and the item in which this
// value occurs. Items are keys or tracks.
class Peaks {
 public:
  // Adds the item with the index `number`. `active` has the weights that are active in this item at the same time.
  void add(const std::vector<Peak>& active, std::size_t number) {
    for (std::size_t a = 0; a < active.size(); ++a) {
      for (std::size_t b = a; b < active.size(); ++b) {
        const auto [i, j] = std::minmax(active[a].number, active[b].number);
        Peak& peak = peaks_[{i, j}];
        const double size = i == j ? active[a].size : active[a].size * active[b].size;
        if (size > peak.size) peak = {size, number};
      }
    }
  }

  // Returns at most `most` of the items in `all`, in ascending order. Three quarters of the result are the items with
  // the largest peaks, and the rest is evenly spaced among the other items.
  [[nodiscard]] std::vector<std::size_t> telling(std::span<const std::size_t> all, std::size_t most) const {
    std::vector<Peak> order;
    order.reserve(peaks_.size());
    for (const auto& [pair, peak] : peaks_) order.push_back(peak);
    std::stable_sort(order.begin(), order.end(), [](const Peak& a, const Peak& b) { return a.size > b.size; });
    std::set<std::size_t> taken;
    for (std::size_t n = 0; n < order.size() && taken.size() < most - most / 4; ++n) taken.insert(order[n].number);
    const std::size_t more = most - taken.size();
    for (std::size_t n = 0; n < more; ++n) taken.insert(all[more < 2 ? 0 : n * (all.size() - 1) / (more - 1)]);
    return {taken.begin(), taken.end()};
  }

 private:
  std::map<std::pair<std::size_t, std::size_t>, Peak> peaks_;
};

}  // namespace

std::vector<std::size_t> telling_keys(const WeightTrack& track, std::size_t most) {
  std::vector<std::size_t> all;
  bool moved = true;
  for (std::size_t key = 0; key < track.size(); ++key) {
    const bool moves = moves_after(track, key);
    if (moves || moved || jumps_at(track, key)) all.push_back(key);
    moved = moves;
  }
  if (all.size() <= most) return all;
  Peaks peaks;
  for (const std::size_t key : all) peaks.add(active_after(track, key), key);
  return peaks.telling(all, most);
}

std::vector<std::size_t> telling_tracks(std::span<const WeightTrack> tracks, std::size_t most) {
  std::vector<std::size_t> all(tracks.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  if (all.size() <= most) return all;
  Peaks peaks;
  for (const std::size_t t : all)
    for (std::size_t key = 0; key < tracks[t].size(); ++key) peaks.add(active_after(tracks[t], key), t);
  return peaks.telling(all, most);
}

namespace {

// Positions in a gap between two keys at which a track is judged, from 0 to 1. If fewer positions are used, they are
// the first of this list.
constexpr std::array<double, 5> kParts = {0.63, 0, 0.37, 0.88, 0.11};

// Returns at most `room` times of one track, in seconds. The times are at the telling keys of the track and after these
// keys.
std::vector<double> instants_of(const WeightTrack& track, std::size_t room) {
  std::vector<double> times;
  const std::vector<std::size_t> keys = telling_keys(track, room);
  for (std::size_t n = 0; n < keys.size(); ++n) {
    const double from = track.keys.times[keys[n]];
    const std::size_t of_share = (n + 1) * room / keys.size() - n * room / keys.size();
    const std::size_t count = moves_after(track, keys[n]) ? std::clamp<std::size_t>(of_share, 1, kParts.size()) : 1;
    if (count == 1 && keys.size() < room) {
      times.push_back(from);
      continue;
    }
    const bool is_last = keys[n] + 1 >= track.size();
    const double gap = is_last ? 0 : track.keys.times[keys[n] + 1] - from;
    std::vector<double> parts(kParts.begin(), kParts.begin() + static_cast<std::ptrdiff_t>(count));
    std::sort(parts.begin(), parts.end());
    for (const double part : parts) times.push_back(from + part * gap);
  }
  return times;
}

// Adds a pose, unless a viewer shows the same as in the last pose of the list.
void add_seen(PlayedPose pose, std::vector<PlayedPose>& poses) {
  if (poses.empty() || poses.back().track != pose.track || !(poses.back().seen == pose.seen))
    poses.push_back(std::move(pose));
}

PlayedPose pose_at(const PlayedTrack& played, std::size_t targets, std::size_t track, double time,
                   const MeshSkin* skin) {
  PlayedPose pose{{std::vector<double>(targets), skin, skin != nullptr && skin->moves() ? time : 0}, track, time};
  played.at(time, false, pose.seen.weights);
  return pose;
}

// Returns the times of all keys of a track and of a skin, and some times between neighbouring keys, in seconds.
std::vector<double> skinned_instants(const WeightTrack& track, const MeshSkin& skin) {
  const std::vector<double> keys = keys_of_both(track, skin);
  std::vector<double> times;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    times.push_back(keys[k]);
    for (std::size_t step = 0; k + 1 < keys.size() && step < kBetweenSkinnedKeys; ++step) {
      const double part = (static_cast<double>(step) + kSkinnedPhase) / static_cast<double>(kBetweenSkinnedKeys);
      times.push_back(keys[k] + part * (keys[k + 1] - keys[k]));
    }
  }
  return times;
}

}  // namespace

std::vector<PlayedPose> played_tracks(const MeshWeights& weights, const Viewer& viewer, std::size_t most) {
  std::vector<std::size_t> counts;
  std::size_t total = 0;
  for (const WeightTrack& track : weights.tracks) {
    counts.push_back(telling_keys(track, std::numeric_limits<std::size_t>::max()).size());
    total += counts.back();
  }
  const std::vector<std::optional<MeshSkin>> as_they_are(1);
  std::vector<PlayedPose> poses;
  for (std::size_t t = 0; t < weights.tracks.size(); ++t) {
    const WeightTrack& track = weights.tracks[t];
    const PlayedTrack played(viewer, track.keys, track.interpolation, track.targets, weights.ranges[t]);
    const double share = static_cast<double>(most) * static_cast<double>(counts[t]) / static_cast<double>(total);
    const std::vector<double> times = instants_of(track, std::max<std::size_t>(1, static_cast<std::size_t>(share)));
    for (const auto& skin : weights.skins.of_tracks.empty() ? as_they_are : weights.skins.of_tracks[t]) {
      const MeshSkin* const seen_through = skin ? &*skin : nullptr;
      const auto look_at = [&](double time) { add_seen(pose_at(played, track.targets, t, time, seen_through), poses); };
      if (skin) {
        const std::vector<double> skinned = skinned_instants(track, *skin);
        const std::size_t room = std::max<std::size_t>(1, most / weights.tracks.size());
        const std::size_t count = std::min(room, skinned.size());
        for (std::size_t n = 0; n < count; ++n) look_at(skinned[n * skinned.size() / count]);
        if (count == skinned.size()) continue;
      }
      for (const double time : times) look_at(time);
    }
  }
  return poses;
}

PoseList alone_poses(std::span<const std::size_t> targets, std::size_t target_count, std::size_t steps) {
  PoseList poses;
  for (const std::size_t i : targets) {
    for (std::size_t step = 1; step <= steps; ++step) {
      std::vector<double> own(target_count, 0.0);
      own[i] = static_cast<double>(step) / static_cast<double>(steps);
      poses.push_back(std::move(own));
    }
  }
  return poses;
}

}  // namespace chronormal::inline internal
