// Computes the unit normals of keys on curves, and fits the bends of segments to what their cubics lack.
#include "workflow/bake/sequence/curved_sequence.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "chronormal/analysis/quality.h"
#include "chronormal/normals/path_curves.h"
#include "core/blocks.h"
#include "core/float32.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kCurvedBlock = 256;
constexpr double kEven = 4, kOdd = 10;  // so that the weights are about 1 at most

double even_weight(double t) { return kEven * t * (1 - t); }
double odd_weight(double t) { return kOdd * t * (1 - t) * (1 - 2 * t); }

// The keys from which the cubic of a segment follows, and the weight of each as a cubic in t.
struct SegmentShares {
  std::size_t first = 0;  // key
  std::vector<Bernstein<double, 3>> of_key;
};

// The basis of the cubics of a segment that follow from the positions of keys.
SegmentShares shares_of(std::span<const double> times, std::size_t s, std::span<const bool> is_given) {
  SegmentShares result{s, std::vector<Bernstein<double, 3>>(2)};
  const double third = (times[s + 1] - times[s]) / 3;
  std::vector<std::pair<VelocityShares, bool>> ends;
  for (const std::size_t key : {s, s + 1}) {
    if (is_given[key]) continue;
    ends.emplace_back(velocity_shares(times, key), key == s);
    result.first = std::min(result.first, ends.back().first.first);
  }
  std::size_t end = s + 2;
  for (const auto& [velocity, at_start] : ends) end = std::max(end, velocity.first + velocity.share.size());
  result.of_key.assign(end - result.first, {});
  result.of_key[s - result.first][0] = result.of_key[s - result.first][1] = 1;
  result.of_key[s + 1 - result.first][2] = result.of_key[s + 1 - result.first][3] = 1;
  for (const auto& [velocity, at_start] : ends)
    for (std::size_t k = 0; k < velocity.share.size(); ++k)
      result.of_key[velocity.first + k - result.first][at_start ? 1 : 2] +=
          (at_start ? third : -third) * velocity.share[k];
  return result;
}

std::vector<double> times_of(const Motion& motion) {
  std::vector<double> times;
  for (const Motion::Keyframe& keyframe : motion.keyframes) times.push_back(keyframe.time);
  return times;
}

using Controls = PolynomialNormals<3>;

// The sum of the deltas of the keys of a segment for one element, as a cubic.
Bernstein<Vec3d, 3> shown_by_keys(const CurvedNormals& normals, const SegmentShares& shares, std::size_t element) {
  Bernstein<Vec3d, 3> shown;
  for (Vec3d& c : shown) c = normals.elements[element].normal;
  for (std::size_t k = 0; k < shares.of_key.size(); ++k)
    for (std::size_t i = 0; i < shown.size(); ++i)
      shown[i] = shown[i] + shares.of_key[k][i] * normals.keys[shares.first + k][element];
  return shown;
}

// The exact directions of an element at the instants that it is judged at.
using Directions = std::array<Vec3d, kCurveInstants - 1>;

constexpr double instant(std::size_t j) { return static_cast<double>(j + 1) / kCurveInstants; }

Directions directions_of(const Controls& n) {
  Directions result;
  for (std::size_t j = 0; j < result.size(); ++j) result[j] = unit_normal_at(n, instant(j)).vector;
  return result;
}

double worst_angle(const Bernstein<Vec3d, 3>& keys, const Vec3d& even, const Vec3d& odd, const Directions& right) {
  double worst = 0;
  for (std::size_t j = 0; j < right.size(); ++j) {
    if (right[j] == Vec3d{}) continue;
    const double t = instant(j);
    const Vec3d shown = evaluate(keys, t) + even_weight(t) * even + odd_weight(t) * odd;
    worst = std::max(worst, angle_between(shown, right[j]));
  }
  return worst;
}

// The deltas of an element in a segment, and the error that is left, in radians.
struct ElementBend {
  Vec3d even, odd;
  double error = 0;
};

ElementBend bend_of_element(const Bernstein<Vec3d, 3>& keys, const Controls& n, double tolerance) {
  const Directions right = directions_of(n);
  ElementBend best{{}, {}, worst_angle(keys, {}, {}, right)};
  if (best.error <= tolerance) return best;
  const auto lack = [&](double t) {
    const Vec3d u = unit_normal_at(n, t).vector;
    return u == Vec3d{} ? Vec3d{} : u - evaluate(keys, t);
  };
  const auto consider = [&](const Vec3d& even, const Vec3d& odd) {
    const double error = worst_angle(keys, even, odd, right);
    if (error < best.error) best = {even, odd, error};
  };
  consider(rounded_to_float(lack(0.5)), {});
  if (best.error <= tolerance) return best;
  constexpr double kThird = 1 / 3.0;
  const Vec3d first = lack(kThird), second = lack(2 * kThird);
  consider(rounded_to_float((0.5 / even_weight(kThird)) * (first + second)),
           rounded_to_float((0.5 / odd_weight(kThird)) * (first - second)));
  return best;
}

