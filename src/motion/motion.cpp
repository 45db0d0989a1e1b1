#include "chronormal/motion/motion.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "core/charconv.h"
#include "core/text.h"
#include "core/twofold.h"

namespace chronormal {
namespace {

Error misuse(std::string message) { return Error{ErrorCode::kUsage, "", std::move(message)}; }

// Returns a / b, rounded once. Precondition: a is not above b.
double quotient(const Twofold& a, const Twofold& b) noexcept {
  const double first = a.high / b.high;
  if (a.low == 0 && b.low == 0) return first;
  return first + ((std::fma(-first, b.high, a.high) + a.low) - first * b.low) / b.high;
}

Segment between(const Topology& topology, const Motion::Keyframe& from, const Motion::Keyframe& to, double start,
                double end, std::size_t index) noexcept {
  const auto positions = [&](const Motion::Keyframe& keyframe) {
    return VectorView<const float>::packed(keyframe.positions.data(), topology.vertex_count());
  };
  const auto residuals = [](const Motion::Keyframe& keyframe) {
    return VectorView<const double>::packed(keyframe.residuals);
  };
  return {&topology, positions(from), positions(to), start, end, index, residuals(from), residuals(to)};
}

}  // namespace

std::string_view motion_kind_name(MotionKind kind) noexcept {
  if (kind == MotionKind::kTargets) return "targets";
  return kind == MotionKind::kAnimation ? "animation" : "sequence";
}

Segment Motion::segment(std::size_t i) const noexcept {
  assert(i < segments.size());
  const Keyframe& from = keyframes[segments[i].from];
  const Keyframe& to = keyframes[segments[i].to];
  return between(topology, from, to, from.time, to.time, i);
}

void Motion::Keyframe::set_positions(std::span<const double> high, std::span<const double> low) {
  assert(high.size() == low.size());
  positions.resize(high.size());
  residuals.resize(high.size());
  bool is_rounded = false;
  for (std::size_t i = 0; i < high.size(); ++i) {
    positions[i] = static_cast<float>(high[i]);
    residuals[i] = (high[i] - double{positions[i]}) + low[i];
    is_rounded |= residuals[i] != 0;
  }
  if (!is_rounded) residuals = {};
}

Segment still_segment(const Topology& topology, const Motion::Keyframe& keyframe) noexcept {
  return between(topology, keyframe, keyframe, 0, 1, 0);
}

void Motion::connect(MotionKind as) {
  kind = as;
  segments.clear();
  for (std::size_t k = 0; k + 1 < keyframes.size(); ++k) {
    const bool is_jump = kind == MotionKind::kAnimation && keyframes[k].time == keyframes[k + 1].time;
    if (!is_jump) segments.push_back({kind == MotionKind::kTargets ? 0 : k, k + 1});
  }
}

LocalTime LocalTime::between(double start, double time, double end) noexcept {
  assert(start < end);
  if (!(start < time)) return std::isnan(time) ? time : 0.0;
  if (!(time < end)) return 1.0;
  // If the difference of two times exceeds the range of double, all times are halved first. Halving rounds only
  // times below 2^-1021, and this rounding is far too small to matter beside such a large difference.
  const double scale = std::isfinite(end - start) ? 1 : 0.5;
  const Twofold done = Twofold::sum(scale * time, -scale * start), left = Twofold::sum(scale * end, -scale * time),
                whole = Twofold::sum(scale * end, -scale * start);
  LocalTime result(quotient(done, whole));
  // The size of a dividend below which the remainder of the division may be too small for a double.
  constexpr double kSmallest = 0x1p-900;
  const bool is_exact =
      done.low == 0 && whole.low == 0 && done.high >= kSmallest && std::fma(result.t, whole.high, -done.high) == 0;
  if (is_exact) return result;
  result.rest = quotient(left, whole);
  result.start = start;
  result.time = time;
  result.end = end;
  return result;
}

double time_of_keyframe_at(const Motion& motion, double time) noexcept {
  constexpr double kHalfUnit = 0x1p-24;      // the relative error of rounding to float32
  constexpr double kRounding = 8 * 0x1p-53;  // of a sum of steps, such as 7 x 0.1
  for (const Motion::Keyframe& keyframe : motion.keyframes) {
    const double key = keyframe.time, most = std::fabs(key);
    const auto stored = static_cast<float>(key);
    if (time == key || !(std::fabs(time - key) <= kHalfUnit * most) || double{stored} != key) continue;
    std::array<char, 32> text{};
    double decimal = 0;
    const auto written = to_chars(text.data(), text.data() + text.size(), stored);
    if (from_chars(text.data(), written.ptr, decimal).ec == std::errc{} &&
        std::fabs(time - decimal) <= kRounding * most)
      return key;
  }
  return time;
}

Result<Instant> find_instant(const Motion& motion, double asked) {
  const double time = time_of_keyframe_at(motion, asked);
  if (motion.segments.empty()) return misuse("the mesh does not move, so it has no times; leave the times out");
  if (motion.kind == MotionKind::kTargets)
    return misuse("blend shapes have no times; give a weight for each target instead");
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
    return misuse("time " + rounded_text(time, {first, last}) + " is outside of the motion, which goes from " +
                  rounded_text(first, {time, last}) + " to " + rounded_text(last, {time, first}) +
                  "; choose a time in between");
  return Instant{*found, LocalTime::between(start_of(*found), time, end_of(*found))};
}

}  // namespace chronormal
