#include "workflow/bake/poses/tracks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "chronormal/core/polynomial.h"

namespace chronormal::inline internal {
namespace {

constexpr int kMostHalvings = 10;  // how often a gap between two keys is halved at most

using Cubic = std::array<double, 4>;
using Sextic = std::array<double, 7>;

// A weight at a key: its value, and its slopes before and after the key, per second.
struct Knot {
  double in = 0, value = 0, out = 0;
};

constexpr auto kMost = static_cast<double>(std::numeric_limits<float>::max());

// Returns pi as the error in radians if any value was clamped to the range of float32, and otherwise 0. A clamped value
// differs from the exact weight or slope, so the error of the normal is unknown.
double error_of_clamping(const std::vector<float>& values) {
  for (const float value : values)
    if (std::fabs(value) == static_cast<float>(kMost)) return std::numbers::pi;
  return 0;
}

double slope_at_start(const Cubic& b, double duration) { return duration > 0 ? 3 * (b[1] - b[0]) / duration : 0; }
double slope_at_end(const Cubic& b, double duration) { return duration > 0 ? 3 * (b[3] - b[2]) / duration : 0; }

// Returns the weight of a correction target between two keys of a track, as a polynomial in Bernstein form. `weights`
// are the cubics of the own weights.
Sextic extra_weight(const ExtraWeight& extra, const std::vector<Cubic>& weights) {
  const Sextic product = multiply(weights[extra.i], weights[extra.j]);
  const Sextic raised = multiply(weights[extra.i], Cubic{1, 1, 1, 1});
  Sextic result{};
  for (std::size_t k = 0; k < result.size(); ++k) result[k] = extra.linear * raised[k] + extra.quadratic * product[k];
  return result;
}

// Returns the slope of a correction target's weight, which is computed from two weights. a and b are the values of
// these two weights, and slope_a and slope_b are their slopes.
double slope_of(const ExtraWeight& extra, double a, double b, double slope_a, double slope_b) {
  return extra.linear * slope_a + extra.quadratic * (slope_a * b + a * slope_b);
}

// Returns a bound of the distance between the polynomial p and the cubic that has the values and slopes of p at both
// ends.
double cubic_error(const Sextic& p) {
  const Cubic cubic = {p[0], p[0] + 2 * (p[1] - p[0]), p[6] - 2 * (p[6] - p[5]), p[6]};
  const Sextic raised = multiply(cubic, Cubic{1, 1, 1, 1});
  double error = 0;
  for (std::size_t k = 0; k < p.size(); ++k) error = std::fmax(error, std::fabs(p[k] - raised[k]));
  return error;
}

// Returns true if the weight of every correction target is linear in time between all keys. A weight is linear if it is
// no product of two weights, or if one of the two weights is constant between the keys.
bool extras_are_linear(const WeightTrack& track, std::span<const ExtraWeight> extras) {
  for (std::size_t key = 0; key + 1 < track.size(); ++key) {
    const auto moves = [&](std::size_t target) { return track.value(key, target) != track.value(key + 1, target); };
    for (const ExtraWeight& extra : extras) {
      if (extra.quadratic != 0 && moves(extra.i) && moves(extra.j)) return false;
    }
  }
  return true;
}

// Writes the weights at all keys without tangents, for LINEAR and STEP tracks and for tracks with one key.
void append_values(const WeightTrack& track, std::span<const ExtraWeight> extras, std::vector<float>& values) {
  for (std::size_t key = 0; key < track.size(); ++key) {
    for (std::size_t i = 0; i < track.targets; ++i) values.push_back(static_cast<float>(track.value(key, i)));
    for (const ExtraWeight& extra : extras)
      values.push_back(to_file(extra.at(track.value(key, extra.i), track.value(key, extra.j))));
  }
}

// A cubic spline that is built key by key. Each key has a row of knots, one for each column of weights.
class Spline {
 public:
  explicit Spline(std::size_t columns) : columns_(columns) {}

  // Adds a key at a time in seconds. The slopes at the key are 0 until a piece sets them.
  void add_key(double time) {
    times_.push_back(static_cast<float>(time));
    knots_.resize(knots_.size() + columns_);
  }
  void clear() { *this = Spline(columns_); }
  Knot& last(std::size_t column) { return knots_[knots_.size() - columns_ + column]; }
  Knot& before(std::size_t column) { return knots_[knots_.size() - 2 * columns_ + column]; }

  void write(ExtendedTrack& result) && {
    result.values.reserve(3 * knots_.size());
    for (std::size_t key = 0; key < times_.size(); ++key) {
      const Knot* row = knots_.data() + key * columns_;
      for (std::size_t c = 0; c < columns_; ++c) result.values.push_back(to_file(row[c].in));
      for (std::size_t c = 0; c < columns_; ++c) result.values.push_back(to_file(row[c].value));
      for (std::size_t c = 0; c < columns_; ++c) result.values.push_back(to_file(row[c].out));
    }
    result.times = std::move(times_);
  }

