// Makes correction targets of low rank. They correct the errors of a mesh's own deltas along the animations of a file.
// The errors are written as the sum of a few deltas whose weights are curves in time (docs/theory.md, section 17).
//
//     n(w(t)) / |n(0)|  =  N + sum_i w_i(t) D_i + sum_k s_k(t) E_k, nearly
//
// N is the stored normal, and D_i are the deltas of the mesh's own targets. The missing normals are the difference
// between n(w) and N + sum_i w_i D_i. Their leading left singular vectors are the curves s_k, and the right singular
// vectors are the deltas E_k. A point counts more if its n(w) gets short. If a point still has a large error, its own
// E_k are fitted again by least squares of the angles. In this fit the length of n(w) is free at every instant, and
// instants with large errors count more.
//
// A row is an instant at which curves have a node (extra_curves.h). If there are too many nodes, only the nodes of some
// gaps between keys, and of some tracks, become rows. The values of the curves at all other nodes follow from the
// deltas by least squares.
#include "workflow/bake/candidates/makers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "analysis/fits/kernels/products.h"
#include "core/blocks.h"
#include "core/cholesky.h"
#include "core/portable_math.h"
#include "workflow/bake/candidates/cut_tracks.h"
#include "workflow/bake/deltas/unit_targets.h"
#include "workflow/bake/deltas/vertex_columns.h"
#include "workflow/bake/fits/low_rank_fit.h"
#include "workflow/bake/fits/missing_normals.h"
#include "workflow/bake/poses/played_poses.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kMostRows = 480, kBytes = std::size_t{700} << 20, kFewestRows = 48;
constexpr std::size_t kRowsAtOnce = 64, kFormBlock = 16;
// Errors in a fit, as parts of the tolerance. An error below kPartOfNeed needs no correction. With singular vectors
// alone, 99.9 % of all samples should have errors up to kPartOfSingular. After least squares, no error should be above
// kPartOfWorst.
constexpr double kPartOfNeed = 0.05, kPartOfSingular = 0.36, kPartOfWorst = 0.85;
constexpr double kMoreExtras = 1.2;
// Limits for a fit that misses the tolerance with every tried number of correction targets. The fit then takes the
// smallest number whose error is at most kNoGain times the smallest error of all tried numbers, provided that at least
// kManyMore times as many targets were tried.
constexpr double kNoGain = 1.05;
constexpr std::size_t kManyMore = 2;
// Positions in a gap between keys, from 0 to 1, at which a fit is checked. The fit does not use these positions.
constexpr std::array<double, 2> kUnseen = {0.11, 0.63};
constexpr int kFits = 4;
// The largest angle by which a normal may turn if an entry of a delta is left out, relative to the tolerance.
constexpr double kPartOfEntry = 1.0 / 2000;
constexpr double kLeastRidge = 1e-9;
constexpr std::array<std::size_t, 23> kCounts = {1,  2,  3,  4,  6,  8,  10, 12, 14, 16, 20, 24,
                                                 28, 32, 36, 40, 44, 48, 56, 64, 80, 96, 128};

// A correction target that is made from the correction target with the index `of`. Its weight is `factor` times the
// weight of the other target. If above_zero is true, negative weights become 0.
struct Share {
  std::size_t of = 0;
  double factor = 1;
  bool above_zero = false;
  VertexVectors vectors;
};

// The way in which deltas E of correction targets are shortened, for viewers that limit the length of deltas. N is the
// stored normal.
struct ShortShares {
  bool are_units = false;   // if true, N + E has the length of N, so that viewers that store directions keep E
  bool keep_along = false;  // if true, keeps the part of E along N
};

struct LowRank {
  std::vector<VertexVectors> own;     // deltas of each target of the mesh
  std::vector<VertexVectors> extras;  // deltas of correction targets, of any length; their weights are from -1 to 1
  TrackCurves curves;                 // weights of the correction targets over time, for each track
  PoseList rest;                      // weights of the correction targets in the poses that the file stores
  double worst = 0;                   // degrees: the largest error of any point at the fitted instants
};

