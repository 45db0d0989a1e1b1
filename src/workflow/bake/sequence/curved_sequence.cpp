// Computes the unit normals of keys on curves, and fits the bends of segments to what their cubics lack.
#include "workflow/bake/sequence/curved_sequence.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <limits>
#include <memory>
#include <utility>

#include "chronormal/analysis/quality.h"
#include "chronormal/normals/path_curves.h"
#include "core/blocks.h"
#include "core/float32.h"
#include "normals/curves/path_stream.h"

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

// Walks over the segments, one after the other, and keeps as many as are still needed: their control normals, and what
// the target of each key adds to N.
class CurvedWalk {
 public:
  CurvedWalk(const CurvedSource& source, std::span<const SequenceElement> elements)
      : source_(source), elements_(elements), ends_(elements.size()) {
    keys_.emplace_back(elements.size());  // key 0 adds nothing
  }

  // Reads on until the deltas of a key are known. The segment before it is then known, too.
  Status read_to_key(std::size_t key) {
    while (key >= first_key_ + keys_.size()) {
      if (Status status = read_segment(); !status) return status;
    }
    return Success{};
  }
  // Forgets earlier segments than this, and the keys that neither it nor a later one follows from.
  void drop_before(std::size_t segment) {
    for (; first_segment_ < segment && !normals_.empty(); ++first_segment_) normals_.pop_front();
    for (; first_key_ + 2 < segment && keys_.size() > 1; ++first_key_) keys_.pop_front();
  }

  [[nodiscard]] const std::vector<Controls>& normals(std::size_t segment) const {
    return normals_[segment - first_segment_];
  }
  [[nodiscard]] const std::vector<Vec3d>& key(std::size_t key) const { return keys_[key - first_key_]; }

 private:
  // The direction of an element at a key is that in which the segment before ends, or where it has none there, that in
  // which the next one begins.
  Status read_segment() {
    const Motion& motion = source_.stream->motion();
    const std::size_t s = first_segment_ + normals_.size();
    if (Status status = hold_paths(*source_.stream, s, s, source_.path); !status) return status;
    const std::vector<Controls>& normals =
        normals_.emplace_back(all_path_normals(path_segment(motion, s, source_.path), *source_.groups));
    if (first_key_ + keys_.size() == s) {
      parallel_each(ends_.size(), kCurvedBlock, [&](std::size_t e) {
        if (ends_[e] == Vec3d{}) ends_[e] = unit_normal_at(normals[e], 0).vector;
      });
      add_key();
    }
    parallel_each(ends_.size(), kCurvedBlock, [&](std::size_t e) { ends_[e] = unit_normal_at(normals[e], 1).vector; });
    const bool is_last = s + 1 == motion.segments.size();
    if (is_last || std::find(ends_.begin(), ends_.end(), Vec3d{}) == ends_.end()) add_key();
    return Success{};
  }

  // An element without a direction at a key keeps that of the key before.
  void add_key() {
    std::vector<Vec3d> deltas(ends_.size());
    parallel_each(ends_.size(), kCurvedBlock, [&](std::size_t e) {
      deltas[e] = ends_[e] == Vec3d{} ? keys_.back()[e] : rounded_to_float(ends_[e] - elements_[e].normal);
    });
    keys_.push_back(std::move(deltas));
  }

  CurvedSource source_;
  std::span<const SequenceElement> elements_;
  std::deque<std::vector<Controls>> normals_;  // of segments
  std::deque<std::vector<Vec3d>> keys_;
  std::size_t first_segment_ = 0, first_key_ = 0;
  std::vector<Vec3d> ends_;  // directions where the last segment ends
};

// How fast the direction of an element turns where a segment begins or ends, per second; 0 where it has none there.
Vec3d turning_at(const Controls& n, bool at_end, double duration) {
  const std::size_t last = n.size() - 1;
  const Vec3d here = at_end ? n[last] : n[0];
  const double size = length(here), degree = static_cast<double>(last);
  if (size == 0) return {};
  const Vec3d slope = (degree / size) * (at_end ? n[last] - n[last - 1] : n[1] - n[0]);
  const Vec3d u = (1 / size) * here, turn = slope - dot(slope, u) * u;
  // Where a face all but vanishes at the key, a curve with this slope would swing far beyond both of its ends.
  const double most = 3;
  const double angle = length(turn);
  if (!(angle < std::numeric_limits<double>::max())) return {};
  return (std::min(1.0, most / std::max(angle, most)) / duration) * turn;
}

