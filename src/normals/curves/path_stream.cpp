// Holds what paths follow from, and adds up how far they bend.
#include "normals/curves/path_stream.h"

#include <algorithm>
#include <vector>

#include "chronormal/core/vec3.h"
#include "chronormal/core/views.h"

namespace chronormal {

std::pair<std::size_t, std::size_t> internal::keyframes_of_paths(const Motion& motion, std::size_t first,
                                                                 std::size_t last, PathKind path) {
  if (path == PathKind::kLinear) return {motion.segments[first].from, motion.segments[last].to};
  const std::size_t end = motion.keyframes.size() - 1;
  const std::size_t from = std::min(first - std::min<std::size_t>(first, 1), end - std::min<std::size_t>(end, 3));
  return {from, std::min(std::max<std::size_t>(last + 2, 3), end)};
}

Status internal::hold_paths(MotionStream& stream, std::size_t first, std::size_t last, PathKind path) {
  const auto [from, to] = keyframes_of_paths(stream.motion(), first, last, path);
  return stream.hold(from, to);
}

BendSums internal::bend_at(const Motion& motion, std::size_t at, std::size_t every) {
  BendSums sums;
  if (at < every || at + every >= motion.keyframes.size()) return sums;
  const Motion::Keyframe &from = motion.keyframes[at - every], &middle = motion.keyframes[at],
                         &to = motion.keyframes[at + every];
  // Times may be uneven, so the middle keyframe is compared with the place on the straight line at its time.
  const double part = (middle.time - from.time) / (to.time - from.time);
  const auto positions = [&](const Motion::Keyframe& key) {
    return VectorView<const float>::packed(key.positions.data(), motion.topology.vertex_count());
  };
  const auto before = positions(from), here = positions(middle), after = positions(to);
  for (std::size_t v = 0; v < here.count; ++v) {
    const Vec3d p = to_double(before[v]), q = to_double(here[v]), r = to_double(after[v]);
    // With even times, the second difference is twice the distance from the middle.
    sums.bent += 2 * length(q - ((1 - part) * p + part * r));
    sums.way += length(q - p) + length(r - q);
  }
  return sums;
}

Result<double> bend_of(MotionStream& stream, std::size_t every) {
  const Motion& motion = stream.motion();
  BendSums all;
  for (std::size_t i = every; i + every < motion.keyframes.size(); i += every) {
    if (const Status status = stream.hold(i - every, i + every); !status) return status.error();
    all.add(bend_at(motion, i, every));
  }
  return all.bend();
}

Result<VelocityFit> velocity_fit(MotionStream& stream) {
  const Motion& motion = stream.motion();
  std::vector<std::size_t> segments;
  for (std::size_t s = 0; s + 1 < motion.keyframes.size(); ++s)
    if (!motion.keyframes[s].velocities.empty() && !motion.keyframes[s + 1].velocities.empty()) segments.push_back(s);
  const std::size_t used = std::min<std::size_t>(segments.size(), 64);
  double way = 0, at_speed = 0, along = 0, weight = 0;
  for (std::size_t i = 0; i < used; ++i) {
    const std::size_t s = segments[used < 2 ? 0 : i * (segments.size() - 1) / (used - 1)];
    if (const Status status = stream.hold(s, s + 1); !status) return status.error();
    const Motion::Keyframe &from = motion.keyframes[s], &to = motion.keyframes[s + 1];
    const auto vectors = [&](const std::vector<float>& numbers) {
      return VectorView<const float>::packed(numbers.data(), motion.topology.vertex_count());
    };
    const auto before = vectors(from.positions), after = vectors(to.positions);
    const auto leaving = vectors(from.velocities), arriving = vectors(to.velocities);
    for (std::size_t v = 0; v < before.count; ++v) {
      const Vec3d chord = to_double(after[v]) - to_double(before[v]);
      for (const Vec3d& velocity : {to_double(leaving[v]), to_double(arriving[v])}) {
        const Vec3d step = (to.time - from.time) / 2 * velocity;
        at_speed += length(step);
        along += dot(step, chord);
        weight += length(step) * length(chord);
      }
      way += length(chord);
    }
  }
  VelocityFit fit;
  if (way > 0) fit.length = at_speed / way;
  if (weight > 0) fit.direction = along / weight;
  return fit;
}

double bend_of(const Motion& motion, std::size_t every) {
  MotionStream stream(motion);
  return bend_of(stream, every).value();
}

}  // namespace chronormal
