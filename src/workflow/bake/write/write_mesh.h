/// Writes one mesh as edits: arrays of normals and deltas go into the file, and everything that counts targets grows
/// with them. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_BAKE_WRITE_WRITE_MESH_H_
#define CHRONORMAL_WORKFLOW_BAKE_WRITE_WRITE_MESH_H_

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "chronormal/io/gltf_document.h"
#include "workflow/bake/deltas/deltas.h"
#include "workflow/bake/deltas/shared_parts.h"
#include "workflow/shading/target_weights.h"

namespace chronormal::inline internal {

/// Accessors of zeros, one for each number of vertices.
class ZeroVectors {
 public:
  ZeroVectors(GltfEdit& edit, bool dense) : edit_(edit), dense_(dense) {}
  [[nodiscard]] std::size_t of(std::size_t vertices);
  /// Tells whether zeros are written as bytes too.
  [[nodiscard]] bool are_dense() const noexcept { return dense_; }

 private:
  GltfEdit& edit_;
  bool dense_;
  std::map<std::size_t, std::size_t> accessors_;
};

/// Writes targets one by one, so that only the arrays of one target are in memory. All targets of a primitive must have
/// the same attributes (section 3.7.2.2 of the specification): if one has an attribute, the others get zeros.
class MeshWriter {
 public:
  /// shading must have been read with this `smooth`. All arguments must outlive this.
  MeshWriter(const GltfDocument& document, const GltfShading& shading, bool smooth, ZeroVectors& zeros, GltfEdit& edit);

  /// Tells whether the vertices of a primitive show normals of elements.
  [[nodiscard]] bool is_shaded(std::size_t primitive) const { return part_[primitive].has_value(); }

  /// Replaces the base normals of some parts; normals has all parts, (V, 3). Errors: kInvalidInput if Draco compresses
  /// them.
  [[nodiscard]] Status write_base(const std::vector<bool>& is_replaced, std::span<const float> normals);
  /// Gives all targets tangents, in primitives that have some.
  void add_tangents();
  /// Writes the deltas of normals and of tangents for a target of the mesh. Without deltas, the target only gets the
  /// attributes that it lacks.
  void write_target(std::size_t target, const std::optional<TargetDeltas>& of_normals,
                    const std::optional<TargetDeltas>& of_tangents = {});
  /// Adds a target that moves no vertex.
  void append_target(const TargetDeltas& of_normals);
  /// Gives weights and names to the appended targets. If no formula gives their weights, `rest` has them for each pose
  /// that stands still, in the order of MeshWeights.
  void append_weights(std::span<const GltfExtraTarget> extras, const PoseList& rest);
  /// Writes down what was done (docs/formats.md): in the mesh, where the next bake and an audit look for it, and where
  /// there are extra targets, in the nodes that carry the mesh, for viewers that hand on the extras of nodes alone.
  /// Returns the nodes whose extras are no object, which stay as they are.
  [[nodiscard]] std::vector<std::size_t> set_mark(const GltfBakeMark& mark);

 private:
  // The attributes that the targets of a primitive have in the end.
  struct Attributes {
    bool positions = false, normals = false, tangents = false;
  };

  [[nodiscard]] std::string pointer_of(std::size_t primitive) const;
  [[nodiscard]] std::optional<TargetDeltas> joined(const std::optional<TargetDeltas>& deltas) const;
  [[nodiscard]] std::size_t deltas_of(std::size_t primitive, const TargetDeltas& deltas);
  [[nodiscard]] std::size_t zeros_of(std::size_t primitive);

  const GltfDocument& document_;
  const GltfShading& shading_;
  const GltfMesh& mesh_;
  ZeroVectors& zeros_;
  GltfEdit& edit_;
  SharedParts parts_;
  std::string pointer_;                           // of the mesh
  std::vector<std::optional<std::size_t>> part_;  // of each primitive that is shaded
  std::vector<Attributes> attributes_;            // of each primitive
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_WRITE_WRITE_MESH_H_
