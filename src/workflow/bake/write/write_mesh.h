/// Writes one mesh as edits of the glTF file. Writes the arrays of normals and deltas, and all lists with an item for
/// each target, such as weights and names. Private to workflow.
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

/// The accessors that hold only zeros, for targets that lack an attribute. Each number of vertices has one accessor.
class ZeroVectors {
 public:
  ZeroVectors(GltfEdit& edit, bool dense) : edit_(edit), dense_(dense) {}
  [[nodiscard]] std::size_t of(std::size_t vertices);
  /// Returns true if accessors of zeros store their zeros as bytes. Otherwise an accessor of zeros has no buffer view.
  [[nodiscard]] bool are_dense() const noexcept { return dense_; }

 private:
  GltfEdit& edit_;
  bool dense_;
  std::map<std::size_t, std::size_t> accessors_;
};

/// Writes one mesh, target by target, so that only the arrays of one target are in memory. All targets of a primitive
/// must have the same attributes (section 3.7.2.2 of the specification). If one target has an attribute, the other
/// targets get zeros.
class MeshWriter {
 public:
  /// Prepares a mesh for writing. `smooth` must be the value with which the shading was read. All arguments must
  /// outlive this object.
  MeshWriter(const GltfDocument& document, const GltfShading& shading, bool smooth, ZeroVectors& zeros, GltfEdit& edit);

  /// Returns true if the vertices of a primitive show normals of elements.
  [[nodiscard]] bool is_shaded(std::size_t primitive) const { return part_[primitive].has_value(); }

  /// Replaces the base normals of some parts. `normals` has the normals of all parts, (V, 3). Errors: kInvalidInput if
  /// Draco compresses a part that changes.
  [[nodiscard]] Status write_base(const std::vector<bool>& is_replaced, std::span<const float> normals);
  /// Makes every target of the mesh change tangents, in all primitives that have tangents.
  void add_tangents();
  /// Writes the deltas of normals and tangents of one of the mesh's own targets. If there are no deltas, only adds the
  /// attributes that other targets have and this target lacks.
  void write_target(std::size_t target, const std::optional<TargetDeltas>& of_normals,
                    const std::optional<TargetDeltas>& of_tangents = {});
  /// Appends a correction target, which moves no vertex.
  void append_target(const TargetDeltas& of_normals);
  /// Sets the weights and names of the correction targets that append_target() added. If no formula gives the weights,
  /// `rest` has the weights for each pose that stands still (outside of animations), in the order of MeshWeights.
  void append_weights(std::span<const GltfExtraTarget> extras, const PoseList& rest);
  /// Writes the mark of the bake (docs/formats.md) into the mesh, where the next bake and an audit look for it. If
  /// there are correction targets, also writes the mark into the nodes that have the mesh, because some viewers pass
  /// only the extras of nodes to programs. Returns the nodes whose extras are not an object. These nodes do not change.
  [[nodiscard]] std::vector<std::size_t> set_mark(const GltfBakeMark& mark);

 private:
  // The attributes that all targets of a primitive will have when the mesh is written.
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
  std::string pointer_;                           // the JSON pointer of the mesh
  std::vector<std::optional<std::size_t>> part_;  // for each primitive that is shaded, the index of its part
  std::vector<Attributes> attributes_;            // the attributes of each primitive
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_WRITE_WRITE_MESH_H_
