#include "chronormal/motion/motion.h"

#include <cassert>
#include <cmath>
#include <utility>

#include "core/text.h"
#include "core/twofold.h"

namespace chronormal {
namespace {

bool all_finite(std::span<const float> values) {
  for (const float value : values)
    if (!std::isfinite(value)) return false;
  return true;
}

}  // namespace

BlendTarget BlendTarget::from_dense(std::span<const float> deltas, std::string name) {
  BlendTarget target;
  target.name = std::move(name);
  for (std::size_t v = 0; 3 * v < deltas.size(); ++v) {
    const auto delta = deltas.subspan(3 * v, 3);
    if (delta[0] == 0 && delta[1] == 0 && delta[2] == 0) continue;
    target.vertices.push_back(static_cast<std::uint32_t>(v));
    target.deltas.insert(target.deltas.end(), delta.begin(), delta.end());
  }
  return target;
}

Result<BlendSet> blend_set_of(const Motion& star) {
  BlendSet set;
  set.topology = star.topology;
  set.base = star.keyframes.front().positions;
  for (std::size_t k = 0; k < star.segments.size(); ++k) {
    const Motion::SegmentKeys& segment = star.segments[k];
    const auto place = [k] { return std::string("target ").append(std::to_string(k)); };
    if (segment.from != 0)
      return Error{
          ErrorCode::kUsage, place(),
          std::string(
              "each target must go from the base, keyframe 0, to its own keyframe, but this one begins at keyframe ")
              .append(std::to_string(segment.from))};
    const Motion::Keyframe& end = star.keyframes[segment.to];
    std::vector<float> deltas(end.positions);
    const std::vector<double>&of_end = end.residuals, &of_base = star.keyframes.front().residuals;
    for (std::size_t i = 0; i < deltas.size(); ++i)
      deltas[i] = static_cast<float>(
          difference(end.positions[i], of_end.empty() ? 0 : of_end[i], set.base[i], of_base.empty() ? 0 : of_base[i]));
    if (!all_finite(deltas))
      return invalid_input(place(), "a delta of the target is too large for float32; scale the mesh down");
    set.targets.push_back(BlendTarget::from_dense(deltas, end.name));
  }
  return set;
}

Status validate(const BlendTarget& target, const Topology& topology, std::size_t k) {
  const auto place = [k](std::size_t n) { return "target " + std::to_string(k) + ", entry " + std::to_string(n); };
  if (target.deltas.size() != 3 * target.vertices.size())
    return invalid_input("target " + std::to_string(k),
                         "the target has " + counted(target.deltas.size(), "coordinate", "coordinates") + " for " +
                             counted(target.vertices.size(), "vertex", "vertices") + ", but must have 3 for each");
  for (std::size_t n = 0; n < target.vertices.size(); ++n) {
    if (target.vertices[n] >= topology.vertex_count())
      return invalid_input(
          place(n), "the target moves vertex " + std::to_string(target.vertices[n]) + ", but the mesh has only " +
                        counted(topology.vertex_count(), "vertex", "vertices") + "; give the mesh of the target");
    if (n > 0 && target.vertices[n] <= target.vertices[n - 1])
      return invalid_input(place(n), "the vertices of a target must be in ascending order, each once");
    if (!all_finite(std::span(target.deltas).subspan(3 * n, 3)))
      return invalid_input(place(n), "the delta is NaN or infinite; deltas must be finite numbers");
  }
  return Success{};
}

Status validate(const BlendSet& set) {
  if (set.base.size() != 3 * set.topology.vertex_count())
    return invalid_input("base", "the base has " + counted(set.base.size(), "coordinate", "coordinates") + " for " +
                                     counted(set.topology.vertex_count(), "vertex", "vertices") +
                                     ", but must have 3 for each");
  for (std::size_t v = 0; v < set.topology.vertex_count(); ++v) {
    if (!all_finite(std::span(set.base).subspan(3 * v, 3)))
      return invalid_input("base, vertex " + std::to_string(v),
                           "the position is NaN or infinite; positions must be finite numbers");
  }
  for (std::size_t k = 0; k < set.targets.size(); ++k)
    if (Status status = validate(set.targets[k], set.topology, k); !status) return status;
  return Success{};
}

void blend_positions(const BlendSet& set, std::span<const double> weights, std::span<double> result) noexcept {
  assert(weights.size() == set.targets.size() && result.size() == set.base.size());
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = static_cast<double>(set.base[i]);
  for (std::size_t k = 0; k < weights.size(); ++k) {
    if (weights[k] == 0) continue;
    const BlendTarget& target = set.targets[k];
    for (std::size_t n = 0; n < target.vertices.size(); ++n) {
      for (std::size_t c = 0; c < 3; ++c)
        result[3 * std::size_t{target.vertices[n]} + c] += weights[k] * static_cast<double>(target.deltas[3 * n + c]);
    }
  }
}

}  // namespace chronormal