struct LowRankLimits {
  std::size_t most_extras = 0;
  double tolerance = 0;       // degrees: correction targets are added until no sample has a larger error
  bool keeps_across = false;  // if true, correction targets correct only what is missing across N
  bool refits_own = false;    // if true, own deltas are fitted to the animations too, and to nothing else
};

// The rows of a fit: the instants of the file to which the weights and deltas are fitted.
struct Rows {
  std::vector<std::size_t> instants;  // the indices of these instants in FileInstants, ascending
  std::vector<PlaceOfRows> places;    // instants half-way between neighbouring nodes of a piece
  std::vector<PlaceOfRows> unseen;    // other instants, at which the fit is checked
};

// Returns the tracks that are used if a fit may have at most `most` rows. If all tracks would need more rows, leaves
// out tracks, so that each remaining track can have rows in about one gap between keys. telling_tracks()
// (poses/played_poses.h) chooses the tracks that remain.
std::vector<std::size_t> tracks_within(const FileInstants& all, const std::vector<WeightTrack>& tracks,
                                       std::size_t most) {
  std::size_t least = 0;
  for (const CurveNodes& nodes : all.tracks) least += 2 * nodes.pieces() + 1;
  const std::size_t some = least > most ? tracks.size() * most / least : tracks.size();
  return telling_tracks(tracks, std::max<std::size_t>(1, some));
}

Rows choose_rows(const FileInstants& all, const std::vector<WeightTrack>& tracks, std::size_t most) {
  const std::size_t standing = all.first.back();
  const double share = std::fmin(1, static_cast<double>(most) / static_cast<double>(all.poses.size()));
  Rows rows;
  std::vector<std::optional<std::size_t>> row_of(all.poses.size());
  const auto take = [&](std::size_t instant) {
    if (row_of[instant]) return;
    row_of[instant] = rows.instants.size();
    rows.instants.push_back(instant);
  };
  for (const std::size_t t : tracks_within(all, tracks, most)) {
    const std::size_t nodes = all.tracks[t].size(), first = all.first[t], pieces = all.tracks[t].pieces();
    // Estimates the number of keys for which there are enough rows. A piece of a curve takes three rows if its
    // neighbours are left out. Otherwise it takes two rows, because neighbouring pieces share a row.
    const auto of_share = static_cast<std::size_t>(2 * share / 3 * static_cast<double>(tracks[t].size()));
    std::vector<std::size_t> keys(tracks[t].size());
    std::iota(keys.begin(), keys.end(), std::size_t{0});
    if (share < 1) keys = telling_keys(tracks[t], std::max<std::size_t>(1, of_share));
    if (pieces == 0) {
      for (const std::size_t key : keys) take(first + key);
      continue;
    }
    std::vector<std::size_t> of_pieces;  // the index of the first node of each piece
    for (const std::size_t key : keys)
      for (std::size_t piece = 0; piece < pieces; ++piece) of_pieces.push_back(2 * (pieces * key + piece));
    for (const std::size_t node : of_pieces) {
      if (node + 2 >= nodes) continue;
      for (std::size_t n = 0; n < 3; ++n) take(first + node + n);
      const std::array<std::size_t, 3> of = {*row_of[first + node], *row_of[first + node + 1],
                                             *row_of[first + node + 2]};
      rows.places.push_back({of, {0.375, 0.75, -0.125}});
      rows.places.push_back({of, {-0.125, 0.75, 0.375}});
      for (const double part : kUnseen)
        rows.unseen.push_back({of, {(1 - part) * (1 - 2 * part), 4 * part * (1 - part), part * (2 * part - 1)}});
    }
  }
  for (std::size_t n = standing; n < all.poses.size() && n < standing + most; ++n) take(n);
  return rows;
}

