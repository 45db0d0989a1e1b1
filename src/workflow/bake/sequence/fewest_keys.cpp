// Chooses the keys of a sequence. A line is what a viewer renders between two keys. Extends the line that starts at a
// key as far as its certificate allows, and puts the next key at the end of this line.
#include "workflow/bake/sequence/fewest_keys.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <utility>

#include "analysis/certificates/line_bound.h"
#include "core/blocks.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kKeyBlock = 128;

struct Instant {
  std::size_t segment = 0;
  double t = 0;
};

std::vector<ControlNormals> control_normals(const SequenceNormals& normals, std::size_t segment) {
  const SegmentForm form{normals.at_key(segment), normals.at_key(segment + 1), normals.bends(segment)};
  std::vector<ControlNormals> result(normals.elements());
  parallel_each(result.size(), kKeyBlock, [&](std::size_t e) { result[e] = form.control_normals(e); });
  return result;
}

// Converts a time to an instant. Times count keyframes: keyframe k is at time k. The last keyframe is at the end of the
// last segment, and all other keyframes are at the start of a segment.
Instant instant_of(double time, std::size_t segments) {
  const std::size_t segment = std::min(static_cast<std::size_t>(time), segments - 1);
  return {segment, time - static_cast<double>(segment)};
}

// Returns the directions of the normals of all elements at a key. If an element has no direction in the key's segment,
// returns its direction in the segment before.
template <class OfSegment>
std::vector<Vec3d> key_directions(const Instant& at, const OfSegment& of_segment) {
  const std::vector<ControlNormals>& normals = of_segment(at.segment);
  std::vector<Vec3d> result(normals.size());
  parallel_each(result.size(), kKeyBlock, [&](std::size_t e) { result[e] = unit_normal_at(normals[e], at.t).vector; });
  if (at.t > 0 || at.segment == 0 || std::find(result.begin(), result.end(), Vec3d{}) == result.end()) return result;
  const std::vector<ControlNormals>& before = of_segment(at.segment - 1);
  for (std::size_t e = 0; e < result.size(); ++e)
    if (result[e] == Vec3d{}) result[e] = unit_normal_at(before[e], 1).vector;
  return result;
}

// Reads into memory all keyframes that affect the directions at two instants and between them. These are the keyframes
// of all segments from the first instant to the second, and of the segment before.
Status hold_between(const SequenceNormals& normals, const Instant& from, const Instant& to) {
  return normals.hold(from.segment - std::min<std::size_t>(from.segment, 1), to.segment + 1);
}

// Judges lines. A line interpolates linearly between the normals at two instants, as viewers do. Times count keyframes:
// keyframe k is at time k. If a keyframe could not be read, status() has the error, and all other results are invalid.
class LineJudge {
 public:
  LineJudge(const Motion& motion, const SequenceNormals& normals, double tolerance)
      : motion_(motion), normals_(normals), tolerance_(tolerance), left_out_(motion.segments.size()) {
    Vec3d low = to_double(VectorView<const float>::packed(normals.base())[0]), high = low;
    for (std::size_t k = 0; k < motion.keyframes.size(); ++k) {
      if (status_ = normals.hold(k, k); !status_) return;
      for (std::size_t v = 0; v < motion.topology.vertex_count(); ++v) {
        const Vec3d p = to_double(position(k, v));
        low = {std::fmin(low.x, p.x), std::fmin(low.y, p.y), std::fmin(low.z, p.z)};
        high = {std::fmax(high.x, p.x), std::fmax(high.y, p.y), std::fmax(high.z, p.z)};
      }
    }
    most_off_ = kKeyPositionShare * length(high - low);
  }

  [[nodiscard]] const Status& status() const { return status_; }