 private:
  std::size_t columns_;
  std::vector<float> times_;
  std::vector<Knot> knots_;  // (keys, columns), row by row
};

class TrackExtender {
 public:
  TrackExtender(const WeightTrack& track, std::span<const ExtraWeight> extras, double tolerance, std::size_t most_keys)
      : track_(track),
        extras_(extras),
        tolerance_(tolerance),
        most_keys_(most_keys),
        spline_(track.targets + extras.size()) {}

  ExtendedTrack spline() {
    ExtendedTrack result;
    result.interpolation = GltfInterpolation::kCubicSpline;
    add_first_key();
    for (std::size_t key = 0; key + 1 < track_.size(); ++key) {
      pieces_.clear();
      for (std::size_t i = 0; i < track_.targets; ++i) pieces_.push_back(track_.piece(key, i));
      add_pieces(track_.keys.times[key], track_.keys.times[key + 1], pieces_, kMostHalvings);
    }
    result.keys = keys_;
    if (keys_ > most_keys_) return result;
    // Keeps the file's slopes before the first key and after the last key, although these slopes have no effect.
    if (track_.interpolation == GltfInterpolation::kCubicSpline) {
      for (std::size_t i = 0; i < track_.targets; ++i) spline_.last(i).out = track_.tangent(track_.size() - 1, true, i);
    }
    std::move(spline_).write(result);
    if (result.times.size() == track_.size()) result.times.clear();
    result.error = std::fmax(error_, error_of_clamping(result.values));
    return result;
  }

 private:
  void add_first_key() {
    spline_.add_key(track_.keys.times[0]);
    for (std::size_t i = 0; i < track_.targets; ++i) {
      spline_.last(i).value = track_.value(0, i);
      if (track_.interpolation == GltfInterpolation::kCubicSpline) spline_.last(i).in = track_.tangent(0, false, i);
    }
    for (std::size_t p = 0; p < extras_.size(); ++p)
      spline_.last(track_.targets + p).value =
          extras_[p].at(track_.value(0, extras_[p].i), track_.value(0, extras_[p].j));
  }

  // Adds the key at time `to`, and the keys that are needed between `from` and `to`.
  void add_pieces(double from, double to, const std::vector<Cubic>& weights, int halvings) {
    double error = 0, rounding = 0;
    for (const ExtraWeight& extra : extras_) {
      const Sextic exact = extra_weight(extra, weights);
      error += extra.gain * cubic_error(exact);
      for (const double b : exact) rounding = std::fmax(rounding, 1e-7 * extra.gain * std::fabs(b));
    }
    // Rounds the time of a new key to float32, because the file stores times as float32.
    const double middle = static_cast<double>(static_cast<float>(from + (to - from) / 2));
    if (track_.interpolation == GltfInterpolation::kCubicSpline && error > std::fmax(tolerance_, rounding) &&
        halvings > 0 && from < middle && middle < to) {
      const double t = (middle - from) / (to - from);
      std::vector<Cubic> before(weights.size()), after(weights.size());
      for (std::size_t i = 0; i < weights.size(); ++i) {
        const auto halves = split(weights[i], t);
        before[i] = halves.before;
        after[i] = halves.after;
      }
      add_pieces(from, middle, before, halvings - 1);
      add_pieces(middle, to, after, halvings - 1);
      return;
    }
    if (track_.interpolation == GltfInterpolation::kCubicSpline) error_ = std::fmax(error_, error);
    add_piece(to - from, to, weights);
  }

  void add_piece(double duration, double to, const std::vector<Cubic>& weights) {
    // Stops storing keys if there are too many, and only counts further keys.
    if (++keys_ > most_keys_) return spline_.clear();
    spline_.add_key(to);
    for (std::size_t i = 0; i < weights.size(); ++i) {
      spline_.before(i).out = slope_at_start(weights[i], duration);
      spline_.last(i).in = slope_at_end(weights[i], duration);
      spline_.last(i).value = weights[i][3];
    }
    for (std::size_t p = 0; p < extras_.size(); ++p) {
      const std::size_t column = weights.size() + p;
      const ExtraWeight& extra = extras_[p];
      const Cubic &a = weights[extra.i], &b = weights[extra.j];
      spline_.before(column).out =
          slope_of(extra, a[0], b[0], slope_at_start(a, duration), slope_at_start(b, duration));
      spline_.last(column).in = slope_of(extra, a[3], b[3], slope_at_end(a, duration), slope_at_end(b, duration));
      spline_.last(column).value = extra.at(a[3], b[3]);
    }
  }