PoseList poses_of(const FileInstants& all, std::span<const std::size_t> instants) {
  PoseList poses;
  for (const std::size_t n : instants) poses.push_back(all.poses[n]);
  return poses;
}

std::vector<float> own_weights(const PoseList& poses) {
  std::vector<float> result;
  for (const std::vector<double>& pose : poses) result.insert(result.end(), pose.begin(), pose.end());
  return result;
}

// Returns for each point (vertices with the same normal) a change of the deltas of the mesh's own targets, (3,
// targets). The change is found by least squares over all rows (instants).
std::vector<float> refitted_own(MissingNormals& missing, std::size_t targets) {
  const std::vector<float> weights = own_weights(missing.poses());
  std::vector<double> matrix(targets * targets, 0.0);
  double trace = 0;
  for (std::size_t i = 0; i < targets; ++i) {
    for (std::size_t j = 0; j < targets; ++j)
      for (std::size_t r = 0; r < missing.rows(); ++r)
        matrix[i * targets + j] += static_cast<double>(weights[r * targets + i] * weights[r * targets + j]);
    trace += matrix[i * targets + i];
  }
  const double ridge = std::fmax(1e-6 * trace / static_cast<double>(targets), kLeastRidge);
  for (std::size_t i = 0; i < targets; ++i) matrix[i * targets + i] += ridge;
  const Cholesky factors(std::move(matrix), targets, ridge);
  std::vector<float> result(missing.points() * 3 * targets);
  parallel_each(missing.points(), kFormBlock, [&](std::size_t p) {
    std::vector<Vec3d> of(targets);
    const std::size_t stride = missing.stride();
    const float* const lack = missing.missing(p);
    for (std::size_t r = 0; r < missing.rows(); ++r) {
      const Vec3d here = to_double(Vec3f{lack[r], lack[stride + r], lack[2 * stride + r]});
      for (std::size_t i = 0; i < targets; ++i) of[i] = of[i] + static_cast<double>(weights[r * targets + i]) * here;
    }
    factors.solve(of);
    std::vector<float> more(3 * stride, 0.0F);
    for (std::size_t i = 0; i < targets; ++i) {
      const Vec3f delta = to_float(of[i]);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const float part = axis == 0 ? delta.x : axis == 1 ? delta.y : delta.z;
        result[(3 * p + axis) * targets + i] = part;
        for (std::size_t r = 0; r < missing.rows(); ++r) more[axis * stride + r] += weights[r * targets + i] * part;
      }
    }
    missing.show_more(p, more);
  });
  return result;
}

// Counts the products of two weights that are not zero in the given poses. With area weights, n(w) is quadratic, so own
// deltas lack at most this many terms of n(w).
std::size_t products_of(const PoseList& poses) {
  std::size_t active = 0;
  for (std::size_t i = 0; !poses.empty() && i < poses[0].size(); ++i)
    if (std::any_of(poses.begin(), poses.end(), [i](const auto& pose) { return pose[i] != 0; })) ++active;
  return active * (active + 1) / 2;
}

