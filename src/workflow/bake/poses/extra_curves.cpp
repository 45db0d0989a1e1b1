// Computes the weights of correction targets from curves, and adds these weights to tracks. A parabola has the values
// a, m, b at the start, the middle and the end of a piece. Its slopes are 4m - 3a - b at the start and a - 4m + 3b at
// the end, and a cubic spline with these tangents is the parabola.
#include "workflow/bake/poses/extra_curves.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "chronormal/core/polynomial.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kFewestPieces = 2, kMostPieces = 8;
// The largest allowed distance between the square of a weight and the parabolas that approximate this square, measured
// at kPlacesOfPiece places of each piece.
constexpr double kNearParabola = 0.002;
constexpr int kPlacesOfPiece = 4;

// Returns the largest distance between the square of a weight and the parabolas that approximate this square, if a gap
// has `pieces` pieces.
double distance_of_parabolas(const std::array<double, 4>& weight, std::size_t pieces) {
  const auto square = [&weight](double t) {
    const double w = evaluate(weight, t);
    return w * w;
  };
  double most = 0;
  for (std::size_t piece = 0; piece < pieces; ++piece) {
    const auto at = [&](double part) { return (static_cast<double>(piece) + part) / static_cast<double>(pieces); };
    const double a = square(at(0)), m = square(at(0.5)), b = square(at(1));
    for (int place = 0; place < kPlacesOfPiece; ++place) {
      const double t = (place + 0.5) / kPlacesOfPiece;
      const double parabola = (1 - t) * (1 - 2 * t) * a + 4 * t * (1 - t) * m + t * (2 * t - 1) * b;
      most = std::fmax(most, std::fabs(parabola - square(at(t))));
    }
  }
  return most;
}

// Returns the number of pieces into which each gap between keys of a cubic spline is split.
std::size_t pieces_of_spline(const WeightTrack& track) {
  std::size_t pieces = kFewestPieces;
  for (std::size_t key = 0; key + 1 < track.size(); ++key) {
    for (std::size_t i = 0; i < track.targets; ++i) {
      const std::array<double, 4> weight = track.piece(key, i);
      while (pieces < kMostPieces && distance_of_parabolas(weight, pieces) > kNearParabola) pieces *= 2;
    }
  }
  return pieces;
}

// The weights of all targets at one key of a spline, and their slopes before and after the key, per second.
struct SplineKey {
  double time = 0;
  std::vector<double> in, value, out;
};