  // Returns true if a viewer may interpolate linearly from a key at time a to a key at time b: vertices stay on
  // straight lines, and the error is within the tolerance.
  [[nodiscard]] bool may_draw(double a, double b) { return is_straight(a, b) && error(a, b) <= tolerance_; }
  // Returns a bound of the largest error, in radians, when a viewer interpolates linearly from a to b. Stops as soon as
  // the bound exceeds the tolerance.
  [[nodiscard]] double error(double a, double b) {
    if (!hold(a, b)) return 0;
    const std::vector<Vec3d> from = directions(a), to = directions(b);
    double largest = 0;
    for (std::size_t s = at(a).segment; static_cast<double>(s) < b; ++s) {
      const auto part = part_of(s, a, b);
      const std::vector<ControlNormals>& normals = of_segment(s);
      const std::vector<char>& left_out = left_out_[s];
      std::atomic<bool> is_over = false;
      const double most = parallel_fold<double>(
          normals.size(), kKeyBlock,
          [&](std::size_t e, double& worst) {
            if (is_over.load(std::memory_order_relaxed) || (!left_out.empty() && left_out[e] != 0)) return;
            const double off = error_of(normals[e], part, from[e], to[e]);
            worst = std::fmax(worst, off);
            if (off > tolerance_) is_over.store(true, std::memory_order_relaxed);
          },
          [](double& worst, const double& other) { worst = std::fmax(worst, other); });
      largest = std::fmax(largest, most);
      if (largest > tolerance_) return largest;
    }
    return largest;
  }
  // Excludes elements of a segment from all later judgements: those whose error on the line from a to b is beyond the
  // tolerance in this segment.
  void leave_out(double a, double b) {
    if (!hold(a, b)) return;
    const Instant start = at(a);
    const std::vector<Vec3d> from = directions(a), to = directions(b);
    const std::vector<ControlNormals>& normals = of_segment(start.segment);
    std::vector<char>& left_out = left_out_[start.segment];
    left_out.resize(normals.size());
    const auto part = part_of(start.segment, a, b);
    parallel_each(normals.size(), kKeyBlock, [&](std::size_t e) {
      if (!(error_of(normals[e], part, from[e], to[e]) <= tolerance_)) left_out[e] = 1;
    });
  }
  [[nodiscard]] std::size_t left_out_count() const {
    std::size_t count = 0;
    for (const auto& flags : left_out_) count += static_cast<std::size_t>(std::count(flags.begin(), flags.end(), 1));
    return count;
  }
  void forget_before(std::size_t segment) { segments_.erase(segments_.begin(), segments_.lower_bound(segment)); }

 private:
  // The part of a line from a to b that lies in one segment. It is given as a range of t in the segment, and as a range
  // on the line, where 0 is a and 1 is b.
  struct Part {
    double from_t, to_t, from_share, to_share;
  };
  [[nodiscard]] static Part part_of(std::size_t s, double a, double b) {
    const double start = static_cast<double>(s), low = std::fmax(a, start), high = std::fmin(b, start + 1);
    return {low - start, high - start, (low - a) / (b - a), (high - a) / (b - a)};
  }
  [[nodiscard]] double error_of(const ControlNormals& n, const Part& part, const Vec3d& from, const Vec3d& to) const {
    return line_error(n, part.from_t, part.to_t, lerp(from, to, part.from_share), lerp(from, to, part.to_share),
                      tolerance_);
  }
  [[nodiscard]] bool hold(double a, double b) {
    if (status_) status_ = hold_between(normals_, at(a), at(b));
    return status_.ok();
  }
  [[nodiscard]] Instant at(double time) const { return instant_of(time, motion_.segments.size()); }
  [[nodiscard]] const std::vector<ControlNormals>& of_segment(std::size_t s) {
    const auto found = segments_.find(s);
    return found != segments_.end() ? found->second : segments_.emplace(s, control_normals(normals_, s)).first->second;
  }
  [[nodiscard]] std::vector<Vec3d> directions(double time) {
    return key_directions(at(time), [this](std::size_t s) -> decltype(auto) { return of_segment(s); });
  }

  [[nodiscard]] Vec3f position(std::size_t keyframe, std::size_t v) const {
    return VectorView<const float>::packed(motion_.keyframes[keyframe].positions.data(),
                                           motion_.topology.vertex_count())[v];
  }
  [[nodiscard]] Vec3d position(const Instant& at, std::size_t v) const {
    return lerp(to_double(position(at.segment, v)), to_double(position(at.segment + 1, v)), at.t);
  }
  // Returns true if all vertices of the keyframes between a and b lie on the straight lines between their positions at
  // a and b.
  [[nodiscard]] bool is_straight(double a, double b) {
    if (!hold(a, b)) return false;
    const Instant start = at(a), end = at(b);
    for (std::size_t k = start.segment + 1; static_cast<double>(k) < b; ++k) {
      const double share = (static_cast<double>(k) - a) / (b - a);
      for (std::size_t v = 0; v < motion_.topology.vertex_count(); ++v) {
        const Vec3d off = lerp(position(start, v), position(end, v), share) - to_double(position(k, v));
        if (length(off) > most_off_) return false;
      }
    }
    return true;
  }