// Fits as few correction targets as the tolerance allows. The number of targets is first estimated from some of the
// points. If the fit is not good enough, the number is raised. At most kFits fits are made.
void fit_few(LowRankFit& fit, const LowRankLimits& limits, std::span<const float> weights, std::size_t own_targets) {
  std::vector<std::size_t> counts;
  for (const std::size_t count : kCounts)
    if (count < limits.most_extras) counts.push_back(count);
  counts.push_back(std::min(limits.most_extras, kCounts.back()));
  const std::vector<double> errors = fit.errors_with(counts);
  const double least = kNoGain * *std::min_element(errors.begin(), errors.end());
  const double near = kPartOfSingular * limits.tolerance;
  std::size_t at = 0;
  while (at < counts.size() && errors[at] > near && !(errors[at] <= least && kManyMore * counts[at] <= counts.back()))
    ++at;
  std::size_t extras = counts[std::min(at, counts.size() - 1)];
  // Between two numbers of correction targets, the logarithm of the error is interpolated linearly.
  if (at > 0 && at < counts.size() && errors[at] > 0 && errors[at] < near) {
    const double part = portable::log(errors[at - 1] / near) / portable::log(errors[at - 1] / errors[at]);
    extras =
        counts[at - 1] + static_cast<std::size_t>(std::ceil(part * static_cast<double>(counts[at] - counts[at - 1])));
  }
  for (int tries = 1;; ++tries) {
    fit.fit(extras, limits.tolerance, weights, own_targets);
    const bool is_hopeless = errors[std::min(at, errors.size() - 1)] > near;
    if (fit.worst() <= kPartOfWorst * limits.tolerance || extras >= limits.most_extras || tries == kFits || is_hopeless)
      return;
    extras = std::min(limits.most_extras, 2 + static_cast<std::size_t>(kMoreExtras * static_cast<double>(extras)));
  }
}

// Returns the weights of correction targets at the instants that are not rows of the fit, by least squares over all
// points. The result has the shape (instants, extras).
std::vector<double> weights_at(const LowRankFit& fit, const MissingNormals& missing, const Cholesky& gram) {
  const std::size_t extras = fit.extras(), padded = fit.padded(), stride = missing.stride();
  constexpr std::size_t kParts = 32;
  std::vector<std::vector<double>> of_parts(kParts);
  parallel_for(kParts, [&](std::size_t part) {
    std::vector<double>& sum = of_parts[part];
    sum.assign(extras * stride, 0.0);
    std::vector<float> scaled(3 * padded), products(extras * stride);
    for (std::size_t p = missing.points() * part / kParts; p < missing.points() * (part + 1) / kParts; ++p) {
      const std::span<const float> deltas = fit.deltas(p);
      const float square = fit.importance(p) * fit.importance(p);
      for (std::size_t n = 0; n < scaled.size(); ++n) scaled[n] = square * deltas[n];
      std::fill(products.begin(), products.end(), 0.0F);
      add_products({scaled.data(), 3, extras, padded, 1}, {missing.missing(p), 3, stride, stride, 1}, products.data(),
                   stride);
      for (std::size_t n = 0; n < sum.size(); ++n) sum[n] += static_cast<double>(products[n]);
    }
  });
  std::vector<double> result(missing.rows() * extras);
  for (std::size_t r = 0; r < missing.rows(); ++r) {
    std::vector<Vec3d> right(extras);
    for (std::size_t k = 0; k < extras; ++k)
      for (const std::vector<double>& sum : of_parts) right[k].x += sum[k * stride + r];
    gram.solve(right);
    for (std::size_t k = 0; k < extras; ++k) result[r * extras + k] = right[k].x;
  }
  return result;
}

Cholesky gram_of_deltas(const LowRankFit& fit, std::size_t points) {
  const std::size_t extras = fit.extras(), padded = fit.padded();
  std::vector<double> matrix(extras * extras, 0.0);
  double trace = 0;
  for (std::size_t p = 0; p < points; ++p) {
    const std::span<const float> deltas = fit.deltas(p);
    const double square = static_cast<double>(fit.importance(p)) * static_cast<double>(fit.importance(p));
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (std::size_t i = 0; i < extras; ++i)
        for (std::size_t j = 0; j <= i; ++j)
          matrix[i * extras + j] +=
              square * static_cast<double>(deltas[axis * padded + i]) * static_cast<double>(deltas[axis * padded + j]);
  }
  for (std::size_t i = 0; i < extras; ++i) trace += matrix[i * extras + i];
  const double ridge = std::fmax(kLeastRidge * trace / static_cast<double>(extras), 1e-300);
  for (std::size_t i = 0; i < extras; ++i) matrix[i * extras + i] += ridge;
  return {std::move(matrix), extras, ridge};
}

struct FittedVertex {
  std::uint32_t vertex;
  std::size_t point;
};

