/// What has a normal: each face, each vertex, or each corner of a face; and who shares one.
///
/// Threads    everything here is pure.
#ifndef CHRONORMAL_NORMALS_ELEMENTS_H_
#define CHRONORMAL_NORMALS_ELEMENTS_H_

#include <cstdint>
#include <span>
#include <string_view>

#include "chronormal/core/result.h"
#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"
#include "chronormal/motion/motion_stream.h"
#include "chronormal/normals/normal_groups.h"

namespace chronormal {

enum class ElementKind { kFaces, kVertices, kCorners };

/// faces, vertices, corners
[[nodiscard]] std::string_view element_kind_name(ElementKind kind) noexcept;

/// face, vertex, corner
[[nodiscard]] std::string_view one_element(ElementKind kind) noexcept;

/// Finds a kind by its name. Errors: kUsage, with all names.
[[nodiscard]] Result<ElementKind> make_element_kind(std::string_view name);

/// Which normals. Corners share theirs across smooth edges; which edges are hard comes from one of three sources: the
/// crease angle, or else what a file says (Input in io/input.h), which the caller keeps alive.
struct ElementOptions {
  ElementKind kind = ElementKind::kFaces;
  bool weld = true;           ///< vertices at one point in all keyframes are one, so that seams do not show
  double crease_angle = 180;  ///< degrees; corners: edges that are sharper in keyframe 0 are hard
  std::span<const std::uint32_t> group_of_face = {};  ///< smoothing groups, where not empty
  VectorView<const float> normal_of_corner = {};      ///< split normals, where not empty
};

/// The groups of corners that vertices or corners of a motion stand for. Errors: kUsage for a crease angle outside
/// [0, 180]; kInvalidInput where there is not one smoothing group for each face, or one finite normal for each corner.
/// The motion may stand still: a keyframe without segments. Preconditions: it is valid else, and the kind is not faces
[[nodiscard]] Result<NormalGroups> make_groups(const Motion& motion, const ElementOptions& options);
/// The same for a stream, of which it reads keyframes as weld_coincident() does. Errors: also those of the stream.
[[nodiscard]] Result<NormalGroups> make_groups(MotionStream& stream, const ElementOptions& options);

}  // namespace chronormal

#endif  // CHRONORMAL_NORMALS_ELEMENTS_H_
