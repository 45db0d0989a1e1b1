#include "chronormal/motion/motion.h"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <limits>
#include <optional>
#include <string>
#include <utility>

namespace chronormal {
namespace {

Error misuse(std::string message) { return Error{ErrorCode::kUsage, "", std::move(message)}; }

// The fewest digits that read back as the same number, so that it can be pasted.
std::string text_of(double number) {
  char digits[32];
  return {digits, std::to_chars(digits, digits + sizeof digits, number).ptr};
}

}  // namespace

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

void Motion::connect_as_sequence() {
  segments.clear();
  for (std::size_t k = 0; k + 1 < keyframes.size(); ++k) segments.push_back({k, k + 1});
}

bool is_blend_shapes(const Motion& motion) noexcept {
  for (std::size_t s = 0; s < motion.segments.size(); ++s) {
    if (motion.segments[s].from != 0 || motion.segments[s].to != s + 1) return false;
  }
  return !motion.segments.empty() && motion.keyframes.size() == motion.segments.size() + 1;
}

Result<Instant> find_instant(const Motion& motion, double time) {
  if (motion.segments.empty()) return misuse("the mesh stands still: it has no times");
  if (motion.segments.size() > 1 && is_blend_shapes(motion))
    return misuse("blend shapes have no times, but a weight for each target");
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
    return misuse("there is no motion at time " + text_of(time) + ": it goes from " + text_of(first) + " to " +
                  text_of(last));
  const double t = (time - start_of(*found)) / (end_of(*found) - start_of(*found));
  return Instant{*found, std::clamp(t, 0.0, 1.0)};
}

}  // namespace chronormal
