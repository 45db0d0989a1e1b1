/// The frames that a face can have, and the rotation between two frames (section 2.5 of the paper).
///
/// A frame F = (tangent, binormal, normal) is an orthonormal, right-handed triple with binormal = normal x tangent. The
/// paper asks for which F0 and F1 quaternion slerp interpolates normals best; each function here is one answer. A
/// function returns no value if its construction fails (singular M, an edge of length zero).
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

/// Returns frames by the paper's matrix M, which maps the edges and the normal of the face at t = 0 to those at t = 1.
[[nodiscard]] std::optional<FramePair> matrix_frames(const ElementMotion& element);
/// Returns frames whose tangents are along the first edge of the face, at t = 0 and at t = 1.
[[nodiscard]] std::optional<FramePair> edge_frames(const ElementMotion& element);
/// Returns the edge frame at t = 0, and this frame turned by the rotation in the polar decomposition of M (see
/// matrix_frames()).
[[nodiscard]] std::optional<FramePair> polar_frames(const ElementMotion& element);
/// Returns the edge frames, but with the second frame turned about its normal by a pseudo-random angle that depends on
/// seed, segment and element.
[[nodiscard]] std::optional<FramePair> random_frames(const ElementMotion& element, std::uint64_t seed);

/// A rotation about an axis through the origin.
struct Rotation {
  Vec3d axis;        ///< unit vector, or zero if the angle is zero
  double angle = 0;  ///< the angle of the rotation in radians
};
/// Returns the rotation that takes the frame at the start (F0) to the frame at the end (F1) by at most half a turn.
[[nodiscard]] Rotation shorter_rotation(const FramePair& frames);

/// Returns the path of the normal when quaternion slerp turns the frame at the start (F0) to the frame at the end (F1)
/// on the shorter arc (eq. 7).
[[nodiscard]] Arc shorter_arc(const FramePair& frames);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_SCHEMES_FRAMES_H_