LowRank find_low_rank(const RightNormals& rights, const MeshWeights& weights, std::span<const std::uint32_t> vertices,
                      std::span<const std::uint32_t> element_of_vertex, std::vector<VertexVectors> own,
                      const LowRankLimits& asked) {
  const std::size_t targets = rights.targets();
  LowRank found;
  found.own = std::move(own);
  std::vector<PointVertices> points = points_of(rights, vertices, element_of_vertex);
  const FileInstants instants(weights);
  LowRankLimits limits = asked;
  limits.most_extras =
      std::min(limits.most_extras, rights.are_by_area() ? products_of(instants.poses) : instants.poses.size());
  if ((limits.most_extras == 0 && !limits.refits_own) || points.empty() || weights.tracks.empty()) return found;

  const std::size_t room = kBytes / (6 * sizeof(float) * points.size());
  const Rows rows = choose_rows(instants, weights.tracks, std::clamp(room, kFewestRows, kMostRows));
  const auto columns_of_points = [&](std::span<const PointVertices> of) {
    std::vector<std::uint32_t> first;
    for (const PointVertices& point : of) first.push_back(point.front());
    std::vector<const VertexVectors*> columns;
    for (const VertexVectors& column : found.own) columns.push_back(&column);
    return by_vertex(columns, first);
  };
  MissingNormals missing(rights, points, element_of_vertex, columns_of_points(points),
                         poses_of(instants, rows.instants), limits.keeps_across);
  missing.keep_beyond(kPartOfNeed * limits.tolerance);
  if (missing.points() == 0) return found;
  std::vector<PointVertices> fitted;
  for (std::size_t p = 0; p < missing.points(); ++p) fitted.push_back(std::move(points[missing.number(p)]));

  const std::size_t own_targets = limits.refits_own ? targets : 0;
  const std::vector<float> more_own = limits.refits_own ? refitted_own(missing, targets) : std::vector<float>();
  LowRankFit fit(missing, rows.places, rows.unseen);
  fit_few(fit, limits, limits.refits_own ? own_weights(missing.poses()) : std::vector<float>(), own_targets);
  found.worst = fit.worst();

  // Collects the deltas of all vertices. Fits have the deltas point by point, but the file needs them vertex by vertex.
  std::vector<FittedVertex> all;
  for (std::size_t p = 0; p < fitted.size(); ++p)
    for (const std::uint32_t v : fitted[p]) all.push_back({v, p});
  std::sort(all.begin(), all.end(), [](const FittedVertex& a, const FittedVertex& b) { return a.vertex < b.vertex; });
  const auto vector_of = [](std::span<const float> planes, std::size_t stride, std::size_t n) {
    return Vec3f{planes[n], planes[stride + n], planes[2 * stride + n]};
  };
  if (limits.refits_own) {
    for (std::size_t i = 0; i < targets; ++i) {
      VertexVectors column;
      const auto append = [&](std::uint32_t vertex, const Vec3f& delta) {
        if (delta == Vec3f{}) return;
        column.vertices.push_back(vertex);
        column.vectors.push_back(delta);
      };
      std::size_t at = 0;
      const VertexVectors& before = found.own[i];
      for (const auto& [vertex, p] : all) {
        for (; at < before.vertices.size() && before.vertices[at] < vertex; ++at)
          append(before.vertices[at], before.vectors[at]);
        const bool had = at < before.vertices.size() && before.vertices[at] == vertex;
        const auto length = static_cast<float>(BaseNormal(rights.stored(vertex)).length);
        const std::span<const float> of_point = std::span(more_own).subspan(3 * targets * p, 3 * targets);
        const Vec3f more = vector_of(of_point, targets, i) + vector_of(fit.own_deltas(p), targets, i);
        append(vertex, (had ? before.vectors[at] : Vec3f{}) + length * more);
        at += had ? 1 : 0;
      }
      for (; at < before.vertices.size(); ++at) append(before.vertices[at], before.vectors[at]);
      found.own[i] = std::move(column);
    }
  }

  const std::size_t extras = fit.extras();
  std::vector<double> curves(instants.poses.size() * extras);
  std::vector<char> is_row(instants.poses.size(), 0);
  for (std::size_t r = 0; r < rows.instants.size(); ++r) {
    is_row[rows.instants[r]] = 1;
    for (std::size_t k = 0; k < extras; ++k)
      curves[rows.instants[r] * extras + k] = static_cast<double>(fit.weights()[r * fit.padded() + k]);
  }
  std::vector<std::size_t> others;
  for (std::size_t n = 0; n < is_row.size(); ++n)
    if (is_row[n] == 0) others.push_back(n);
  if (!others.empty()) {
    const Cholesky gram = gram_of_deltas(fit, missing.points());
    const VertexColumns columns = columns_of_points(fitted);
    for (std::size_t first = 0; first < others.size(); first += kRowsAtOnce) {
      const std::span<const std::size_t> some =
          std::span(others).subspan(first, std::min(kRowsAtOnce, others.size() - first));
      const MissingNormals here(rights, fitted, element_of_vertex, columns, poses_of(instants, some),
                                limits.keeps_across);
      const std::vector<double> of_some = weights_at(fit, here, gram);
      for (std::size_t n = 0; n < some.size(); ++n)
        for (std::size_t k = 0; k < extras; ++k) curves[some[n] * extras + k] = of_some[n * extras + k];
    }
  }

  // Scales the weights of correction targets to at most 1, and multiplies deltas by the same factors. Entries of deltas
  // that turn no normal noticeably become zero.
  std::vector<std::size_t> kept;
  std::vector<double> largest(extras, 0.0);
  for (std::size_t n = 0; n < curves.size(); ++n)
    largest[n % extras] = std::fmax(largest[n % extras], std::fabs(curves[n]));
  const double least = kPartOfEntry * limits.tolerance / kDegreesPerRadian;
  for (std::size_t k = 0; k < extras; ++k) {
    VertexVectors column;
    for (const auto& [vertex, p] : all) {
      const auto scale = static_cast<float>(largest[k]);
      const Vec3f delta = scale * vector_of(fit.deltas(p), fit.padded(), k);
      if (static_cast<double>(fit.importance(p)) * length(to_double(delta)) <= least) continue;
      column.vertices.push_back(vertex);
      column.vectors.push_back(static_cast<float>(BaseNormal(rights.stored(vertex)).length) * delta);
    }
    if (column.vertices.empty()) continue;
    kept.push_back(k);
    found.extras.push_back(std::move(column));
  }
  const auto weights_of = [&](std::size_t instant) {
    std::vector<double> result;
    result.reserve(kept.size());
    for (const std::size_t k : kept) result.push_back(curves[instant * extras + k] / largest[k]);
    return result;
  };
  for (std::size_t t = 0; t < weights.tracks.size(); ++t) {
    ExtraCurves& of_track = found.curves[weights.names[t]];
    of_track.extras = kept.size();
    for (std::size_t node = 0; node < instants.tracks[t].size(); ++node) {
      const std::vector<double> values = weights_of(instants.first[t] + node);
      of_track.values.insert(of_track.values.end(), values.begin(), values.end());
    }
  }
  for (std::size_t n = 0; n < weights.stored_poses; ++n) found.rest.push_back(weights_of(instants.first.back() + n));
  return found;
}