ExtendedTrack spline_with_curves(const WeightTrack& track, const ExtraCurves& curves, std::size_t most_keys) {
  const CurveNodes nodes(track, curves);
  const std::size_t columns = track.targets + curves.extras, pieces = nodes.pieces();
  const bool is_spline = track.interpolation == GltfInterpolation::kCubicSpline;
  ExtendedTrack result;
  result.interpolation = GltfInterpolation::kCubicSpline;
  result.keys = pieces * (track.size() - 1) + 1;
  if (result.keys > most_keys) return result;
  std::vector<SplineKey> keys;
  const auto add_key = [&](double time) {
    const std::vector<double> zeros(columns);
    keys.push_back({static_cast<double>(static_cast<float>(time)), zeros, zeros, zeros});
  };
  add_key(track.keys.times[0]);
  for (std::size_t i = 0; i < track.targets; ++i) {
    keys[0].value[i] = track.value(0, i);
    if (is_spline) keys[0].in[i] = track.tangent(0, false, i);
  }
  for (std::size_t k = 0; k < curves.extras; ++k) keys[0].value[track.targets + k] = curves.of(0)[k];
  for (std::size_t key = 0; key + 1 < track.size(); ++key) {
    const double from = track.keys.times[key], to = track.keys.times[key + 1];
    std::vector<std::array<double, 4>> rest(track.targets);
    for (std::size_t i = 0; i < track.targets; ++i) rest[i] = track.piece(key, i);
    double start = 0;  // the start of the piece, as a part of the gap from 0 to 1
    for (std::size_t piece = 0; piece < pieces; ++piece) {
      const bool is_last = piece + 1 == pieces;
      // Rounds the time of a new key to float32, because the file stores times as float32.
      const double part = static_cast<double>(piece + 1) / static_cast<double>(pieces);
      const double time = is_last ? to : static_cast<double>(static_cast<float>(from + (to - from) * part));
      if (!is_last && !(keys.back().time < time && time < to)) continue;
      const double end = is_last ? 1 : (time - from) / (to - from), seconds = (end - start) * (to - from);
      const auto slope = [&](double rise) { return seconds > 0 ? rise / seconds : 0; };
      add_key(time);
      SplineKey &before = keys[keys.size() - 2], &after = keys.back();
      for (std::size_t i = 0; i < track.targets; ++i) {
        const auto halves = split(rest[i], is_last ? 1.0 : (end - start) / (1 - start));
        const std::array<double, 4>& b = is_last ? rest[i] : halves.before;
        before.out[i] = slope(3 * (b[1] - b[0]));
        after.in[i] = slope(3 * (b[3] - b[2]));
        after.value[i] = b[3];
        if (!is_last) rest[i] = halves.after;
      }
      std::vector<double> middle(curves.extras), last(curves.extras);
      curves.at(nodes, key, (start + end) / 2, middle);
      curves.at(nodes, key, end, last);
      for (std::size_t k = 0; k < curves.extras; ++k) {
        const std::size_t column = track.targets + k;
        const double a = before.value[column], m = middle[k], b = last[k];
        before.out[column] = slope(4 * m - 3 * a - b);
        after.in[column] = slope(a - 4 * m + 3 * b);
        after.value[column] = b;
      }
      start = end;
    }
  }
  for (std::size_t i = 0; i < track.targets && is_spline; ++i)
    keys.back().out[i] = track.tangent(track.size() - 1, true, i);
  for (const SplineKey& key : keys) {
    result.times.push_back(static_cast<float>(key.time));
    for (const std::vector<double>* numbers : {&key.in, &key.value, &key.out})
      for (const double number : *numbers) result.values.push_back(to_file(number));
  }
  result.keys = keys.size();
  if (result.times.size() == track.size()) result.times.clear();
  return result;
}

}  // namespace

CurveNodes::CurveNodes(const WeightTrack& track) : keys_(track.size()), pieces_(0) {
  if (track.size() < 2 || track.interpolation == GltfInterpolation::kStep) return;
  pieces_ = track.interpolation == GltfInterpolation::kLinear ? track.pieces_of_line : pieces_of_spline(track);
}

CurveNodes::CurveNodes(const WeightTrack& track, const ExtraCurves& curves) : CurveNodes(track) {
  if (pieces_ > 0 && curves.extras > 0) pieces_ = (curves.values.size() / curves.extras - 1) / (2 * (keys_ - 1));
}

std::vector<double> CurveNodes::pose(const WeightTrack& track, std::size_t node) const {
  std::vector<double> result(track.targets);
  const std::size_t of_gap = std::max<std::size_t>(1, 2 * pieces_), key = node / of_gap, step = node % of_gap;
  for (std::size_t i = 0; i < track.targets; ++i) {
    result[i] = step == 0 ? track.value(key, i)
                          : evaluate(track.piece(key, i), static_cast<double>(step) / static_cast<double>(of_gap));
  }
  return result;
}

CurveNodes::Place CurveNodes::place(std::size_t key, double part) const noexcept {
  if (pieces_ == 0) return {{key, key, key}, {1, 0, 0}};
  if (key + 1 == keys_) return {{size() - 1, size() - 1, size() - 1}, {1, 0, 0}};
  const double along = part * static_cast<double>(pieces_);
  const std::size_t piece = std::min(pieces_ - 1, static_cast<std::size_t>(along));
  const double t = along - static_cast<double>(piece);
  const std::size_t first = 2 * (pieces_ * key + piece);
  return {{first, first + 1, first + 2}, {(1 - t) * (1 - 2 * t), 4 * t * (1 - t), t * (2 * t - 1)}};
}

