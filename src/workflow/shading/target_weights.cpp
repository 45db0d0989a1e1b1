#include "workflow/shading/target_weights.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "chronormal/core/polynomial.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kSamplesPerPiece = 16;

// Counts the samples of a track. If weights do not change between keys, each key is one sample. Otherwise there are
// kSamplesPerPiece / step samples from each key up to the next, and one sample at the last key.
std::size_t count_samples(const WeightTrack& track, std::size_t step) {
  if (track.interpolation == GltfInterpolation::kStep || track.size() < 2) return track.size();
  return kSamplesPerPiece / step * (track.size() - 1) + 1;
}

std::vector<double> sample(const WeightTrack& track, std::size_t step, std::size_t index) {
  std::vector<double> weights(track.targets);
  const bool holds = track.interpolation == GltfInterpolation::kStep || track.size() < 2;
  const std::size_t in_piece = kSamplesPerPiece / step;
  const std::size_t key = holds ? index : index / in_piece, part = holds ? 0 : index % in_piece;
  const double t = static_cast<double>(part) / static_cast<double>(in_piece);
  for (std::size_t i = 0; i < track.targets; ++i)
    weights[i] = part == 0 ? track.value(key, i) : evaluate(track.piece(key, i), t);
  return weights;
}

}  // namespace

double WeightTrack::value(std::size_t key, std::size_t target) const noexcept {
  if (interpolation == GltfInterpolation::kCubicSpline) return keys.values[(3 * key + 1) * targets + target];
  return keys.values[key * targets + target];
}

double WeightTrack::tangent(std::size_t key, bool out, std::size_t target) const noexcept {
  assert(interpolation == GltfInterpolation::kCubicSpline);
  return keys.values[(3 * key + (out ? 2 : 0)) * targets + target];
}

std::array<double, 4> WeightTrack::piece(std::size_t key, std::size_t target) const noexcept {
  const double a = value(key, target), b = value(key + 1, target);
  if (interpolation == GltfInterpolation::kStep) return {a, a, a, a};
  const double duration = keys.times[key + 1] - keys.times[key];
  if (interpolation == GltfInterpolation::kCubicSpline) {
    return {a, a + duration * tangent(key, true, target) / 3, b - duration * tangent(key + 1, false, target) / 3, b};
  }
  return {a, (2 * a + b) / 3, (a + 2 * b) / 3, b};
}

void WeightUse::add_active(std::vector<std::size_t> active) {
  if (active == last_) return;
  for (const std::size_t i : active) moments_[i].push_back(moment_count_);
  ++moment_count_;
  last_ = std::move(active);
}

bool WeightUse::together(std::size_t i, std::size_t j) const noexcept {
  const std::vector<std::size_t>&a = moments_[i], &b = moments_[j];
  for (std::size_t x = 0, y = 0; x < a.size() && y < b.size();) {
    if (a[x] == b[y]) return true;
    ++(a[x] < b[y] ? x : y);
  }
  return false;
}

void WeightUse::note(std::size_t target, double weight, std::vector<std::size_t>& active) {
  if (weight == 0) return;
  lowest_[target] = std::fmin(lowest_[target], weight);
  highest_[target] = std::fmax(highest_[target], weight);
  if (active.empty() || active.back() != target) active.push_back(target);
}

void WeightUse::add_track(const WeightTrack& track) {
  assert(track.targets == targets());
  const bool holds = track.interpolation == GltfInterpolation::kStep || track.size() < 2;
  for (std::size_t key = 0; key + (holds ? 0 : 1) < track.size(); ++key) {
    std::vector<std::size_t> active;
    for (std::size_t i = 0; i < targets(); ++i) {
      if (holds) {
        note(i, track.value(key, i), active);
      } else {
        for (const double b : track.piece(key, i)) note(i, b, active);
      }
    }
    add_active(std::move(active));
  }
  tracks_.push_back(&track);
}

void WeightUse::add_pose(std::vector<double> weights) {
  assert(weights.size() == targets());
  std::vector<std::size_t> active;
  for (std::size_t i = 0; i < targets(); ++i) note(i, weights[i], active);
  add_active(std::move(active));
  poses_.push_back(std::move(weights));
}

std::size_t WeightUse::sample_count() const noexcept { return sample_count(1); }

std::size_t WeightUse::sample_count(std::size_t step) const noexcept {
  std::size_t total = poses_.size();
  for (const WeightTrack* track : tracks_) total += count_samples(*track, step);
  return total;
}

std::vector<std::vector<double>> WeightUse::samples_with_keys(std::size_t most) const {
  std::size_t step = 1;
  while (step < kSamplesPerPiece && sample_count(step) > most) step *= 2;
  return samples(most, step);
}

std::vector<std::vector<double>> WeightUse::samples(std::size_t most, std::size_t step) const {
  const std::size_t total = sample_count(step);
  std::vector<std::vector<double>> result;
  const std::size_t count = std::min(total, most);
  std::size_t track = 0, first = poses_.size();  // first: the index of the first sample of `track`
  for (std::size_t n = 0; n < count; ++n) {
    // Chooses evenly spaced indices of samples, including the first and the last index. Computes the indices in double,
    // so that no product overflows.
    const std::size_t index =
        count < 2 ? 0
                  : static_cast<std::size_t>(std::floor(static_cast<double>(n) * static_cast<double>(total - 1) /
                                                        static_cast<double>(count - 1)));
    if (index < poses_.size()) {
      result.push_back(poses_[index]);
      continue;
    }
    while (index - first >= count_samples(*tracks_[track], step)) first += count_samples(*tracks_[track++], step);
    result.push_back(sample(*tracks_[track], step, index - first));
  }
  return result;
}

}  // namespace chronormal::inline internal
