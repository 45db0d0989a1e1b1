#include "workflow/bake/judge/played_poses.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "workflow/bake/judge/random_numbers.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kMostActive = 16;

std::vector<double> mixed(const std::vector<double>& a, const std::vector<double>& b, double part) {
  std::vector<double> result(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) result[i] = (1 - part) * a[i] + part * b[i];
  return result;
}

}  // namespace

void add_played_poses(const DrivingTrack& driving, const Host& host, std::size_t between_keys, double phase,
                      std::size_t most, PoseList& poses) {
  const WeightTrack& track = driving.track;
  const PlayedTrack played(host, track.keys, track.interpolation, track.targets, driving.animation);
  const bool holds = track.interpolation == GltfInterpolation::kStep || track.size() < 2;
  const std::size_t in_piece = holds ? 1 : between_keys;
  const std::size_t total = holds ? track.size() : in_piece * (track.size() - 1) + 1;
  const std::size_t count = std::min(total, std::max<std::size_t>(most, 1));
  for (std::size_t n = 0; n < count; ++n) {
    const std::size_t index = count < 2 ? 0 : n * (total - 1) / (count - 1);
    const std::size_t key = index / in_piece;
    double time = track.keys.times[key];
    if (!holds && key + 1 < track.size()) {
      const double part = (static_cast<double>(index % in_piece) + phase) / static_cast<double>(in_piece);
      time += part * (track.keys.times[key + 1] - time);
    }
    std::vector<double> pose(track.targets);
    played.at(time, false, pose);
    if (poses.empty() || poses.back() != pose) poses.push_back(std::move(pose));
  }
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
  for (const auto& [track, animation] : tracks)
    played.emplace_back(Host{}, track.keys, track.interpolation, track.targets, animation);
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
