#include "workflow/viewers/played_track.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace chronormal::inline internal {
namespace {

bool is_resampled(TrackRule rule, GltfInterpolation interpolation) noexcept {
  if (rule == TrackRule::kAllResampled) return true;
  return rule == TrackRule::kSplinesResampled && interpolation == GltfInterpolation::kCubicSpline;
}

bool has_own_splines(TrackRule rule, GltfInterpolation interpolation) noexcept {
  return interpolation == GltfInterpolation::kCubicSpline &&
         (rule == TrackRule::kSplinesWithoutDuration || rule == TrackRule::kSplinesMisread);
}

// Returns the four factors of cubic Hermite interpolation at t in [0, 1]: of the value at the start, the tangent at the
// start, the value at the end, and the tangent at the end.
std::array<double, 4> hermite(double t) noexcept {
  const double s = 1 - t;
  return {(1 + 2 * t) * s * s, t * s * s, t * t * (3 - 2 * t), t * t * (t - 1)};
}

// Returns the index of the last sample of an animation, as gltfpack computes the index. gltfpack rounds the number of
// samples up if its fraction is at least 0.2.
double index_of_last_sample(const TimeRange& animation) noexcept {
  constexpr double kBias = 0.8;
  return std::floor((animation.last - animation.first) * kViewerSampleRate + kBias);
}

}  // namespace

Result<TimeRange> weight_time_range(const GltfDocument& document, std::size_t animation) {
  TimeRange range{std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest()};
  const std::vector<GltfTrack>& tracks = document.animations()[animation].tracks;
  for (std::size_t t = 0; t < tracks.size(); ++t) {
    if (tracks[t].same_keys_as != t) continue;
    const Result<GltfKeys> keys = document.keys(animation, t);
    if (!keys) return keys.error();
    range.first = std::min(range.first, keys.value().times.front());
    range.last = std::max(range.last, keys.value().times.back());
  }
  return range;
}

PlayedTrack::PlayedTrack(const Viewer& viewer, GltfKeys keys, GltfInterpolation interpolation, std::size_t target_count,
                         const TimeRange& animation)
    : viewer_(viewer),
      as_specified_(!is_resampled(viewer.tracks, interpolation) && !has_own_splines(viewer.tracks, interpolation)),
      resampled_(is_resampled(viewer.tracks, interpolation)),
      steps_(interpolation == GltfInterpolation::kStep),
      first_(viewer.tracks == TrackRule::kAllResampled ? animation.first : 0),
      last_(keys.times.back()),
      last_index_(viewer.tracks == TrackRule::kAllResampled ? index_of_last_sample(animation)
                                                            : std::ceil(keys.times.back() * kViewerSampleRate)),
      keys_(has_own_splines(viewer.tracks, interpolation) ? keys : GltfKeys()),
      curve_(std::move(keys), interpolation, target_count) {}

void PlayedTrack::sample(double index, std::span<double> weights) const {
  double time = first_ + index / kViewerSampleRate;
  // The last sample of a resampled spline is its last key, whose time need not be a multiple of the step.
  if (viewer_.tracks == TrackRule::kSplinesResampled) time = std::min(time, last_);
  curve_.at(time, false, weights);
  if (viewer_.weight_bits == 32) return;
  const double most = std::ldexp(1, viewer_.weight_bits) - 1;
  for (double& weight : weights) weight = std::floor(std::clamp(weight, 0.0, 1.0) * most + 0.5) / most;
}

void PlayedTrack::play_spline(double time, bool just_before, std::span<double> weights) const {
  const std::vector<double>& times = keys_.times;
  const std::size_t keys = times.size(), targets = weights.size();
  const auto after = just_before ? std::lower_bound(times.begin(), times.end(), time)
                                 : std::upper_bound(times.begin(), times.end(), time);
  const auto next = static_cast<std::size_t>(after - times.begin());
  const bool outside = next == 0 || next == keys;
  const std::size_t from = next == 0 ? 0 : next - 1, to = outside ? from : next;
  const double duration = outside ? 0 : times[to] - times[from], t = outside ? 0 : (time - times[from]) / duration;
  const std::array<double, 4> h = hermite(t);
  for (std::size_t i = 0; i < targets; ++i) {
    if (viewer_.tracks == TrackRule::kSplinesWithoutDuration) {
      const auto number = [&](std::size_t key, std::size_t which) {
        return keys_.values[(3 * key + which) * targets + i];
      };
      weights[i] = h[0] * number(from, 1) + h[2] * number(to, 1) + t * (h[1] * number(from, 2) + h[3] * number(to, 0));
      continue;
    }
    // A viewer with the rule kSplinesMisread takes only the in-tangents of a target, which are a third of the target's
    // numbers. The viewer reads these in-tangents as if they were an in-tangent, a value and an out-tangent for each
    // key. No numbers are left for the later keys, so their weight is 0.
    const auto number = [&](std::size_t at) { return keys_.values[3 * at * targets + i]; };
    weights[i] = 3 * to + 1 >= keys || 3 * from + 2 >= keys
                     ? 0
                     : h[0] * number(3 * from + 1) + h[2] * number(3 * to + 1) +
                           duration * (h[1] * number(3 * from + 2) + h[3] * number(3 * to));
  }
}

void PlayedTrack::at(double time, bool just_before, std::span<double> weights) const {
  if (!resampled_) {
    if (as_specified_)
      curve_.at(time, just_before, weights);
    else
      play_spline(time, just_before, weights);
    drop_weights(viewer_, weights);
    return;
  }
  const double place = std::clamp((time - first_) * kViewerSampleRate, 0.0, last_index_);
  const double before = just_before && steps_ ? std::max(std::ceil(place) - 1, 0.0) : std::floor(place);
  const double after = std::min(before + 1, last_index_);
  sample(before, weights);
  const double start = before / kViewerSampleRate;
  double end = after / kViewerSampleRate;
  if (viewer_.tracks == TrackRule::kSplinesResampled) end = std::min(end, last_);
  if (!steps_ && end > start) {
    std::vector<double> next(weights.size());
    sample(after, next);
    const double t = std::clamp((time - first_ - start) / (end - start), 0.0, 1.0);
    for (std::size_t i = 0; i < weights.size(); ++i) weights[i] = (1 - t) * weights[i] + t * next[i];
  }
  drop_weights(viewer_, weights);
}

}  // namespace chronormal::inline internal
