/// The author's normals that a file stores, for the base and for each target at weight 1. Private to workflow.
///
/// A bake distributes the normals of a target over the deltas of the target and the deltas of correction targets that
/// follow its weight. If the mark of the bake states that the sums of these deltas are still the author's normals, the
/// class StoredKey adds up the deltas again.
#ifndef CHRONORMAL_WORKFLOW_TRUTH_STORED_KEYS_H_
#define CHRONORMAL_WORKFLOW_TRUTH_STORED_KEYS_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "chronormal/core/vec3.h"
#include "workflow/shading/gltf_shading.h"

namespace chronormal::inline internal {

/// The positions and stored normals of all vertices, in the base or in one target at weight 1.
class StoredKey {
 public:
  /// Reads the base.
  explicit StoredKey(const GltfShading& shading);
  /// Reads the positions and stored normals of a target at weight 1.
  StoredKey(const GltfShading& shading, std::size_t target);

  [[nodiscard]] Vec3d position(std::uint32_t vertex) const noexcept {
    const float* const p = (moved_.empty() ? shading_->set.base : moved_).data() + 3 * std::size_t{vertex};
    return {p[0], p[1], p[2]};
  }
  /// Returns the normal of a vertex as a viewer renders it. The normal need not have unit length.
  [[nodiscard]] Vec3d normal(std::uint32_t vertex) const noexcept;
  /// Tells whether the target changes the stored normal of the vertex.
  [[nodiscard]] bool turns(std::uint32_t vertex) const noexcept;

 private:
  [[nodiscard]] Vec3d delta(std::uint32_t vertex) const noexcept;

  // The deltas of one target, and the weight by which they are multiplied.
  struct Part {
    const std::vector<float>* deltas = nullptr;
    double weight = 1;
  };
  const GltfShading* shading_;
  std::vector<float> moved_;  // all positions; empty if they are equal to those of the base
  std::vector<Part> parts_;   // the deltas of the target, and of the correction targets that follow it
};

/// Lists the targets whose stored normals are the author's, in ascending order. The list is empty if an earlier bake
/// has replaced the author's normals.
[[nodiscard]] std::vector<std::size_t> targets_with_normals(const GltfShading& shading);

/// Returns for each element the index of one of its vertices, or GltfShading::kNoElement if the element has no vertex.
/// All vertices of an element store the same normal.
[[nodiscard]] std::vector<std::uint32_t> vertices_of_elements(const GltfShading& shading);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_TRUTH_STORED_KEYS_H_