// How fast the directions of all elements turn at a key, from a segment that begins or ends there.
std::vector<Vec3d> turnings(const std::vector<Controls>& normals, bool at_end, double duration) {
  std::vector<Vec3d> result(normals.size());
  parallel_each(result.size(), kCurvedBlock,
                [&](std::size_t e) { result[e] = rounded_to_float(turning_at(normals[e], at_end, duration)); });
  return result;
}

// The same of a key whose target has velocities: from the segment before it, which is read before the next one.
struct KeyTurnings {
  std::vector<Vec3d> at_start, at_end;  // of a segment; empty where a key has no such target
};

// The sum of the deltas of the keys of a segment for one element, as a cubic.
Bernstein<Vec3d, 3> shown_by_keys(const CurvedWalk& walk, const Vec3d& normal, const SegmentShares& shares,
                                  const KeyTurnings& turning, double duration, std::size_t element) {
  Bernstein<Vec3d, 3> shown;
  for (Vec3d& c : shown) c = normal;
  for (std::size_t k = 0; k < shares.of_key.size(); ++k)
    for (std::size_t i = 0; i < shown.size(); ++i)
      shown[i] = shown[i] + shares.of_key[k][i] * walk.key(shares.first + k)[element];
  if (!turning.at_start.empty()) shown[1] = shown[1] + (duration / 3) * turning.at_start[element];
  if (!turning.at_end.empty()) shown[2] = shown[2] - (duration / 3) * turning.at_end[element];
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

}  // namespace

std::vector<std::size_t> keys_with_velocities(const Motion& motion, PathKind path) {
  std::vector<std::size_t> keys;
  for (std::size_t k = 0; k < motion.keyframes.size(); ++k)
    if (!given_velocities(motion.keyframes[k], path).empty()) keys.push_back(k);
  return keys;
}

Result<std::vector<SequenceElement>> curved_elements(const CurvedSource& source) {
  const Motion& motion = source.stream->motion();
  std::vector<SequenceElement> elements(source.groups->size());
  const auto has_none = [](const SequenceElement& element) { return element.has_none; };
  for (std::size_t s = 0; s < motion.segments.size(); ++s) {
    if (std::none_of(elements.begin(), elements.end(), has_none)) break;
    if (const Status status = hold_paths(*source.stream, s, s, source.path); !status) return status.error();
    const std::vector<Controls> normals = all_path_normals(path_segment(motion, s, source.path), *source.groups);
    parallel_each(elements.size(), kCurvedBlock, [&](std::size_t e) {
      for (const double t : {0.0, 1.0}) {
        const Vec3d u = elements[e].has_none ? unit_normal_at(normals[e], t).vector : Vec3d{};
        if (u == Vec3d{}) continue;
        elements[e].normal = rounded_to_float(u);
        elements[e].has_none = false;
      }
    });
  }
  for (SequenceElement& element : elements)
    if (element.has_none) element.normal = kAnyNormal;
  return elements;
}

Status each_curved_key(const CurvedSource& source, std::span<const SequenceElement> elements,
                       const std::function<Status(std::size_t key, const std::vector<Vec3d>& deltas)>& body) {
  CurvedWalk walk(source, elements);
  for (std::size_t k = 1; k < source.stream->motion().keyframes.size(); ++k) {
    if (Status status = walk.read_to_key(k); !status) return status;
    if (Status status = body(k, walk.key(k)); !status) return status;
    walk.drop_before(k);
  }
  return Success{};
}

Status each_key_turning(const CurvedSource& source, std::span<const std::size_t> keys,
                        const std::function<Status(std::size_t key, const std::vector<Vec3d>& deltas)>& body) {
  const Motion& motion = source.stream->motion();
  for (const std::size_t k : keys) {
    const std::size_t s = k == 0 ? 0 : k - 1;
    if (Status status = hold_paths(*source.stream, s, s, source.path); !status) return status;
    const PolynomialSegment<3> path = path_segment(motion, s, source.path);
    const std::vector<Controls> normals = all_path_normals(path, *source.groups);
    if (Status status = body(k, turnings(normals, k > 0, path.end_time - path.start_time)); !status) return status;
  }
  return Success{};
}