// Multiplies vectors by a factor. If is_unit is true, also changes each vector E so that N + E has the length of N. If
// keeps_along is true as well, adds back the part of E along N.
void shorten(const RightNormals& rights, double factor, bool is_unit, bool keeps_along, VertexVectors& vectors) {
  for (std::size_t n = 0; n < vectors.vertices.size(); ++n) {
    Vec3f& vector = vectors.vectors[n];
    if (!is_unit) {
      vector = static_cast<float>(factor) * vector;
      continue;
    }
    const BaseNormal base(rights.stored(vectors.vertices[n]));
    const Vec3d part = (factor / base.length) * to_double(vector);
    const Vec3d along = keeps_along ? dot(part, base.direction) * base.direction : Vec3d{};
    vector = to_float(base.length * (unit_delta(base.direction, part) + along));
  }
}

// Makes correction targets whose deltas have lengths that `lengths` allows, from targets with deltas of any length.
// Each target becomes one share, or two shares for kUnit: one for positive weights, and one for negative weights.
std::vector<Share> shares_of(const RightNormals& rights, std::vector<VertexVectors> extras, Lengths lengths,
                             const ShortShares& how) {
  std::vector<Share> shares;
  const double factor = weight_factor(lengths);
  for (std::size_t k = 0; k < extras.size(); ++k) {
    if (lengths == Lengths::kUnit) {
      for (const double sign : {1.0, -1.0}) {
        Share share{k, sign, true, extras[k]};
        shorten(rights, sign, true, false, share.vectors);
        shares.push_back(std::move(share));
      }
      continue;
    }
    shorten(rights, 1 / factor, how.are_units, how.keep_along, extras[k]);
    shares.push_back({k, factor, false, std::move(extras[k])});
  }
  return shares;
}