  const Motion& motion_;
  const SequenceNormals& normals_;
  double tolerance_;
  double most_off_ = 0;
  Status status_ = Success{};
  std::vector<std::vector<char>> left_out_;
  std::map<std::size_t, std::vector<ControlNormals>> segments_;
};

double time_of(std::size_t step) { return static_cast<double>(step) / kKeySteps; }

// Returns the last step, at most `to`, that a line from step `from` can reach (LineJudge::may_draw()). The caller knows
// that the line can reach the step `reached`, which may be equal to `from`.
std::size_t farthest(LineJudge& judge, std::size_t from, std::size_t reached, std::size_t to) {
  std::size_t beyond = to + 1;
  while (beyond - reached > 1) {
    const std::size_t middle = reached + (beyond - reached) / 2;
    (judge.may_draw(time_of(from), time_of(middle)) ? reached : beyond) = middle;
  }
  return reached;
}

std::size_t next_key(LineJudge& judge, std::size_t from, std::size_t last) {
  const auto keyframe_after = [last](std::size_t step) { return std::min(last, (step / kKeySteps + 1) * kKeySteps); };
  while (judge.status()) {
    std::size_t reached = from, next = keyframe_after(from);
    while (reached < last && judge.may_draw(time_of(from), time_of(next))) {
      reached = next;
      next = keyframe_after(next);
    }
    if (reached < last) reached = farthest(judge, from, reached, next - 1);
    if (reached > from) return reached;
    judge.leave_out(time_of(from), time_of(from + 1));
  }
  return last;
}

// Returns the number of pieces, at most kKeySteps, into which the worst segment must be cut, so that normals are within
// the tolerance. If all segments were cut evenly, each segment would get this number of pieces.
std::size_t even_pieces(LineJudge& judge, std::size_t segments, double tolerance) {
  std::size_t pieces = 1;
  const auto suffices = [&](double start) {
    const double count = static_cast<double>(pieces);
    for (std::size_t j = 0; j < pieces; ++j) {
      const double i = static_cast<double>(j);
      if (judge.error(start + i / count, start + (i + 1) / count) > tolerance) return false;
    }
    return true;
  };
  for (std::size_t s = 0; s < segments; ++s) {
    while (pieces < kKeySteps && !suffices(static_cast<double>(s))) ++pieces;
    judge.forget_before(s);
  }
  return pieces;
}

}  // namespace

Result<SequenceKeys> fewest_keys(const Motion& motion, const SequenceNormals& normals, double tolerance,
                                 const std::function<void(std::size_t segment)>& progress) {
  LineJudge judge(motion, normals, tolerance);
  const std::size_t segments = motion.segments.size(), last = segments * kKeySteps;
  SequenceKeys keys{{0}, 0, 0, 0};
  while (keys.at.back() < last) {
    const std::size_t from = keys.at.back(), next = next_key(judge, from, last);
    keys.largest_error = std::fmax(keys.largest_error, judge.error(time_of(from), time_of(next)));
    keys.at.push_back(next);
    judge.forget_before(next / kKeySteps);
    progress(next / kKeySteps);
  }
  keys.beyond = judge.left_out_count();
  keys.even = even_pieces(judge, segments, tolerance) * segments + 1;
  if (!judge.status()) return judge.status().error();
  return keys;
}

Result<KeyPose> key_pose(const SequenceNormals& normals, std::size_t step) {
  const Instant at = instant_of(time_of(step), normals.keys() - 1);
  if (const Status status = hold_between(normals, at, at); !status) return status.error();
  std::map<std::size_t, std::vector<ControlNormals>> segments;
  const auto of_segment = [&](std::size_t s) -> const std::vector<ControlNormals>& {
    return segments.emplace(s, control_normals(normals, s)).first->second;
  };
  KeyPose pose{normals.deltas(at.segment), key_directions(at, of_segment)};
  const std::vector<float> end = normals.deltas(at.segment + 1);
  for (std::size_t i = 0; i < end.size(); ++i)
    pose.deltas[i] = static_cast<float>((1 - at.t) * double{pose.deltas[i]} + at.t * double{end[i]});
  return pose;
}

}  // namespace chronormal::inline internal
