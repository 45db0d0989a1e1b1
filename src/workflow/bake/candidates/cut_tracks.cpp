#include "workflow/bake/candidates/cut_tracks.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "analysis/quality/kernels/blended_normals.h"
#include "core/bits.h"
#include "core/blocks.h"
#include "workflow/bake/fits/missing_normals.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kMostPieces = 16, kMostKeys = 20000, kTurnBlock = 256;
// The factor by which the estimated error of a spline may exceed the limit for straight pieces. The estimate is too
// high, because it adds up all errors as if they came at the same moment.
constexpr double kPartOfSplines = 2;

// Returns for each gap between keys the largest angle, in radians, by which linear correction weights turn a normal
// away from the normal with exact weights. Measures in the middle of the gap, where this angle is largest.
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
  // Lays out the weights of poses in rows: one row for each target and each correction target, with one entry for each
  // pose.
  const std::size_t poses = middles.size(), stride = block_count(poses, kPosePadding) * kPosePadding;
  const auto rows_of = [&](const PoseList& of) {
    std::vector<float> rows((track.targets + extra_count) * stride);
    for (std::size_t p = 0; p < poses; ++p)
      for (std::size_t c = 0; c < of[p].size(); ++c) rows[c * stride + p] = static_cast<float>(of[p][c]);
    return rows;
  };
  const std::vector<float> of_middles = rows_of(middles), of_lack = rows_of(lack);
  // Calls visit(p, openness) for the n-th vertex in each pose p. The openness grows with the angle between two normals:
  // the normal with exact correction weights, and the normal with correction weights that are linear in the gap.
  const auto turn = [&](std::size_t n, const auto& visit) {
    thread_local std::vector<WeightedVector> shown_terms, off_terms;
    thread_local std::vector<float> shown, off;
    shown_terms.clear();
    off_terms.clear();
    for (const auto& [column, delta] : columns.of(n)) {
      shown_terms.push_back({of_middles.data() + column * stride, 0, poses, delta});
      if (column >= track.targets) off_terms.push_back({of_lack.data() + column * stride, 0, poses, delta});
    }
    if (off_terms.empty()) return;
    for (std::vector<float>* const planes : {&shown, &off}) planes->resize(3 * stride);
    add_weighted(to_float(rights.stored(vertices[n])), shown_terms, shown.data(), stride);
    add_weighted({}, off_terms, off.data(), stride);
    const auto at = [stride](const std::vector<float>& planes, std::size_t p) {
      return Vec3f{planes[p], planes[stride + p], planes[2 * stride + p]};
    };
    for (std::size_t p = 0; p < poses; ++p) visit(p, openness(at(shown, p), at(shown, p) + at(off, p)));
  };
  // For each pose, the largest openness (a measure of the angle) in the upper 32 bits, and the index of its vertex in
  // the lower 32 bits.
  std::vector<std::atomic<std::uint64_t>> worst(poses);
  const auto note = [&](std::size_t n, std::size_t p, float open) {
    const std::uint64_t found = std::uint64_t{bit_cast<std::uint32_t>(open)} << 32 | n;
    std::atomic<std::uint64_t>& most = worst[p];
    for (std::uint64_t known = most; open > 0 && known < found && !most.compare_exchange_weak(known, found);) continue;
  };
  parallel_each(vertices.size(), kTurnBlock,
                [&](std::size_t n) { turn(n, [&](std::size_t p, float open) { note(n, p, open); }); });
  // Leaves out vertices whose true normal has no direction. Such vertices are rare, so only the vertex with the largest
  // error in each pose is checked. If the true normal of this vertex has no direction, all vertices are measured again
  // in this pose.
  std::vector<std::size_t> again;
  PoseList poses_again;
  for (std::size_t p = 0; p < poses; ++p) {
    const std::uint32_t vertex = vertices[worst[p] & 0xffffffffU];
    rights.for_each({&vertex, 1}, {middles[p]}, [&](std::size_t, std::size_t, std::span<const Vec3f> right) {
      if (right[0] != Vec3f{}) return;
      again.push_back(p);
      poses_again.push_back(middles[p]);
      worst[p] = 0;
    });
  }
  rights.for_each(vertices, poses_again, [&](std::size_t n, std::size_t first, std::span<const Vec3f> right) {
    turn(n, [&](std::size_t p, float open) {
      const auto at = static_cast<std::size_t>(std::lower_bound(again.begin(), again.end(), p) - again.begin());
      if (first <= at && at < first + right.size() && again[at] == p && right[at - first] != Vec3f{}) note(n, p, open);
    });
  });
  std::vector<double> result;
  for (const std::atomic<std::uint64_t>& most : worst)
    result.push_back(degrees_of(bit_cast<float>(static_cast<std::uint32_t>(most >> 32))) / kDegreesPerRadian);
  return result;
}

// Returns the number of straight pieces for each gap of a LINEAR track. With this number, linear correction weights
// turn no normal by more than the tolerance (radians), unless the limit of pieces is too low. Raises `left` to the
// largest angle that remains, in radians.
std::vector<std::uint32_t> pieces_of(const RightNormals& rights, const WeightTrack& track, std::size_t extra_count,
                                     const ExtrasAt& extras_at, std::span<const std::uint32_t> vertices,
                                     const VertexColumns& columns, double tolerance, double& left) {
  const std::vector<double> of_gaps = middle_errors(rights, track, extra_count, extras_at, vertices, columns);
  // Allows at most `most` pieces for each gap, and reduces this number until the pieces of all gaps together are within
  // the limit.
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

// Sets the gain of each formula for the weight of a correction target. The gain is the largest angle by which a normal
// turns if this weight has an error of 1 and the normal is as long as the stored normal.
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