void ExtraCurves::at(const CurveNodes& nodes, std::size_t key, double part, std::span<double> weights) const {
  const CurveNodes::Place place = nodes.place(key, part);
  for (std::size_t k = 0; k < extras; ++k) {
    weights[k] = 0;
    for (std::size_t n = 0; n < place.nodes.size(); ++n) weights[k] += place.factors[n] * of(place.nodes[n])[k];
  }
}

ExtendedTrack track_with_curves(const WeightTrack& track, const ExtraCurves& curves,
                                std::span<const std::uint32_t> pieces, std::size_t most_keys) {
  const CurveNodes nodes(track, curves);
  if (nodes.pieces() > 0 && (track.interpolation == GltfInterpolation::kCubicSpline || pieces.empty()))
    return spline_with_curves(track, curves, most_keys);
  if (nodes.pieces() > 0) {
    const auto extras_at = [&](std::size_t key, double part, std::span<const double>, std::span<double> weights) {
      curves.at(nodes, key, part, weights);
    };
    return straight_track(track, curves.extras, extras_at, pieces, most_keys);
  }
  ExtendedTrack result;
  result.interpolation = track.interpolation;
  result.keys = track.size();
  if (result.keys > most_keys) return result;
  const bool is_spline = track.interpolation == GltfInterpolation::kCubicSpline;  // then it has one key
  for (std::size_t key = 0; key < track.size(); ++key) {
    const auto append_tangents = [&](bool out) {
      for (std::size_t i = 0; i < track.targets; ++i) result.values.push_back(to_file(track.tangent(key, out, i)));
      result.values.insert(result.values.end(), curves.extras, 0.0F);
    };
    if (is_spline) append_tangents(false);
    for (std::size_t i = 0; i < track.targets; ++i) result.values.push_back(to_file(track.value(key, i)));
    for (const double weight : curves.of(key)) result.values.push_back(to_file(weight));
    if (is_spline) append_tangents(true);
  }
  return result;
}

PoseList ExtraDrivers::standing(const PoseList& poses) const {
  PoseList result;
  for (std::size_t n = 0; n < poses.size(); ++n) {
    result.push_back(with_extras(poses[n]));
    if (n < rest.size())
      std::copy(rest[n].begin(), rest[n].end(), result.back().end() - static_cast<std::ptrdiff_t>(size()));
  }
  return result;
}

ExtendedTrack ExtraDrivers::extended(const TrackName& name, const WeightTrack& track, double tolerance,
                                     std::size_t most_keys) const {
  const auto cut = pieces.find(name);
  const auto curve = curves.find(name);
  const std::span<const std::uint32_t> of_gaps =
      cut == pieces.end() ? std::span<const std::uint32_t>() : std::span<const std::uint32_t>(cut->second);
  if (curve != curves.end()) return track_with_curves(track, curve->second, of_gaps, most_keys);
  if (cut != pieces.end()) return straight_track(track, formulas, of_gaps, most_keys);
  return extended_track(track, formulas, std::fmin(tolerance, spline_tolerance), most_keys);
}

std::vector<double> ExtraDrivers::with_extras(std::vector<double> own) const {
  const std::size_t targets = own.size();
  own.reserve(targets + size());
  for (std::size_t k = 0; k < size(); ++k) {
    const ExtraWeight& of_one = formulas[k];
    own.push_back(sums.empty() ? of_one.at(own[of_one.i], own[of_one.j])
                               : sums[k].weight(std::span(own).first(targets)));
  }
  return own;
}

GltfExtraTarget ExtraDrivers::as_target(std::size_t k, std::size_t index) const {
  GltfExtraTarget result = sums.empty() ? formulas[k].as_target(index) : sums[k];
  result.target = index;
  return result;
}

}  // namespace chronormal::inline internal
