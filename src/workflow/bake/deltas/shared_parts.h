/// Finds primitives of a mesh that share vertex arrays. Exporters split a mesh into one primitive for each material.
/// All of these primitives use the same arrays, and each primitive shows some of the vertices. A bake then also writes
/// one array for all of them. Private to workflow.
///
/// For example, part 0 shows the vertices 0, 1, 2 of some arrays, and part 1 shows the vertices 2, 3, 4 of the same
/// arrays. Both parts then get one array of deltas, for the vertices 0 to 4.
///
/// Threads    All functions are pure.
#ifndef CHRONORMAL_WORKFLOW_BAKE_DELTAS_SHARED_PARTS_H_
#define CHRONORMAL_WORKFLOW_BAKE_DELTAS_SHARED_PARTS_H_

#include <cstddef>
#include <vector>

#include "workflow/bake/deltas/deltas.h"
#include "workflow/bake/deltas/vertex_columns.h"
#include "workflow/shading/gltf_shading.h"

namespace chronormal::inline internal {

class SharedParts {
 public:
  /// Finds the parts that share arrays. The shading must have been read with its deltas, and must outlive this object.
  /// Takes O(bytes of all arrays) if there are several parts.
  explicit SharedParts(const GltfShading& shading);

  /// Gives parts with the same vertices one shared array of deltas, unless some vertex has different deltas in two
  /// parts.
  void join(TargetDeltas& deltas) const;
  /// Returns the bytes that the arrays for these deltas take in the file, sparse or dense, whichever is smaller. Counts
  /// a shared array once. join() must have been called for the deltas.
  [[nodiscard]] std::size_t bytes_of(const TargetDeltas& deltas) const;
  /// Returns the bytes that the deltas of some vertices take in the file. join() need not have been called.
  [[nodiscard]] std::size_t bytes_of(const VertexVectors& deltas) const;

 private:
  [[nodiscard]] bool are_alike(const GltfPart& a, const GltfPart& b) const;

  const GltfShading& shading_;
  std::vector<std::vector<std::size_t>> groups_;  // groups of parts with the same vertices; no group is empty
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_DELTAS_SHARED_PARTS_H_
