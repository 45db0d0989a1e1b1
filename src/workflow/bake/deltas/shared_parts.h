/// Primitives of a mesh that share vertex arrays. Exporters split a mesh into one primitive for each material; all of
/// them use the same arrays, and each shows some of the vertices. A bake then also writes one array for all of them.
/// Private to workflow.
///
///     part 0 shows the vertices 0, 1, 2 of some arrays, and part 1 shows 2, 3, 4 of the same arrays: the deltas of
///     both are one array, of the vertices 0 to 4
///
/// Threads    pure
#ifndef CHRONORMAL_WORKFLOW_BAKE_EXACT_SHARED_PARTS_H_
#define CHRONORMAL_WORKFLOW_BAKE_EXACT_SHARED_PARTS_H_

#include <cstddef>
#include <vector>

#include "workflow/bake/deltas/deltas.h"
#include "workflow/bake/deltas/vertex_columns.h"
#include "workflow/shading/gltf_shading.h"

namespace chronormal::inline internal {

class SharedParts {
 public:
  /// Finds the parts that share arrays. The shading must have its deltas, and outlive this object. O(bytes of all
  /// arrays) if there are several parts.
  explicit SharedParts(const GltfShading& shading);

  /// Gives parts with the same vertices the same array, unless a vertex has two different deltas.
  void join(TargetDeltas& deltas) const;
  /// Returns the bytes of the arrays for these deltas, sparse or not, each array once. The deltas must be joined.
  [[nodiscard]] std::size_t bytes_of(const TargetDeltas& deltas) const;
  /// Returns the bytes for deltas of some vertices, which need not be joined.
  [[nodiscard]] std::size_t bytes_of(const VertexVectors& deltas) const;

 private:
  [[nodiscard]] bool are_alike(const GltfPart& a, const GltfPart& b) const;

  const GltfShading& shading_;
  std::vector<std::vector<std::size_t>> groups_;  // groups of parts with the same vertices; each has at least one part
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_EXACT_SHARED_PARTS_H_
