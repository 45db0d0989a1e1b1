/// The fewest bytes that a mesh with a few targets can be right in, by trying everything: what a host that adds up
/// deltas shows of each combination of candidates, against cross products of the blended positions. Shares no code with
/// the product.
///
///     of each target    its stored deltas | the best of all deltas that are right at weight 1 | the delta of n(1), and with it
///                       nothing | a delta driven by w (1 - w)
///     of each pair      nothing | a delta driven by w_i w_j
///
/// Bytes are those of deltas other than the stored ones, 12 for each vertex, or 13 for each that has one where that is
/// less by what more JSON takes; and those by which the track grows. A LINEAR track is cut into equal pieces for each
/// gap, as many as keep what
/// straight lines turn in its middle within a quarter of the tolerance.
///
/// A combination does no harm where no normal is off by more than it was, or than the tolerance, along the track and
/// with each target alone; nor in random poses, by the mean, or beyond half of the worst that there was.
#ifndef CHRONORMAL_TESTS_SUPPORT_CHEAPEST_BAKE_H_
#define CHRONORMAL_TESTS_SUPPORT_CHEAPEST_BAKE_H_

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

namespace chronormal::test {

class CheapestBake {
 public:
  struct V : std::array<double, 3> {};
  using Field = std::vector<V>;  // of each vertex

  struct Mesh {
    Field positions, normals;  ///< normals: those of the geometry
    std::vector<std::array<std::size_t, 3>> faces;
    std::vector<Field> targets, stored;  ///< deltas of positions and of normals
  };
  struct Track {
    bool is_step = false;
    std::vector<double> times;
    std::vector<std::vector<double>> keys;  ///< (keys, targets)
  };
  /// A column of deltas: driven by w_i (one index), w_i (1 - w_i) (twice the same) or w_i w_j.
  struct Column {
    std::vector<std::size_t> of;
    Field deltas;
    bool is_stored = false;
  };
  struct Found {
    std::size_t bytes = std::numeric_limits<std::size_t>::max();
    double error = 0;
    std::size_t combinations = 0;  ///< that were looked at
  };

  CheapestBake(Mesh mesh, Track track, double tolerance)
      : mesh_(std::move(mesh)), track_(std::move(track)), tolerance_(tolerance) {
    const std::size_t targets = mesh_.targets.size();
    const std::vector<double> rest(targets, 0.0);
    const Field base = normals_at(rest);
    for (const V& n : base) base_length_.push_back(norm(n));
    for (std::size_t i = 0; i < targets; ++i) {
      const auto at = [&](double w) {
        std::vector<double> pose = rest;
        pose[i] = w;
        return normals_at(pose);
      };
      add_candidates(i, base, at(0.5), at(1), at);
    }
    for (std::size_t i = 0; i < targets; ++i) {
      for (std::size_t j = i + 1; j < targets; ++j) {
        std::vector<double> both = rest, first = rest, second = rest;
        both[i] = both[j] = first[i] = second[j] = 1;
        const Field a = normals_at(both), b = normals_at(first), c = normals_at(second);
        Column column{{i, j}, Field(base.size()), false};
        for (std::size_t v = 0; v < base.size(); ++v)
          column.deltas[v] = scaled(a[v] - b[v] - c[v] + base[v], 1 / base_length_[v]);
        slots_.push_back({{}, {column}});
      }
    }
    set_poses();
  }

  /// The cheapest combination of less than so many bytes whose worst error along the track is not above this.
  [[nodiscard]] Found cheaper_than(std::size_t bytes, double error) const {
    Found best;
    best.bytes = bytes;
    std::vector<std::size_t> option(slots_.size(), 0);
    for (bool any = true; any;) {
      std::vector<Column> columns;
      for (std::size_t s = 0; s < slots_.size(); ++s)
        columns.insert(columns.end(), slots_[s][option[s]].begin(), slots_[s][option[s]].end());
      ++best.combinations;
      const double worst = look_at(columns, best.bytes, error);
      if (worst >= 0) {
        best.bytes = bytes_of(columns);
        best.error = worst;
      }
      any = false;
      for (std::size_t s = 0; s < slots_.size() && !any; ++s) {
        any = ++option[s] < slots_[s].size();
        if (!any) option[s] = 0;
      }
    }
    if (best.bytes == bytes) best.bytes = std::numeric_limits<std::size_t>::max();
    return best;
  }

