#include "chronormal/motion/motion.h"

#include <cassert>

namespace chronormal {

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

}  // namespace chronormal
