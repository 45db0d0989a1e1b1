// Checks a motion: its outline, and the positions of each keyframe.
#include "chronormal/motion/motion.h"

#include <cmath>
#include <string>

#include "core/text.h"
#include "motion/outline.h"

namespace chronormal {
namespace {

std::string keyframe_place(const Motion& motion, std::size_t k) {
  std::string place = "frame " + std::to_string(k);
  if (!motion.keyframes[k].name.empty()) place += " (" + motion.keyframes[k].name + ")";
  return place;
}

// Returns what is wrong with a segment in a motion of this kind, or nullptr if nothing is.
const char* fault_of_kind(MotionKind kind, std::size_t segment, const Motion::SegmentKeys& keys) {
  switch (kind) {
    case MotionKind::kSequence:
      return keys.from == segment && keys.to == segment + 1
                 ? nullptr
                 : "segment k of a sequence must go from keyframe k to keyframe k + 1";
    case MotionKind::kTargets:
      return keys.from == 0 && keys.to == segment + 1
                 ? nullptr
                 : "segment k of a set of targets must go from keyframe 0 to keyframe k + 1";
    case MotionKind::kAnimation:
      return keys.to == keys.from + 1 ? nullptr
                                      : "a segment of an animation must go from a keyframe k to keyframe k + 1";
  }
  return nullptr;
}

Status check_mesh(const Motion& motion) {
  if (motion.topology.face_count() == 0)
    return invalid_input("", "the mesh has no faces, so it has no normals; give it faces");
  if (!motion.body_of_vertex.empty() && motion.body_of_vertex.size() != motion.topology.vertex_count())
    return invalid_input("", "the list of bodies has " + counted(motion.body_of_vertex.size(), "entry", "entries") +
                                 ", but the mesh has " + counted(motion.topology.vertex_count(), "vertex", "vertices") +
                                 "; give one entry for each vertex");
  return Success{};
}

Status check_residuals(const Motion& motion, std::size_t k) {
  const Motion::Keyframe& keyframe = motion.keyframes[k];
  if (keyframe.residuals.empty()) return Success{};
  if (keyframe.residuals.size() != keyframe.positions.size())
    return invalid_input(
        keyframe_place(motion, k),
        "the keyframe must have one residual (what rounding to float32 left over) for each coordinate");
  for (std::size_t i = 0; i < keyframe.residuals.size(); ++i) {
    if (static_cast<float>(double{keyframe.positions[i]} + keyframe.residuals[i]) != keyframe.positions[i])
      return invalid_input(
          keyframe_place(motion, k) + ", vertex " + std::to_string(i / 3),
          "the residual is larger than the rounding of its position to float32; compute the residuals again");
  }
  return Success{};
}

// Checks everything in a keyframe except its positions.
Status check_rest(const Motion& motion, std::size_t k) {
  const Motion::Keyframe& keyframe = motion.keyframes[k];
  const auto fits = [&](const std::vector<float>& velocities) {
    return velocities.empty() || velocities.size() == 3 * motion.topology.vertex_count();
  };
  if (!fits(keyframe.velocities) || !fits(keyframe.end_velocities))
    return invalid_input(keyframe_place(motion, k), "the keyframe must have one velocity for each vertex");
  for (const std::vector<float>* velocities : {&keyframe.velocities, &keyframe.end_velocities}) {
    for (std::size_t i = 0; i < velocities->size(); ++i) {
      if (!std::isfinite((*velocities)[i]))
        return invalid_input(keyframe_place(motion, k) + ", vertex " + std::to_string(i / 3),
                             "the velocity is NaN or infinite; velocities must be finite numbers");
    }
  }
  if (!std::isfinite(motion.keyframes[k].time))
    return invalid_input(keyframe_place(motion, k), "the time is NaN or infinite; times must be finite numbers");
  return Success{};
}

Status check_segments(const Motion& motion) {
  if (motion.segments.empty()) return invalid_input("", "a motion needs at least two keyframes; add keyframes");
  for (std::size_t s = 0; s < motion.segments.size(); ++s) {
    const auto [from, to] = motion.segments[s];
    const std::string place = "segment " + std::to_string(s);
    if (from >= motion.keyframes.size() || to >= motion.keyframes.size())
      return invalid_input(place, "the segment refers to a keyframe that does not exist; correct the segment");
    if (!(motion.keyframes[from].time < motion.keyframes[to].time))
      return invalid_input(place, "the keyframe at the end of the segment must be later than the one at its start");
    if (const char* const fault = fault_of_kind(motion.kind, s, motion.segments[s])) return invalid_input(place, fault);
  }
  if (motion.kind != MotionKind::kAnimation && motion.segments.size() + 1 != motion.keyframes.size())
    return invalid_input("", "the motion has " + counted(motion.segments.size(), "segment", "segments") +
                                 ", but must have one fewer than its " +
                                 counted(motion.keyframes.size(), "keyframe", "keyframes"));
  return Success{};
}

}  // namespace

Status internal::validate_positions(const Motion& motion, std::size_t k, std::span<const float> positions) {
  const std::size_t vertex_count = motion.topology.vertex_count();
  if (positions.size() % 3 != 0 || positions.size() / 3 != vertex_count)
    return invalid_input(keyframe_place(motion, k),
                         "the frame has " + counted(positions.size(), "coordinate", "coordinates") + " for " +
                             counted(vertex_count, "vertex", "vertices") + ", but must have 3 for each");
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (!std::isfinite(positions[i]))
      return invalid_input(keyframe_place(motion, k) + ", vertex " + std::to_string(i / 3),
                           "the position is NaN or infinite; positions must be finite numbers");
  }
  return Success{};
}

Status internal::validate_outline(const Motion& motion) {
  if (Status status = check_mesh(motion); !status) return status;
  for (std::size_t k = 0; k < motion.keyframes.size(); ++k)
    if (Status status = check_rest(motion, k); !status) return status;
  return check_segments(motion);
}

Status validate(const Motion& motion) {
  if (Status status = check_mesh(motion); !status) return status;
  for (std::size_t k = 0; k < motion.keyframes.size(); ++k) {
    if (Status status = validate_positions(motion, k, motion.keyframes[k].positions); !status) return status;
    if (Status status = check_residuals(motion, k); !status) return status;
    if (Status status = check_rest(motion, k); !status) return status;
  }
  return check_segments(motion);
}

}  // namespace chronormal
