/// Computes the arrays of a bake: base normals and deltas of one mesh, and their errors. Everything here depends only
/// on the mesh that was read and on the plan; write_mesh.h puts the arrays into the file. Private to workflow.
///
/// Shapes     V = vertices of the shading, part after part; a part has a contiguous range of them.
/// Threads    on all cores; the same bits on any number of them.
#ifndef CHRONORMAL_WORKFLOW_BAKE_EXACT_DELTAS_H_
#define CHRONORMAL_WORKFLOW_BAKE_EXACT_DELTAS_H_

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
  std::span<const float> base_normals;  ///< (V, 3), as the file will store them
};

/// The base normals of a file that change.
struct NewBaseNormals {
  std::vector<float> normals;     ///< (V, 3), with the unchanged ones; empty if all stay
  std::vector<bool> is_replaced;  ///< of each part: some of its normals are new
  std::size_t rescaled = 0;       ///< vertices whose normal was brought to length 1
};

/// Replaces the base normals of some parts by those of the geometry. If a vertex has no normal by geometry, it keeps
/// its stored normal, or gets (0, 0, 1) if that is zero: a file cannot say that there is none. In other parts, only
/// normals longer than 1e10 or shorter than 1e-10 change, to length 1: no viewer can square them in float32, nor add
/// deltas to them. is_recomputed has one entry for each part.
[[nodiscard]] NewBaseNormals new_base_normals(const GltfShading& shading, const NormalTerms& terms,
                                              const std::vector<bool>& is_recomputed);

/// The numbers of vertices to which no right delta can be added.
struct BaseFaults {
  std::size_t without_base = 0;    ///< the faces have no area in the base
  std::size_t without_stored = 0;  ///< the stored base normal is zero, or nearly
};

[[nodiscard]] BaseFaults find_base_faults(const DeltaSource& source);

/// The deltas that one target adds to the normals of a mesh.
struct TargetDeltas {
  /// (vertices, 3) of each part; empty if no normal changes.
  std::vector<std::vector<float>> of_parts;
  double error = 0;  ///< a bound of the remaining angle, over the weights of the file, in radians
};

/// Returns the deltas of one of the mesh's own targets: the sum of its own terms at weight 1, or the best single delta
/// if the plan says so; no deltas if the target moves no vertex. The error does not cover fitted lines, which have
/// their own error.
[[nodiscard]] TargetDeltas own_target_deltas(const DeltaSource& source, std::size_t target);

/// Returns the deltas of the correction target for two targets. For one target with itself, returns the deltas of the
/// term that is zero at the weights 0 and 1 (docs/theory.md, eq. 45).
[[nodiscard]] TargetDeltas extra_target_deltas(const DeltaSource& source, const ExtraWeight& extra);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_EXACT_DELTAS_H_