  /// The worst error of what is shown along the track, where shown(v, part of the track from 0 to 1 by gap) is given by
  /// columns with weights(gap, part) of their own.
  template <class Weights>
  [[nodiscard]] double error_along(const std::vector<Field>& columns, const Weights& weights) const {
    double worst = 0;
    for (const Pose& pose : played_) {
      const std::vector<double> at = weights(pose.gap, pose.part);
      for (std::size_t v = 0; v < pose.right.size(); ++v) {
        if (norm(pose.right[v]) <= kShort * base_length_[v]) continue;
        V sum = mesh_.normals[v];
        for (std::size_t c = 0; c < columns.size(); ++c) sum = sum + scaled(columns[c][v], at[c]);
        worst = std::max(worst, angle(sum, pose.right[v]));
      }
    }
    return worst;
  }

  /// Bytes of an array of deltas.
  [[nodiscard]] static std::size_t bytes_of(const Field& deltas) {
    const auto count = static_cast<std::size_t>(std::count_if(deltas.begin(), deltas.end(), [](const V& d) {
      return std::max({std::fabs(d[0]), std::fabs(d[1]), std::fabs(d[2])}) > kNothing;
    }));
    constexpr std::size_t kOfIndex = 1, kOfJson = 130;
    const std::size_t sparse = 12 * count + (kOfIndex * count + 3) / 4 * 4;
    if (count == 0) return 0;
    return sparse + kOfJson < 12 * deltas.size() ? sparse : 12 * deltas.size();
  }

 private:
  static constexpr double kShort = 1e-3, kNothing = 1e-6;
  struct Pose {
    std::size_t gap = 0;
    double part = 0;
    std::vector<double> weights;
    Field right;
    std::vector<double> before;  // degrees
  };