// Replaces the weights of correction targets, (poses, extras), by the weights of the shares that were made from these
// targets.
void take_shares(std::span<const Share> shares, std::size_t extras, std::vector<double>& values) {
  std::vector<double> result;
  for (std::size_t first = 0; first < values.size(); first += extras) {
    for (const Share& share : shares) {
      const double value = share.factor * values[first + share.of];
      result.push_back(share.above_zero ? std::fmax(value, 0) : value);
    }
  }
  values = std::move(result);
}

}  // namespace

Candidate low_rank_candidate(const Making& making, Candidate own) {
  Candidate result = std::move(own);
  result.name = "low rank";
  result.animations_only = making.animations_only;
  const bool refits_own = making.animations_only && making.lengths == Lengths::kFree && making.source.plan.products_fit;
  const std::size_t for_each = making.lengths == Lengths::kUnit ? 2 : 1;
  LowRank found =
      find_low_rank(making.rights, making.weights, making.judge.vertices(), making.source.shading.element_of_vertex,
                    result.own, {making.most_extras / for_each, making.tolerance, making.keeps_across, refits_own});
  const std::size_t extras = found.extras.size();
  // Keeps deltas along the stored normal for viewers that add up deltas, because such deltas allow turns by more than a
  // right angle. In viewers that keep only directions, such deltas are wrong.
  const bool keeps_along = std::none_of(making.viewers.begin(), making.viewers.end(),
                                        [](const Viewer& viewer) { return viewer.normals == NormalRule::kUnit; });
  std::vector<Share> shares = shares_of(making.rights, std::move(found.extras), making.lengths,
                                        {making.keeps_across && making.lengths == Lengths::kShort, keeps_along});
  ExtraDrivers& drivers = result.drivers;
  drivers.curves = std::move(found.curves);
  drivers.rest = std::move(found.rest);
  for (auto& [name, curves] : drivers.curves) {
    take_shares(shares, extras, curves.values);
    curves.extras = shares.size();
  }
  for (std::vector<double>& pose : drivers.rest) take_shares(shares, extras, pose);
  for (Share& share : shares) result.extras.push_back(std::move(share.vectors));
  drivers.formulas.assign(shares.size(), ExtraWeight{0, 0, 0, 0});
  if (shares.empty()) drivers = ExtraDrivers();
  if (refits_own) result.own = std::move(found.own);
  cut_tracks(making.rights, making.weights, making.viewers, making.judge.vertices(),
             kPartOfTracks * making.tolerance / kDegreesPerRadian, result);
  return result;
}

}  // namespace chronormal::inline internal
