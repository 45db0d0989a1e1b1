/// The normals of its author that a file stores: those of the base, and those of each target at weight 1. Private to
/// workflow.
///
/// A bake spreads the normals of a target over its own deltas and those of extra targets that follow its weight. Where
/// its mark says that they are still the author's, they are added up again.
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

/// The base or one target at weight 1, of all vertices.
class StoredKey {
 public:
  /// The base.
  explicit StoredKey(const GltfShading& shading);
  /// A target at weight 1.
  StoredKey(const GltfShading& shading, std::size_t target);

  [[nodiscard]] Vec3d position(std::uint32_t vertex) const noexcept {
    const float* const p = (moved_.empty() ? shading_->set.base : moved_).data() + 3 * std::size_t{vertex};
    return {p[0], p[1], p[2]};
  }
  /// The normal that is shown there, of any length.
  [[nodiscard]] Vec3d normal(std::uint32_t vertex) const noexcept;
  /// Returns whether the target turns what is stored for the vertex.
  [[nodiscard]] bool turns(std::uint32_t vertex) const noexcept;

 private:
  [[nodiscard]] Vec3d delta(std::uint32_t vertex) const noexcept;

  // The deltas of a target, times its weight.
  struct Part {
    const std::vector<float>* deltas = nullptr;
    double weight = 1;
  };
  const GltfShading* shading_;
  std::vector<float> moved_;  // all positions; or empty, where they are those of the base
  std::vector<Part> parts_;   // of the target and the extra ones that follow it
};

/// The targets whose normals are their author's, ascending: none of an earlier bake that wrote its own over them.
[[nodiscard]] std::vector<std::size_t> targets_with_normals(const GltfShading& shading);

/// A vertex of each element, GltfShading::kNoElement where no vertex shows it. All of an element store the same.
[[nodiscard]] std::vector<std::uint32_t> vertices_of_elements(const GltfShading& shading);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_TRUTH_STORED_KEYS_H_
