// Chooses the instants at which a bake is judged, and those keys and tracks that tell most where there are too many.
#include "workflow/bake/judge/played_poses.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <random>
#include <set>
#include <utility>

#include "core/random_numbers.h"
#include "workflow/bake/mesh_skins.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kMostActive = 16, kMostProducts = 24, kBetweenSkinnedKeys = 8;

bool moves_after(const WeightTrack& track, std::size_t key) {
  if (key + 1 >= track.size() || track.interpolation == GltfInterpolation::kStep) return false;
  for (std::size_t i = 0; i < track.targets; ++i) {
    const std::array<double, 4> piece = track.piece(key, i);
    if (std::any_of(piece.begin(), piece.end(), [&](double b) { return b != piece[0]; })) return true;
  }
  return false;
}

// Whether a track that holds its weights between keys has others before a key.
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

// The targets that a track moves most after a key, with bounds of their weights there.
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

// Where each weight, and each product of two, is largest.
class Peaks {
 public:
  // The weights that are active at once, in what has this number.
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

  // Of all numbers, ascending, as many as asked for: those with the largest peaks, and a fourth evenly.
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

std::vector<double> mixed(const std::vector<double>& a, const std::vector<double>& b, double part) {
  std::vector<double> result(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) result[i] = (1 - part) * a[i] + part * b[i];
  return result;
}

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

// An instant of one of some tracks, with the weights that a host plays there.
struct PlayedInstant {
  std::size_t track = 0;
  double time = 0;
  std::vector<double> weights;
};

std::vector<PlayedInstant> played_instants(std::span<const DrivingTrack> tracks, const Host& host,
                                           std::size_t between_keys, double phase, std::size_t most) {
  std::vector<PlayedInstant> instants;
  std::vector<std::size_t> counts;
  std::size_t total = 0;
  for (const DrivingTrack& driving : tracks) {
    counts.push_back(telling_keys(driving.track, std::numeric_limits<std::size_t>::max()).size());
    total += counts.back();
  }
  for (std::size_t t = 0; t < tracks.size(); ++t) {
    const WeightTrack& track = tracks[t].track;
    const PlayedTrack played(host, track.keys, track.interpolation, track.targets, tracks[t].animation);
    const double share = static_cast<double>(most) * static_cast<double>(counts[t]) / static_cast<double>(total);
    const std::size_t room = std::max<std::size_t>(1, static_cast<std::size_t>(share));
    const std::vector<std::size_t> keys = telling_keys(track, room);
    const auto in_gap = static_cast<std::size_t>(static_cast<double>(between_keys) / tracks[t].cuts);
    for (std::size_t n = 0; n < keys.size(); ++n) {
      const bool moves = moves_after(track, keys[n]);
      const std::size_t of_share = (n + 1) * room / keys.size() - n * room / keys.size();
      const std::size_t count = moves ? std::clamp<std::size_t>(in_gap, 1, of_share) : 1;
      for (std::size_t step = 0; step < count; ++step) {
        const double from = track.keys.times[keys[n]];
        const double part = (static_cast<double>(step) + phase) / static_cast<double>(count);
        const double time = moves ? from + part * (track.keys.times[keys[n] + 1] - from) : from;
        PlayedInstant& instant = instants.emplace_back(PlayedInstant{t, time, std::vector<double>(track.targets)});
        played.at(time, false, instant.weights);
      }
    }
  }
  return instants;
}

// Adds a pose, but where it looks as the one before.
void add_seen(std::vector<double> weights, const MeshSkin* skin, double time, std::vector<SeenPose>& poses) {
  SeenPose pose{std::move(weights), skin, skin != nullptr && skin->moves() ? time : 0};
  if (poses.empty() || !(poses.back() == pose)) poses.push_back(std::move(pose));
}

// Adds what is seen of a track through a skin: at the keys of both and at some instants between, but for those that are
// too many. Returns whether none are.
bool add_skinned(const DrivingTrack& driving, const MeshSkin& skin, const Host& host, double phase, std::size_t most,
                 std::vector<SeenPose>& poses) {
  const std::vector<double> keys = keys_of_both(driving.track, skin);
  const std::size_t between =
      std::max<std::size_t>(1, static_cast<std::size_t>(static_cast<double>(kBetweenSkinnedKeys) / driving.cuts));
  std::vector<double> times;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    times.push_back(keys[k]);
    for (std::size_t step = 0; k + 1 < keys.size() && step < between; ++step) {
      const double part = (static_cast<double>(step) + phase) / static_cast<double>(between);
      times.push_back(keys[k] + part * (keys[k + 1] - keys[k]));
    }
  }
  const WeightTrack& track = driving.track;
  const PlayedTrack played(host, track.keys, track.interpolation, track.targets, driving.animation);
  const std::size_t count = std::min(most, times.size());
  for (std::size_t n = 0; n < count; ++n) {
    const double time = times[n * times.size() / count];
    std::vector<double> weights(track.targets);
    played.at(time, false, weights);
    add_seen(std::move(weights), &skin, time, poses);
  }
  return count == times.size();
}

}  // namespace

