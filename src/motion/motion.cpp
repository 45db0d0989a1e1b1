#include "chronormal/motion/motion.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "core/text.h"

namespace chronormal {
namespace {

Error misuse(std::string message) { return Error{ErrorCode::kUsage, "", std::move(message)}; }

// The fewest digits that read back as the same number, so that it can be pasted.
}  // namespace

std::string_view motion_kind_name(MotionKind kind) noexcept {
  if (kind == MotionKind::kTargets) return "targets";
  return kind == MotionKind::kAnimation ? "animation" : "sequence";
}

Segment Motion::segment(std::size_t i) const noexcept {
  assert(i < segments.size());
  const Keyframe& from = keyframes[segments[i].from];
  const Keyframe& to = keyframes[segments[i].to];
  const std::size_t count = topology.vertex_count();
  return {&topology,
          VectorView<const float>::packed(from.positions.data(), count),
          VectorView<const float>::packed(to.positions.data(), count),
          from.time,
          to.time,
          i};
}

void Motion::connect(MotionKind as) {
  kind = as;
  segments.clear();
  for (std::size_t k = 0; k + 1 < keyframes.size(); ++k) {
    const bool is_jump = kind == MotionKind::kAnimation && keyframes[k].time == keyframes[k + 1].time;
    if (!is_jump) segments.push_back({kind == MotionKind::kTargets ? 0 : k, k + 1});
  }
}

Result<Instant> find_instant(const Motion& motion, double time) {
  if (motion.segments.empty()) return misuse("the mesh stands still: it has no times");
  if (motion.kind == MotionKind::kTargets) return misuse("blend shapes have no times, but a weight for each target");
  const auto start_of = [&](std::size_t s) { return motion.keyframes[motion.segments[s].from].time; };
  const auto end_of = [&](std::size_t s) { return motion.keyframes[motion.segments[s].to].time; };
  double first = std::numeric_limits<double>::infinity(), last = -first;
  std::optional<std::size_t> found;
  for (std::size_t s = 0; s < motion.segments.size(); ++s) {
    first = std::min(first, start_of(s));
    last = std::max(last, end_of(s));
    if (start_of(s) <= time && time <= end_of(s)) found = s;
  }
  if (!found)
    return misuse("there is no motion at time " + shortest_text(time) + ": it goes from " + shortest_text(first) +
                  " to " + shortest_text(last));
  const double t = (time - start_of(*found)) / (end_of(*found) - start_of(*found));
  return Instant{*found, std::clamp(t, 0.0, 1.0)};
}

}  // namespace chronormal
