/// Computes the base normals and the deltas that a bake writes for one mesh, and their errors. The results depend only
/// on the mesh that was read and on the plan. write_mesh.h puts the arrays into the file. Private to workflow.
///
/// Shapes     V is the number of vertices in all parts of the shading. An array has the vertices of the first part,
///            then those of the second part, and so on.
/// Threads    Uses all cores. The results have the same bits on any number of cores.
#ifndef CHRONORMAL_WORKFLOW_BAKE_DELTAS_DELTAS_H_
#define CHRONORMAL_WORKFLOW_BAKE_DELTAS_DELTAS_H_

#include <cstddef>
#include <span>
#include <vector>

#include "workflow/bake/deltas/plan.h"
#include "workflow/bake/deltas/terms.h"
#include "workflow/shading/gltf_shading.h"

namespace chronormal::inline internal {

/// The input from which the deltas of a mesh are computed.
struct DeltaSource {
  const GltfShading& shading;
  const NormalTerms& terms;
  const MeshPlan& plan;
  std::span<const float> base_normals;  ///< (V, 3), the base normals that the file will store
};

/// The base normals of a mesh after some of them were replaced.
struct NewBaseNormals {
  std::vector<float> normals;     ///< (V, 3), also the unchanged normals; empty if no normal changes
  std::vector<bool> is_replaced;  ///< for each part, true if some of its normals are new
  std::size_t rescaled = 0;       ///< the number of vertices whose normal was scaled to length 1
};

/// Replaces the base normals of some parts by the normals of the geometry. A vertex for which the geometry has no
/// normal keeps its stored normal. If the stored normal is zero, it becomes (0, 0, 1), because a file cannot say that a
/// vertex has no normal. In other parts, normals longer than 1e10 or shorter than 1e-10, except zeros, get length 1,
/// because no viewer can square such normals in float32, nor add deltas to them. All other normals stay. is_recomputed
/// has one entry for each part.
[[nodiscard]] NewBaseNormals new_base_normals(const GltfShading& shading, const NormalTerms& terms,
                                              const std::vector<bool>& is_recomputed);

/// The numbers of vertices that cannot be rendered right with any delta.
struct BaseFaults {
  std::size_t without_base = 0;    ///< vertices whose normal by geometry is zero or nearly zero in the base
  std::size_t without_stored = 0;  ///< vertices whose stored base normal is zero or nearly zero
};

[[nodiscard]] BaseFaults find_base_faults(const DeltaSource& source);

/// The deltas that one target adds to the normals of a mesh, as arrays for the file.
struct TargetDeltas {
  /// The deltas of each part of the mesh, as arrays (vertices, 3). An array is empty if no normal of its part changes.
  std::vector<std::vector<float>> of_parts;
  double error = 0;  ///< radians: a bound of the error of normals that is left at the weights of the file
};

/// Returns the deltas of one of the mesh's own targets. A delta is the sum of the linear and the square term of the
/// target, or the best single delta if the plan requires this (MeshPlan::is_line). If the target moves no vertex, there
/// are no deltas. The error in the result does not include the error of fitted lines (FittedLines::largest_error()).
[[nodiscard]] TargetDeltas own_target_deltas(const DeltaSource& source, std::size_t target);

/// Returns the deltas of the correction target for the pair of targets in `extra`. If both are the same target, the
/// deltas belong to the term that is zero at the weights 0 and 1 of this target (docs/theory.md, eq. 45).
[[nodiscard]] TargetDeltas extra_target_deltas(const DeltaSource& source, const ExtraWeight& extra);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_DELTAS_DELTAS_H_