std::vector<SeenPose> seen_tracks(std::span<const DrivingTrack> tracks, const MeshSkins& skins, const Host& host,
                                  std::size_t between_keys, double phase, std::size_t most) {
  const std::vector<PlayedInstant> instants = played_instants(tracks, host, between_keys, phase, most);
  const std::vector<std::optional<MeshSkin>> as_they_are(1);
  std::vector<SeenPose> poses;
  auto first = instants.begin();  // of the track, where its instants begin
  for (std::size_t t = 0; t < tracks.size(); ++t) {
    const auto last = std::find_if(first, instants.end(), [&](const PlayedInstant& other) { return other.track != t; });
    for (const auto& skin : skins.of_tracks.empty() ? as_they_are : skins.of_tracks[t]) {
      const std::size_t share = std::max<std::size_t>(1, most / tracks.size());
      if (skin && add_skinned(tracks[t], *skin, host, phase, share, poses)) continue;
      for (auto instant = first; instant != last; ++instant)
        add_seen(instant->weights, skin ? &*skin : nullptr, instant->time, poses);
    }
    first = last;
  }
  return poses;
}

PoseList alone_poses(std::span<const std::size_t> targets, std::size_t target_count, const ExtraDrivers& extras,
                     std::size_t steps, double phase) {
  PoseList poses;
  for (const std::size_t i : targets) {
    for (std::size_t step = 1; step <= steps; ++step) {
      std::vector<double> own(target_count, 0.0);
      own[i] = (static_cast<double>(step) - phase) / static_cast<double>(steps);
      poses.push_back(extras.with_extras(std::move(own)));
    }
  }
  return poses;
}

PoseList random_poses(std::span<const std::size_t> targets, std::size_t target_count, const ExtraDrivers& extras,
                      std::size_t count, unsigned seed) {
  PoseList poses;
  if (targets.size() < 2) return poses;
  std::mt19937 random(seed);
  std::vector<std::size_t> order(targets.begin(), targets.end());
  for (std::size_t n = 0; n < count; ++n) {
    const std::size_t active = 2 + random_below(random, std::min(kMostActive, targets.size()) - 1);
    std::vector<double> own(target_count, 0.0);
    for (std::size_t k = 0; k < active; ++k) {
      std::swap(order[k], order[k + random_below(random, order.size() - k)]);
      own[order[k]] = random_part(random);
    }
    poses.push_back(extras.with_extras(std::move(own)));
  }
  return poses;
}

PoseList cross_fades(std::span<const DrivingTrack> tracks, std::size_t count, unsigned seed) {
  PoseList poses;
  if (tracks.size() < 2) return poses;
  std::mt19937 random(seed);
  std::vector<PlayedTrack> played;
  for (const DrivingTrack& driving : tracks)
    played.emplace_back(Host{}, driving.track.keys, driving.track.interpolation, driving.track.targets,
                        driving.animation);
  const auto at_random = [&](std::size_t t) {
    const double first = tracks[t].track.keys.times.front(), last = tracks[t].track.keys.times.back();
    std::vector<double> pose(tracks[t].track.targets);
    played[t].at(first + random_part(random) * (last - first), false, pose);
    return pose;
  };
  for (std::size_t n = 0; n < count; ++n) {
    const std::size_t a = random_below(random, tracks.size()), b = random_below(random, tracks.size() - 1);
    const std::vector<double> from = at_random(a), to = at_random(b < a ? b : b + 1);
    poses.push_back(mixed(from, to, random_part(random)));
  }
  return poses;
}

}  // namespace chronormal::inline internal
