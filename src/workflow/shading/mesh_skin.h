/// How the skin of a node moves the vertices of a mesh. Private to workflow.
///
/// Viewers blend the joint matrices of a vertex by its shares, M = sum of w_j M_j, and take its position through M and
/// its normal through the linear part L of M (docs/decisions/0022, which has those that do otherwise). L is no normal
/// matrix: where it is more than a turn and a scale, what it makes of a right normal is not the normal of the skinned
/// surface. No target can mend that. So normals are held against each other as L carries them, and what L itself does
/// wrong is told apart.
///
/// Copies     share what was read of the file, and each has a pose of its own.
/// Threads    const functions may run at once.
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
  /// Reads what the skin of a node does to the mesh of the shading, and poses it as the file has it. What a skin knows
  /// of the vertices of the same mesh is not read again. Errors: of GltfSkin
  [[nodiscard]] static Result<MeshSkin> read(const GltfDocument& document, const GltfShading& shading, std::size_t node,
                                             std::optional<std::size_t> animation,
                                             const MeshSkin* of_same_mesh = nullptr);

  /// Poses the joints as they are at a time; where they jump, just after it or just before it. Returns whether that may
  /// have moved anything.
  bool pose(double time, bool just_before);

  /// Whether the joints move in the animation.
  [[nodiscard]] bool moves() const noexcept { return skin_->moves(); }

  /// The times of all keys by which joints move, ascending.
  [[nodiscard]] std::vector<double> key_times() const { return skin_->key_times(); }

  /// Whether the blended matrices of these vertices turn and scale evenly in this pose, each for itself, but for what
  /// is too fine to matter: then they keep the angle between any two normals of a vertex.
  [[nodiscard]] bool is_even(std::span<const std::uint32_t> vertices) const;

  /// The blended matrix of a vertex in this pose.
  [[nodiscard]] AffineTransform of_vertex(std::size_t vertex) const noexcept;

  /// What is shown of a normal of a vertex, of any length, in this pose: a unit vector, or zero or not finite where it
  /// has no direction. matrix is that of the vertex, as of_vertex() has it.
  [[nodiscard]] Vec3d carried(SkinRule rule, std::size_t vertex, const AffineTransform& matrix,
                              const Vec3d& normal) const noexcept;

 private:
  // Which joints each vertex follows, whatever nodes these are.
  struct Shares {
    std::vector<std::size_t> first;  // (V + 1)
    std::vector<JointShare> all;
    std::size_t joints = 0;  // that a skin must have at least
  };

  MeshSkin(GltfSkin skin, std::shared_ptr<const Shares> shares)
      : skin_(std::make_shared<const GltfSkin>(std::move(skin))),
        shares_(std::move(shares)),
        matrices_(skin_->pose(0, false)) {}

  std::shared_ptr<const GltfSkin> skin_;
  std::shared_ptr<const Shares> shares_;
  std::vector<AffineTransform> matrices_;  // of joints
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_SHADING_MESH_SKIN_H_