  const WeightTrack& track_;
  std::span<const ExtraWeight> extras_;
  double tolerance_;
  std::size_t most_keys_, keys_ = 1;  // keys_: the number of keys so far, including the first
  Spline spline_;
  std::vector<Cubic> pieces_;
  double error_ = 0;
};

}  // namespace

float to_file(double number) noexcept { return static_cast<float>(std::clamp(number, -kMost, kMost)); }

GltfExtraTarget ExtraWeight::as_target(std::size_t target) const {
  GltfExtraTarget result{target, {}, {}};
  if (linear != 0) result.linear.push_back({i, linear});
  if (quadratic != 0) result.quadratic.push_back({i, j, quadratic});
  return result;
}

ExtendedTrack extended_track(const WeightTrack& track, std::span<const ExtraWeight> extras, double tolerance,
                             std::size_t most_keys) {
  const bool is_spline = track.interpolation == GltfInterpolation::kCubicSpline && track.size() > 1;
  const bool becomes_one = track.interpolation == GltfInterpolation::kLinear && !extras_are_linear(track, extras);
  if (is_spline || becomes_one) return TrackExtender(track, extras, tolerance, most_keys).spline();
  ExtendedTrack result;
  result.keys = track.size();
  if (result.keys > most_keys) return result;
  result.interpolation = track.interpolation;
  if (track.interpolation != GltfInterpolation::kCubicSpline) {
    append_values(track, extras, result.values);
    result.error = error_of_clamping(result.values);
    return result;
  }
  // In a spline with one key, slopes have no effect, so the slopes of correction targets stay 0.
  const std::size_t columns = track.targets + extras.size();
  result.values.assign(3 * columns, 0.0F);
  for (std::size_t i = 0; i < track.targets; ++i) {
    result.values[i] = static_cast<float>(track.tangent(0, false, i));
    result.values[columns + i] = static_cast<float>(track.value(0, i));
    result.values[2 * columns + i] = static_cast<float>(track.tangent(0, true, i));
  }
  for (std::size_t p = 0; p < extras.size(); ++p)
    result.values[columns + track.targets + p] =
        to_file(extras[p].at(track.value(0, extras[p].i), track.value(0, extras[p].j)));
  return result;
}

ExtendedTrack straight_track(const WeightTrack& track, std::span<const ExtraWeight> extras,
                             std::span<const std::uint32_t> pieces, std::size_t most_keys) {
  const auto extras_at = [&](std::size_t, double, std::span<const double> own, std::span<double> weights) {
    for (std::size_t k = 0; k < extras.size(); ++k) weights[k] = extras[k].at(own[extras[k].i], own[extras[k].j]);
  };
  return straight_track(track, extras.size(), extras_at, pieces, most_keys);
}

ExtendedTrack straight_track(const WeightTrack& track, std::size_t extra_count, const ExtrasAt& extras_at,
                             std::span<const std::uint32_t> pieces, std::size_t most_keys) {
  ExtendedTrack result;
  result.interpolation = GltfInterpolation::kLinear;
  result.keys = track.size();
  for (const std::uint32_t count : pieces) result.keys += count - 1;
  if (result.keys > most_keys) return result;
  std::vector<float> times;
  std::vector<double> weights(track.targets), of_extras(extra_count);
  const auto add_key = [&](float time, std::size_t key, double part) {
    times.push_back(time);
    for (const double weight : weights) result.values.push_back(to_file(weight));
    extras_at(key, part, weights, of_extras);
    for (const double weight : of_extras) result.values.push_back(to_file(weight));
  };
  for (std::size_t key = 0; key < track.size(); ++key) {
    const double from = track.keys.times[key];
    for (std::size_t i = 0; i < track.targets; ++i) weights[i] = track.value(key, i);
    add_key(static_cast<float>(from), key, 0);
    if (key + 1 == track.size()) break;
    const double to = track.keys.times[key + 1];
    for (std::uint32_t piece = 1; piece < pieces[key]; ++piece) {
      // Rounds the time of a new key to float32, because the file stores times as float32.
      const auto time = static_cast<float>(from + (to - from) * piece / pieces[key]);
      if (!(times.back() < time && static_cast<double>(time) < to)) continue;
      const double t = (static_cast<double>(time) - from) / (to - from);
      for (std::size_t i = 0; i < track.targets; ++i)
        weights[i] = (1 - t) * track.value(key, i) + t * track.value(key + 1, i);
      add_key(time, key, t);
    }
  }
  result.keys = times.size();
  if (times.size() > track.size()) result.times = std::move(times);
  result.error = error_of_clamping(result.values);
  return result;
}

WeightTrack as_track(const WeightTrack& before, const ExtendedTrack& extended, std::size_t extra_count) {
  WeightTrack result{extended.interpolation, {}, before.targets + extra_count};
  if (extended.times.empty())
    result.keys.times = before.keys.times;
  else
    result.keys.times.assign(extended.times.begin(), extended.times.end());
  result.keys.values.assign(extended.values.begin(), extended.values.end());
  return result;
}

}  // namespace chronormal::inline internal
