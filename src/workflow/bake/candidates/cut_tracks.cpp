#include "workflow/bake/candidates/cut_tracks.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>
#include <vector>

#include "core/blocks.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kMostPieces = 16, kMostKeys = 20000;
// Splines may leave this many times what straight pieces may: their bound is the sum of all errors, as if they came at
// once.
constexpr double kPartOfSplines = 2;

// Returns, for each gap between keys, the angle in radians by which straight lines of correction weights turn normals.
// A straight line has its largest error in the middle of the gap: a quarter of its second difference.
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

// Splits the gaps of a LINEAR track until straight pieces of correction weights turn no normal by more than the
// tolerance (radians), within a limit of pieces. Raises `left` to the angle by which they still turn one.
std::vector<std::uint32_t> pieces_of(const RightNormals& rights, const WeightTrack& track, std::size_t extra_count,
                                     const ExtrasAt& extras_at, std::span<const std::uint32_t> vertices,
                                     const VertexColumns& columns, double tolerance, double& left) {
  const std::vector<double> of_gaps = middle_errors(rights, track, extra_count, extras_at, vertices, columns);
  // A gap gets at most `most` pieces; `most` falls until all gaps together keep to the limit.
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

// Sets the gain of each formula: the largest angle by which a normal turns if the weight has an error of 1 and the
// normal is as long as the stored one.
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

void cut_tracks(const RightNormals& rights, const MeshWeights& weights, std::span<const Viewer> viewers,
                std::span<const std::uint32_t> vertices, double tolerance, Candidate& candidate) {
  ExtraDrivers& drivers = candidate.drivers;
  if (drivers.size() == 0) return;
  const VertexColumns columns = columns_of(candidate, vertices);
  const bool play_splines = std::all_of(viewers.begin(), viewers.end(), [](const Viewer& viewer) {
    return viewer.tracks == TrackRule::kSpecified && viewer.weight_bits == 32;
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
    candidate.track_error = std::fmax(candidate.track_error, of_pieces);
  }
}

}  // namespace chronormal::inline internal
