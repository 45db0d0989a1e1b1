#include "workflow/hosts/played_track.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace chronormal::inline internal {
namespace {

bool is_resampled(TrackRule rule, GltfInterpolation interpolation) noexcept {
  if (rule == TrackRule::kAllResampled) return true;
  return rule == TrackRule::kSplinesResampled && interpolation == GltfInterpolation::kCubicSpline;
}

bool lacks_duration(TrackRule rule, GltfInterpolation interpolation) noexcept {
  return rule == TrackRule::kSplinesWithoutDuration && interpolation == GltfInterpolation::kCubicSpline;
}

// Keys of a cubic spline that, played as specified, are what a host plays that does not multiply tangents by the time
// between keys.
GltfKeys without_duration(GltfKeys keys, std::size_t targets) {
  for (std::size_t key = 0; key + 1 < keys.times.size(); ++key) {
    const double duration = keys.times[key + 1] - keys.times[key];
    for (std::size_t i = 0; i < targets; ++i) {
      keys.values[(3 * key + 2) * targets + i] /= duration;
      keys.values[3 * (key + 1) * targets + i] /= duration;
    }
  }
  return keys;
}

// gltfpack rounds the number of samples, with a bias towards one more.
double index_of_last_sample(const TimeRange& animation) noexcept {
  constexpr double kBias = 0.8;
  return std::floor((animation.last - animation.first) * kHostSampleRate + kBias);
}

}  // namespace

PlayedTrack::PlayedTrack(const Host& host, GltfKeys keys, GltfInterpolation interpolation, std::size_t target_count,
                         const TimeRange& animation)
    : host_(host),
      as_specified_(keys.times.size() < 2 ||
                    (!is_resampled(host.tracks, interpolation) && !lacks_duration(host.tracks, interpolation))),
      resampled_(is_resampled(host.tracks, interpolation)),
      steps_(interpolation == GltfInterpolation::kStep),
      first_(host.tracks == TrackRule::kAllResampled ? animation.first : 0),
      last_(keys.times.back()),
      last_index_(host.tracks == TrackRule::kAllResampled ? index_of_last_sample(animation)
                                                          : std::ceil(keys.times.back() * kHostSampleRate)),
      curve_(lacks_duration(host.tracks, interpolation) ? without_duration(std::move(keys), target_count)
                                                        : std::move(keys),
             interpolation, target_count) {}

void PlayedTrack::sample(double index, std::span<double> weights) const {
  double time = first_ + index / kHostSampleRate;
  // The last sample of splines is the last key.
  if (host_.tracks == TrackRule::kSplinesResampled) time = std::min(time, last_);
  curve_.at(time, false, weights);
  if (host_.weight_bits == 32) return;
  const double most = std::ldexp(1, host_.weight_bits) - 1;
  for (double& weight : weights) weight = std::floor(std::clamp(weight, 0.0, 1.0) * most + 0.5) / most;
}

void PlayedTrack::at(double time, bool just_before, std::span<double> weights) const {
  if (!resampled_) {
    curve_.at(time, just_before, weights);
    drop_weights(host_, weights);
    return;
  }
  const double place = std::clamp((time - first_) * kHostSampleRate, 0.0, last_index_);
  const double before = just_before && steps_ ? std::max(std::ceil(place) - 1, 0.0) : std::floor(place);
  const double after = std::min(before + 1, last_index_);
  sample(before, weights);
  const double start = before / kHostSampleRate;
  double end = after / kHostSampleRate;
  if (host_.tracks == TrackRule::kSplinesResampled) end = std::min(end, last_);
  if (!steps_ && end > start) {
    std::vector<double> next(weights.size());
    sample(after, next);
    const double t = std::clamp((time - first_ - start) / (end - start), 0.0, 1.0);
    for (std::size_t i = 0; i < weights.size(); ++i) weights[i] = (1 - t) * weights[i] + t * next[i];
  }
  drop_weights(host_, weights);
}

}  // namespace chronormal::inline internal