Result<double> each_curved_bend(
    const CurvedSource& source, std::span<const SequenceElement> elements, double tolerance,
    const std::function<Status(const CurveBend& bend, const std::vector<Vec3d>& deltas)>& body,
    const std::function<void(std::size_t segments)>& done) {
  const Motion& motion = source.stream->motion();
  const std::vector<double> times = times_of(motion);
  const auto is_given = std::make_unique<bool[]>(times.size());
  for (const std::size_t k : keys_with_velocities(motion, source.path)) is_given[k] = true;
  CurvedWalk walk(source, elements);
  KeyTurnings turning;
  double largest = 0;
  for (std::size_t s = 0; s < motion.segments.size(); ++s) {
    const SegmentShares shares = shares_of(times, s, {is_given.get(), times.size()});
    if (const Status status = walk.read_to_key(shares.first + shares.of_key.size() - 1); !status) return status.error();
    const std::vector<Controls>& normals = walk.normals(s);
    const double duration = times[s + 1] - times[s];
    if (s > 0) turning.at_start = std::move(turning.at_end);
    if (s == 0 && is_given[0]) turning.at_start = turnings(normals, false, duration);
    turning.at_end.clear();
    if (is_given[s + 1]) turning.at_end = turnings(normals, true, duration);
    std::vector<Vec3d> even(elements.size()), odd(elements.size());
    const double error = parallel_fold<double>(
        elements.size(), kCurvedBlock,
        [&](std::size_t e, double& worst) {
          if (elements[e].has_none) return;
          const ElementBend bend = bend_of_element(
              shown_by_keys(walk, elements[e].normal, shares, turning, duration, e), normals[e], tolerance);
          even[e] = bend.even;
          odd[e] = bend.odd;
          worst = std::max(worst, bend.error);
        },
        [](double& all, double each) { all = std::max(all, each); });
    largest = std::max(largest, error);
    for (const bool is_odd : {false, true}) {
      const std::vector<Vec3d>& deltas = is_odd ? odd : even;
      if (std::all_of(deltas.begin(), deltas.end(), [](const Vec3d& d) { return d == Vec3d{}; })) continue;
      if (const Status status = body({s, is_odd}, deltas); !status) return status.error();
    }
    walk.drop_before(s + 1);
    done(s + 1);
  }
  return largest;
}

SequenceTrack curved_track(std::span<const float> times, std::span<const std::size_t> with_velocities,
                           std::span<const CurveBend> bends) {
  enum Row : std::size_t { kIn, kValue, kOut, kRows };
  const std::size_t of_keys = times.size() - 1, of_velocities = of_keys + with_velocities.size();
  const auto fill = [=, seconds = std::vector<double>(times.begin(), times.end())](std::size_t row,
                                                                                   std::span<float> values) {
    const std::size_t key = row / kRows;
    if (row % kRows == kValue) {
      if (key > 0) values[key - 1] = 1;  // key 0 is the base
      return;
    }
    const auto given = std::find(with_velocities.begin(), with_velocities.end(), key);
    if (given != with_velocities.end()) {
      values[of_keys + static_cast<std::size_t>(given - with_velocities.begin())] = 1;
    } else {
      const VelocityShares velocity = velocity_shares(seconds, key);
      for (std::size_t i = 0; i < velocity.share.size(); ++i)
        if (velocity.first + i > 0) values[velocity.first + i - 1] = static_cast<float>(velocity.share[i]);
    }
    const bool is_in = row % kRows == kIn;
    if (is_in && key == 0) return;
    const std::size_t s = is_in ? key - 1 : key;
    const auto first = std::lower_bound(bends.begin(), bends.end(), s,
                                        [](const CurveBend& bend, std::size_t at) { return bend.segment < at; });
    for (auto bend = first; bend != bends.end() && bend->segment == s; ++bend) {
      const double slope = (bend->is_odd ? kOdd : kEven) / (seconds[s + 1] - seconds[s]);
      values[of_velocities + static_cast<std::size_t>(bend - bends.begin())] =
          static_cast<float>(is_in && !bend->is_odd ? -slope : slope);
    }
  };
  return {{times.begin(), times.end()}, kRows * times.size(), of_velocities + bends.size(), fill};
}

}  // namespace chronormal::inline internal
