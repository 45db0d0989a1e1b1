#include "chronormal/motion/motion.h"

#include <cmath>
#include <string>

namespace chronormal {
namespace {

std::string keyframe_place(const Motion& motion, std::size_t k) {
  std::string place = "frame " + std::to_string(k);
  if (!motion.keyframes[k].name.empty()) place += " (" + motion.keyframes[k].name + ")";
  return place;
}

// What is wrong with a segment of a motion of this kind; nullptr if nothing is.
const char* fault_of_kind(MotionKind kind, std::size_t segment, const Motion::SegmentKeys& keys) {
  switch (kind) {
    case MotionKind::kSequence:
      return keys.from == segment && keys.to == segment + 1 ? nullptr
                                                            : "a segment of a sequence joins the next two keyframes";
    case MotionKind::kTargets:
      return keys.from == 0 && keys.to == segment + 1 ? nullptr
                                                      : "a target starts at keyframe 0, and each has a keyframe";
    case MotionKind::kAnimation:
      return keys.to == keys.from + 1 ? nullptr : "a segment of an animation joins neighbouring keyframes";
  }
  return nullptr;
}

}  // namespace

Status validate(const Motion& motion) {
  const std::size_t vertex_count = motion.topology.vertex_count();
  if (motion.topology.face_count() == 0) return invalid_input("", "the mesh has no faces");

  if (!motion.body_of_vertex.empty() && motion.body_of_vertex.size() != vertex_count)
    return invalid_input("", "there are " + std::to_string(motion.body_of_vertex.size()) + " bodies for " +
                                 std::to_string(vertex_count) + " vertices");

  for (std::size_t k = 0; k < motion.keyframes.size(); ++k) {
    const Motion::Keyframe& keyframe = motion.keyframes[k];
    if (keyframe.positions.size() % 3 != 0 || keyframe.positions.size() / 3 != vertex_count)
      return invalid_input(keyframe_place(motion, k), "the frame has " + std::to_string(keyframe.positions.size()) +
                                                          " coordinates, but " + std::to_string(vertex_count) +
                                                          " vertices need three each");
    for (std::size_t i = 0; i < keyframe.positions.size(); ++i) {
      if (!std::isfinite(keyframe.positions[i]))
        return invalid_input(keyframe_place(motion, k) + ", vertex " + std::to_string(i / 3),
                             "the position is not a finite number");
    }
    if (!keyframe.velocities.empty() && keyframe.velocities.size() != keyframe.positions.size())
      return invalid_input(keyframe_place(motion, k), "there is not one velocity for each vertex");
    for (std::size_t i = 0; i < keyframe.velocities.size(); ++i) {
      if (!std::isfinite(keyframe.velocities[i]))
        return invalid_input(keyframe_place(motion, k) + ", vertex " + std::to_string(i / 3),
                             "the velocity is not a finite number");
    }
    if (!std::isfinite(keyframe.time)) return invalid_input(keyframe_place(motion, k), "the time is not finite");
  }

  if (motion.segments.empty()) return invalid_input("", "there is no motion: it takes two keyframes or more");
  for (std::size_t s = 0; s < motion.segments.size(); ++s) {
    const auto [from, to] = motion.segments[s];
    const std::string place = "segment " + std::to_string(s);
    if (from >= motion.keyframes.size() || to >= motion.keyframes.size())
      return invalid_input(place, "the segment names a keyframe that does not exist");
    if (!(motion.keyframes[from].time < motion.keyframes[to].time))
      return invalid_input(place, "the time of its end is not after the time of its start");
    if (const char* const fault = fault_of_kind(motion.kind, s, motion.segments[s])) return invalid_input(place, fault);
  }
  if (motion.kind != MotionKind::kAnimation && motion.segments.size() + 1 != motion.keyframes.size())
    return invalid_input("", "there are " + std::to_string(motion.segments.size()) + " segments for " +
                                 std::to_string(motion.keyframes.size()) + " keyframes");
  return Success{};
}

}  // namespace chronormal
