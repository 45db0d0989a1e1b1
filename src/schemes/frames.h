/// The frames that a face can have, and the rotation between two frames (section 2.5 of the paper).
///
/// A frame F = (tangent, binormal, normal) is an orthonormal, right-handed triple with binormal = normal x tangent. The
/// paper asks which F0 and F1 make quaternion slerp interpolate normals best; each function here is one answer. The
/// functions return nothing if their construction fails (singular M, an edge of no length).
#ifndef CHRONORMAL_SCHEMES_FRAMES_H_
#define CHRONORMAL_SCHEMES_FRAMES_H_

#include <cstdint>
#include <optional>

#include "schemes/arc.h"

namespace chronormal::inline internal {

struct Frame {
  Vec3d tangent, binormal, normal;
};

struct FramePair {
  Frame at_start, at_end;
};

/// Returns frames through the paper's matrix M, which maps the face at t = 0, with its normal, to the face at t = 1.
[[nodiscard]] std::optional<FramePair> matrix_frames(const ElementMotion& element);
/// Returns frames whose tangent is along the first edge of the face at both ends.
[[nodiscard]] std::optional<FramePair> edge_frames(const ElementMotion& element);
/// Returns frames in which F1 is F0 turned by the rotation of M (see matrix_frames()), by its polar decomposition.
[[nodiscard]] std::optional<FramePair> polar_frames(const ElementMotion& element);
/// Returns the edge frames, with the second frame turned about its normal by an angle that is drawn from (seed,
/// segment, element).
[[nodiscard]] std::optional<FramePair> random_frames(const ElementMotion& element, std::uint64_t seed);

/// A rotation about an axis.
struct Rotation {
  Vec3d axis;        ///< unit length, or zero if nothing turns
  double angle = 0;  ///< radians
};
/// Returns the rotation that takes F0 to F1, by at most half a turn.
[[nodiscard]] Rotation shorter_rotation(const FramePair& frames);

/// Returns the path of the normal under quaternion slerp from F0 to F1 on the shorter arc (eq. 7).
[[nodiscard]] Arc shorter_arc(const FramePair& frames);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_SCHEMES_FRAMES_H_
