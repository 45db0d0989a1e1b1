/// Moves the vertices of a mesh by the skin of a node. Private to workflow.
///
/// Viewers blend the joint matrices of a vertex by its weights, M = sum of w_j M_j. They transform the position by M,
/// and the normal by the linear part L of M (docs/decisions/0022 lists viewers that differ). L is not the normal
/// matrix. If L does more than rotate and scale evenly, it does not take the true normal to the normal of the skinned
/// surface. No target can correct this. For this reason the error is measured between normals that L has transformed,
/// and the error of L itself is reported separately.
///
/// Copies     All copies share the data of the file. Each copy has its own pose.
/// Threads    const functions may run at the same time.
#ifndef CHRONORMAL_WORKFLOW_SHADING_MESH_SKIN_H_
#define CHRONORMAL_WORKFLOW_SHADING_MESH_SKIN_H_

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/core/vec3.h"
#include "chronormal/io/gltf_document.h"
#include "chronormal/normals/control_normals.h"
#include "chronormal/workflow/viewers.h"
#include "io/gltf/gltf_skin.h"
#include "workflow/shading/gltf_shading.h"

namespace chronormal::inline internal {

class MeshSkin {
 public:
  /// Reads the skin of a node for the mesh of the shading, and places the joints as in the file at rest. If
  /// `of_same_mesh` is given, reuses the joints and shares of this skin instead of reading them again. Errors: those of
  /// GltfSkin.
  [[nodiscard]] static Result<MeshSkin> read(const GltfDocument& document, const GltfShading& shading, std::size_t node,
                                             std::optional<std::size_t> animation,
                                             const MeshSkin* of_same_mesh = nullptr);

  /// Poses the joints as they are at a time in seconds. If the joints jump at that time, uses the pose just after the
  /// jump, or just before the jump if just_before is true. Returns true if the pose may have changed.
  bool pose(double time, bool just_before);

  /// Tells whether the joints move in the animation for which the skin was read.
  [[nodiscard]] bool moves() const noexcept { return skin_->moves(); }

  /// Returns the times in seconds of all keys that move joints, in ascending order.
  [[nodiscard]] std::vector<double> key_times() const { return skin_->key_times(); }

  /// Tells whether, in the present pose, the blended matrix of each of these vertices only rotates and scales evenly.
  /// Differences too small to matter are ignored. Such a matrix keeps the angle between any two normals of the vertex.
  [[nodiscard]] bool is_even(std::span<const std::uint32_t> vertices) const;

  /// Returns the blended joint matrix of a vertex in the present pose.
  [[nodiscard]] AffineTransform of_vertex(std::size_t vertex) const noexcept;

  /// Returns the direction in which a viewer renders a vertex's normal in the present pose. The normal has any length;
  /// matrix must be the result of of_vertex(vertex). The result is a unit vector, or zero, infinite or NaN if the
  /// rendered normal has no direction.
  [[nodiscard]] Vec3d carried(SkinRule rule, std::size_t vertex, const AffineTransform& matrix,
                              const Vec3d& normal) const noexcept;

 private:
  // The joints that each vertex follows, with their weights. Joints are indices in the list of a skin's joints.
  struct Shares {
    std::vector<std::size_t> first;  // (V + 1), the first share of each vertex in `all`
    std::vector<JointShare> all;
    std::size_t joints = 0;  // a skin of this mesh must have at least this number of joints
  };

  MeshSkin(GltfSkin skin, std::shared_ptr<const Shares> shares)
      : skin_(std::make_shared<const GltfSkin>(std::move(skin))),
        shares_(std::move(shares)),
        matrices_(skin_->pose(0, false)) {}

  std::shared_ptr<const GltfSkin> skin_;
  std::shared_ptr<const Shares> shares_;
  std::vector<AffineTransform> matrices_;  // the matrix of each joint in the present pose
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_SHADING_MESH_SKIN_H_
