/// Reads skins of glTF files: the transforms of their joints at any time, and the joints of each vertex. Private to io
/// and workflow.
///
///     joint matrix    the transform of the joint in the world, after the inverse bind matrix of the skin. The matrix
///                     maps a vertex of the mesh that follows only this joint to its position (section 3.7.3.3 of the
///                     specification). The transform of the node with the skin does not matter.
///
/// Opening a document does not check its skins, so that callers that do not need skins can read a file with an invalid
/// skin.
#ifndef CHRONORMAL_IO_GLTF_GLTF_SKIN_H_
#define CHRONORMAL_IO_GLTF_GLTF_SKIN_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/io/gltf_document.h"
#include "chronormal/normals/control_normals.h"
#include "io/gltf/gltf_weights.h"
#include "io/gltf/model/gltf_model.h"

namespace chronormal::inline internal {

/// A joint that moves a vertex, and the share of this joint in the position of the vertex, from 0 to 1.
struct JointShare {
  std::uint32_t joint = 0;
  double share = 0;
};

/// Bounds of the motion of a bone, which is a joint or a node above a joint, over an interval of time in which no curve
/// has a key. `size`, `speed` and `bend` bound the linear part of the bone's matrix in the world. `path_bend` bounds
/// the second derivative of the offset of this matrix, as the sum of what each bone from the root to this bone adds.
/// For a joint below a bone, the `path_bend` of the joint minus the `path_bend` of the bone therefore bounds the second
/// derivative of the difference of the two offsets.
struct BoneBounds {
  double size = 1, speed = 0, bend = 0;  ///< of its value, and of its first and second derivative in time
  double path_bend = 0;
};

class GltfSkin {
 public:
  /// Reads the skin of a node, and the animation of its joints. If `animation` has no value, the joints stay as they
  /// are in the file. Errors: kInvalidInput with the JSON pointer, if the skin or the animation violates the
  /// specification.
  [[nodiscard]] static Result<GltfSkin> read(const GltfDocument& document, std::size_t node,
                                             std::optional<std::size_t> animation);

  /// Appends the joints and shares of all vertices of a primitive to `shares`, and for each vertex the index of its
  /// first share to `first`. The shares of a vertex add up to 1: weights with another sum are divided by that sum, and
  /// a vertex without any weight follows its first joint, as in three.js. Joints without a weight are left out. Errors:
  /// kInvalidInput with the JSON pointer, also for joints that this skin does not have.
  [[nodiscard]] Status read_shares(const GltfDocument& document, std::size_t mesh, std::size_t primitive,
                                   std::vector<std::size_t>& first, std::vector<JointShare>& shares) const;

  [[nodiscard]] std::size_t joint_count() const noexcept { return joints_.size(); }

  /// Returns true if the animation moves joints.
  [[nodiscard]] bool moves() const noexcept { return !curves_.empty(); }

  /// Returns the times of the keys of all curves in seconds, ascending, each once.
  [[nodiscard]] std::vector<double> key_times() const;

  /// Returns the joint matrices at a time in seconds. If joints jump at this time, the matrices are those just after
  /// the jump, or just before the jump if just_before is set. O(joints and nodes above them).
  [[nodiscard]] std::vector<AffineTransform> pose(double time, bool just_before) const;

  /// Returns true if joints jump in the animation.
  [[nodiscard]] bool jumps() const noexcept;

  /// Returns bounds for all bones between two times that have no key time between them. The bounds are infinite
  /// for a cubic rotation that may have no direction. O(bones + curves).
  [[nodiscard]] std::vector<BoneBounds> bounds(double from, double to) const;

  /// bone_of_joint() returns the bone of a joint. meeting_bone() returns the bone at which the paths of two bones to
  /// their roots meet, or nothing if the roots differ. inverse_bind() returns the inverse bind matrix of a joint.
  [[nodiscard]] std::size_t bone_of_joint(std::size_t joint) const noexcept { return bone_of_joint_[joint]; }
  [[nodiscard]] std::optional<std::size_t> meeting_bone(std::size_t a, std::size_t b) const noexcept;
  [[nodiscard]] const AffineTransform& inverse_bind(std::size_t joint) const noexcept { return inverse_binds_[joint]; }

 private:
  // A joint, or a node above a joint. Parents come before their children.
  struct Bone {
    gltf::Placement placement;
    std::optional<std::size_t> parent;  // index among the bones
  };
  struct Curve {
    std::size_t bone = 0;
    gltf::NodeChannel::Path path = gltf::NodeChannel::Path::kTranslation;
    GltfInterpolation interpolation = GltfInterpolation::kLinear;
    gltf::WeightCurve curve;
  };

  // Returns the rotation of a joint at a time. LINEAR keys are interpolated along the arc between them, as the
  // specification demands.
  [[nodiscard]] static std::array<double, 4> rotation_at(const Curve& moving, double time, bool just_before);
  // Collects the joints and all their ancestors as bones.
  void add_bones(const GltfDocument& document);
  [[nodiscard]] Status add_curve(const GltfDocument& document, const gltf::NodeChannel& channel);

  std::vector<std::uint32_t> joints_;        // index of the node of each joint
  std::vector<std::uint32_t> bone_of_node_;  // kNoBone if the node is not a bone
  std::vector<std::uint32_t> bone_of_joint_;
  std::vector<AffineTransform> inverse_binds_;
  std::vector<Bone> bones_;
  std::vector<Curve> curves_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_GLTF_GLTF_SKIN_H_