// Finds the directions of all elements at the keys, and takes the first one of each as N.
void take_keys(const Motion& motion, const NormalGroups& groups, PathKind path, CurvedNormals& result) {
  const std::size_t count = groups.size(), segments = motion.segments.size();
  result.elements.resize(count);
  std::vector<std::vector<Vec3d>> directions(segments + 1, std::vector<Vec3d>(count));
  for (std::size_t s = 0; s < segments; ++s) {
    const std::vector<Controls> normals = all_path_normals(path_segment(motion, s, path), groups);
    parallel_each(count, kCurvedBlock, [&](std::size_t e) {
      if (directions[s][e] == Vec3d{}) directions[s][e] = unit_normal_at(normals[e], 0).vector;
      directions[s + 1][e] = unit_normal_at(normals[e], 1).vector;
      SequenceElement& element = result.elements[e];
      for (const std::size_t k : {s, s + 1}) {
        if (!element.has_none || directions[k][e] == Vec3d{}) continue;
        element.normal = rounded_to_float(directions[k][e]);
        element.has_none = false;
      }
    });
  }
  result.keys.assign(segments + 1, std::vector<Vec3d>(count));
  parallel_each(count, kCurvedBlock, [&](std::size_t e) {
    SequenceElement& element = result.elements[e];
    if (element.has_none) element.normal = kAnyNormal;
    for (std::size_t k = 1; k <= segments; ++k) {
      // An element without a direction at a key keeps that of the key before.
      const Vec3d& u = directions[k][e];
      result.keys[k][e] = u == Vec3d{} ? result.keys[k - 1][e] : rounded_to_float(u - element.normal);
    }
  });
}

}  // namespace

std::vector<std::size_t> keys_with_velocities(const Motion& motion, PathKind path) {
  std::vector<std::size_t> keys;
  for (std::size_t k = 0; k < motion.keyframes.size() && path == PathKind::kHermite; ++k)
    if (!motion.keyframes[k].velocities.empty()) keys.push_back(k);
  return keys;
}

CurvedNormals curved_normals(const Motion& motion, const NormalGroups& groups, PathKind path, double tolerance,
                             const std::function<void(std::size_t done)>& progress) {
  CurvedNormals result;
  take_keys(motion, groups, path, result);
  const std::vector<double> times = times_of(motion);
  const auto is_given = std::make_unique<bool[]>(times.size());
  for (const std::size_t k : keys_with_velocities(motion, path)) is_given[k] = true;
  for (std::size_t s = 0; s < motion.segments.size(); ++s) {
    const std::vector<Controls> normals = all_path_normals(path_segment(motion, s, path), groups);
    const SegmentShares shares = shares_of(times, s, {is_given.get(), times.size()});
    CurveBend even{s, false, std::vector<Vec3d>(groups.size())}, odd{s, true, std::vector<Vec3d>(groups.size())};
    const double error = parallel_fold<double>(
        groups.size(), kCurvedBlock,
        [&](std::size_t e, double& worst) {
          if (result.elements[e].has_none) return;
          const ElementBend bend = bend_of_element(shown_by_keys(result, shares, e), normals[e], tolerance);
          even.deltas[e] = bend.even;
          odd.deltas[e] = bend.odd;
          worst = std::max(worst, bend.error);
        },
        [](double& all, double each) { all = std::max(all, each); });
    result.largest_error = std::max(result.largest_error, error);
    for (CurveBend* bend : {&even, &odd}) {
      const bool is_empty =
          std::all_of(bend->deltas.begin(), bend->deltas.end(), [](const Vec3d& d) { return d == Vec3d{}; });
      if (!is_empty) result.bends.push_back(std::move(*bend));
    }
    progress(s + 1);
  }
  return result;
}

SequenceTrack curved_track(std::span<const float> times, std::span<const std::size_t> with_velocities,
                           std::span<const CurveBend> bends) {
  const std::size_t keys = times.size(), of_keys = keys - 1, n = of_keys + with_velocities.size() + bends.size();
  std::vector<float> values(keys * 3 * n, 0.0F);
  enum Row : std::size_t { kIn, kValue, kOut, kRows };
  const auto at = [&](std::size_t key, Row row, std::size_t target) -> float& {
    return values[(key * kRows + row) * n + target];
  };
  const std::vector<double> seconds(times.begin(), times.end());
  for (std::size_t k = 1; k < keys; ++k) at(k, kValue, k - 1) = 1;
  for (std::size_t k = 0; k < keys; ++k) {
    const auto given = std::find(with_velocities.begin(), with_velocities.end(), k);
    if (given != with_velocities.end()) {
      const std::size_t target = of_keys + static_cast<std::size_t>(given - with_velocities.begin());
      at(k, kIn, target) = at(k, kOut, target) = 1;
      continue;
    }
    const VelocityShares velocity = velocity_shares(seconds, k);
    for (std::size_t i = 0; i < velocity.share.size(); ++i) {
      if (velocity.first + i == 0) continue;  // key 0 is the base
      at(k, kIn, velocity.first + i - 1) = at(k, kOut, velocity.first + i - 1) = static_cast<float>(velocity.share[i]);
    }
  }
  for (std::size_t b = 0; b < bends.size(); ++b) {
    const std::size_t s = bends[b].segment, target = of_keys + with_velocities.size() + b;
    const double slope = (bends[b].is_odd ? kOdd : kEven) / (seconds[s + 1] - seconds[s]);
    at(s, kOut, target) = static_cast<float>(slope);
    at(s + 1, kIn, target) = static_cast<float>(bends[b].is_odd ? slope : -slope);
  }
  return {{times.begin(), times.end()},
          kRows * keys,
          n,
          [n, values = std::move(values)](std::size_t row, std::span<float> result) {
            std::copy_n(values.data() + row * n, n, result.data());
          }};
}

}  // namespace chronormal::inline internal