  friend V operator+(const V& a, const V& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
  friend V operator-(const V& a, const V& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
  static V scaled(const V& a, double s) { return {s * a[0], s * a[1], s * a[2]}; }
  static double dot(const V& a, const V& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
  static V cross(const V& a, const V& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  }
  static double norm(const V& a) { return std::sqrt(dot(a, a)); }
  static double angle(const V& a, const V& b) {
    return std::atan2(norm(cross(a, b)), dot(a, b)) * 180 / std::numbers::pi;
  }

  [[nodiscard]] Field normals_at(const std::vector<double>& weights) const {
    Field at = mesh_.positions, sums(at.size(), V{});
    for (std::size_t i = 0; i < weights.size(); ++i)
      for (std::size_t v = 0; v < at.size(); ++v) at[v] = at[v] + scaled(mesh_.targets[i][v], weights[i]);
    for (const auto& [a, b, c] : mesh_.faces) {
      const V n = cross(at[b] - at[a], at[c] - at[a]);
      for (const std::size_t v : {a, b, c}) sums[v] = sums[v] + n;
    }
    return sums;
  }

  template <class At>
  void add_candidates(std::size_t i, const Field& base, const Field& half, const Field& end, const At& at) {
    Column stored{{i}, mesh_.stored[i], true}, ends{{i}, Field(base.size()), false},
        best = ends, hump{{i, i}, Field(base.size()), false};
    std::vector<Field> on_the_way;
    for (int step = 1; step < 32; ++step) on_the_way.push_back(at(step / 32.0));
    for (std::size_t v = 0; v < base.size(); ++v) {
      const double scale = 1 / base_length_[v];
      ends.deltas[v] = scaled(end[v], scale) - mesh_.normals[v];
      hump.deltas[v] = scaled(base[v] - scaled(half[v], 2) + end[v], -2 * scale);
      const auto delta_of = [&](double size) { return scaled(end[v], size / norm(end[v])) - mesh_.normals[v]; };
      double least = 360;
      for (double size = 0.05; size < 20; size *= 1.03) {
        double worst = 0;
        for (std::size_t step = 0; step < on_the_way.size(); ++step)
          worst = std::max(worst, angle(mesh_.normals[v] + scaled(delta_of(size), static_cast<double>(step + 1) / 32),
                                        on_the_way[step][v]));
        if (worst >= least) continue;
        least = worst;
        best.deltas[v] = delta_of(size);
      }
      if (norm(ends.deltas[v]) < kNothing && norm(hump.deltas[v]) < kNothing) best.deltas[v] = {};
    }
    slots_.push_back({{stored}, {best}, {ends}, {ends, hump}, {best, hump}});
  }

  [[nodiscard]] std::vector<double> weights_at(std::size_t gap, double part) const {
    std::vector<double> result = track_.keys[gap];
    for (std::size_t i = 0; i < result.size() && !track_.is_step; ++i)
      result[i] = (1 - part) * result[i] + part * track_.keys[gap + 1][i];
    return result;
  }

  [[nodiscard]] static double weight(const Column& column, const std::vector<double>& own) {
    if (column.of.size() == 1) return own[column.of[0]];
    return column.of[0] == column.of[1] ? own[column.of[0]] * (1 - own[column.of[0]])
                                        : own[column.of[0]] * own[column.of[1]];
  }

  Pose pose_of(std::size_t gap, double part, std::vector<double> weights) const {
    Pose pose{gap, part, std::move(weights), {}, {}};
    pose.right = normals_at(pose.weights);
    for (std::size_t v = 0; v < pose.right.size(); ++v) {
      V sum = mesh_.normals[v];
      for (std::size_t i = 0; i < pose.weights.size(); ++i) sum = sum + scaled(mesh_.stored[i][v], pose.weights[i]);
      pose.before.push_back(angle(sum, pose.right[v]));
    }
    return pose;
  }

  void set_poses() {
    constexpr int kParts = 24;
    const std::size_t gaps = track_.keys.size() - 1, targets = mesh_.targets.size();
    for (std::size_t gap = 0; gap < gaps; ++gap)
      for (int part = 0; part < (track_.is_step ? 1 : kParts); ++part)
        played_.push_back(pose_of(gap, part / double{kParts}, weights_at(gap, part / double{kParts})));
    played_.push_back(pose_of(track_.is_step ? gaps : gaps - 1, 1, track_.keys.back()));
    if (track_.is_step) played_.back().part = 0;
    for (std::size_t i = 0; i < targets; ++i)
      for (int step = 1; step <= 32; ++step) {
        std::vector<double> alone(targets, 0.0);
        alone[i] = step / 32.0;
        others_.push_back(pose_of(0, 0, alone));
      }
    std::mt19937 random(7);
    std::uniform_real_distribution<double> from_0_to_1(0, 1);
    for (int n = 0; n < 60 && targets > 1; ++n) {
      std::vector<double> pose(targets, 0.0);
      for (double& w : pose) w = from_0_to_1(random);
      mixed_.push_back(pose_of(0, 0, pose));
    }
  }

  // Of each gap: equal pieces of a LINEAR track.
  [[nodiscard]] std::vector<std::size_t> pieces_of(const std::vector<Column>& columns) const {
    std::vector<std::size_t> result(track_.keys.size() - 1, 1);
    for (std::size_t gap = 0; gap < result.size() && !track_.is_step; ++gap) {
      const std::vector<double> start = track_.keys[gap], end = track_.keys[gap + 1], middle = weights_at(gap, 0.5);
      double worst = 0;
      for (std::size_t v = 0; v < mesh_.normals.size(); ++v) {
        V right = mesh_.normals[v], straight = right;
        for (const Column& column : columns) {
          right = right + scaled(column.deltas[v], weight(column, middle));
          straight = straight + scaled(column.deltas[v], (weight(column, start) + weight(column, end)) / 2);
        }
        worst = std::max(worst, angle(right, straight));
      }
      const double pieces = std::ceil(std::sqrt(worst / (tolerance_ / 4)));
      result[gap] = static_cast<std::size_t>(std::clamp(pieces, 1.0, 16.0));
    }
    return result;
  }

  [[nodiscard]] std::size_t bytes_of(const std::vector<Column>& columns) const {
    std::size_t bytes = 0, extras = 0;
    for (const Column& column : columns) {
      if (!column.is_stored) bytes += bytes_of(column.deltas);
      extras += column.of.size() > 1 ? std::size_t{1} : 0;
    }
    if (extras == 0) return bytes;
    std::size_t keys = 1;
    for (const std::size_t pieces : pieces_of(columns)) keys += pieces;
    const std::size_t targets = mesh_.targets.size(), before = track_.keys.size();
    return bytes + 4 * (keys * (targets + extras) - before * targets) + (keys > before ? 4 * keys : 0);
  }

  // The worst error along the track; below zero where that is beyond the limit, takes as many bytes, or does harm.
  [[nodiscard]] double look_at(const std::vector<Column>& columns, std::size_t bytes, double limit) const {
    if (bytes_of(columns) >= bytes) return -1;
    const std::vector<std::size_t> pieces = pieces_of(columns);
    const auto error = [&](const Pose& pose, const std::vector<double>& weights, std::size_t v) {
      V sum = mesh_.normals[v];
      for (std::size_t c = 0; c < columns.size(); ++c) sum = sum + scaled(columns[c].deltas[v], weights[c]);
      return angle(sum, pose.right[v]);
    };
    const auto by_formula = [&](const std::vector<double>& own) {
      std::vector<double> weights;
      for (const Column& column : columns) weights.push_back(weight(column, own));
      return weights;
    };
    double worst = 0;
    for (const Pose& pose : played_) {
      std::vector<double> weights = by_formula(pose.weights);
      if (!track_.is_step) {
        const double along = pose.part * static_cast<double>(pieces[pose.gap]);
        const double first = std::min(std::floor(along), static_cast<double>(pieces[pose.gap]) - 1);
        const auto end = [&](double piece) {
          return by_formula(weights_at(pose.gap, piece / static_cast<double>(pieces[pose.gap])));
        };
        const std::vector<double> from = end(first), to = end(first + 1);
        for (std::size_t c = 0; c < weights.size(); ++c)
          weights[c] = (1 - along + first) * from[c] + (along - first) * to[c];
      }
      for (std::size_t v = 0; v < pose.right.size(); ++v) {
        const double now = error(pose, weights, v);
        if (now > std::max(pose.before[v], tolerance_)) return -1;
        if (norm(pose.right[v]) <= kShort * base_length_[v]) continue;
        worst = std::max(worst, now);
        if (worst > limit) return -1;
      }
    }
    for (const Pose& pose : others_) {
      const std::vector<double> weights = by_formula(pose.weights);
      for (std::size_t v = 0; v < pose.right.size(); ++v)
        if (error(pose, weights, v) > std::max(pose.before[v], tolerance_)) return -1;
    }
    double before = 0, after = 0, worst_before = 0, worst_after = 0;
    for (const Pose& pose : mixed_) {
      const std::vector<double> weights = by_formula(pose.weights);
      for (std::size_t v = 0; v < pose.right.size(); ++v) {
        const double now = error(pose, weights, v);
        before += pose.before[v];
        after += now;
        worst_before = std::max(worst_before, pose.before[v]);
        worst_after = std::max(worst_after, now);
      }
    }
    const bool does_harm = after > before || worst_after > std::max(tolerance_, worst_before / 2);
    return does_harm ? -1 : worst;
  }

  Mesh mesh_;
  Track track_;
  double tolerance_;
  std::vector<double> base_length_;
  std::vector<std::vector<std::vector<Column>>> slots_;
  std::vector<Pose> played_, others_, mixed_;
};

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_CHEAPEST_BAKE_H_
