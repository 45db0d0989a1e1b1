/// A candidate: the data that a bake may write for a mesh. A candidate has deltas of the mesh's own targets, correction
/// targets, and the drivers of the correction targets' weights. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_BAKE_DELTAS_CANDIDATE_H_
#define CHRONORMAL_WORKFLOW_BAKE_DELTAS_CANDIDATE_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "chronormal/workflow/bake.h"
#include "workflow/bake/deltas/deltas.h"
#include "workflow/bake/deltas/vertex_columns.h"
#include "workflow/bake/poses/extra_curves.h"
#include "workflow/bake/poses/mesh_weights.h"

namespace chronormal::inline internal {

struct Candidate {
  std::string_view name;              ///< the name of the candidate, as in BakedCandidate::name
  std::vector<VertexVectors> own;     ///< deltas of each target of the mesh, for all vertices that show a normal
  std::vector<VertexVectors> extras;  ///< deltas of each correction target
  ExtraDrivers drivers;               ///< the data that drive the correction targets
  std::size_t left_out = 0;  ///< the number of correction targets that a limit excluded; they would have helped least
  double track_error = 0;    ///< radians: the largest angle by which straight pieces between keys turn normals
  double fit_error = 0;      ///< radians: a bound of the error of normals with the deltas of one target
  bool animations_only = false;  ///< if true, the deltas are right only in animations, and not for a target alone
};

/// Returns the deltas of a candidate, vertex by vertex. The columns are the mesh's own targets, followed by the
/// correction targets.
[[nodiscard]] VertexColumns columns_of(const Candidate& candidate, std::span<const std::uint32_t> vertices);

/// Returns for each target the normal deltas that the file stores. Leaves out zeros, and vertices that show no normal.
[[nodiscard]] std::vector<VertexVectors> stored_deltas(const GltfShading& shading);

/// Converts the arrays of deltas of one target to a column, which has only the deltas that are not zero.
[[nodiscard]] VertexVectors as_column(const GltfShading& shading, const TargetDeltas& deltas);

/// Returns the vertices that a bake judges: those whose normal some target may turn, because the target moves a face
/// around the vertex or stores a delta of its normal.
[[nodiscard]] std::vector<std::uint32_t> judged_vertices(const DeltaSource& source,
                                                         const std::vector<VertexVectors>& stored);

/// Returns for each target the vertices whose normals the target may turn, as indices into `vertices`.
[[nodiscard]] std::vector<std::vector<std::uint32_t>> numbers_of_targets(const DeltaSource& source,
                                                                         const std::vector<VertexVectors>& stored,
                                                                         std::span<const std::uint32_t> vertices);

/// Returns the deltas of a target of the mesh as the file will store them. Returns nothing if the deltas in the file
/// stay as they are.
[[nodiscard]] std::optional<TargetDeltas> own_deltas(const GltfShading& shading, const Candidate& candidate,
                                                     std::size_t target);
/// Returns the deltas of a correction target.
[[nodiscard]] TargetDeltas extra_deltas(const GltfShading& shading, const Candidate& candidate, std::size_t extra);
/// Returns true if a candidate has other deltas than the file, or has correction targets.
[[nodiscard]] bool changes(const GltfShading& shading, const Candidate& candidate);
/// Estimates the bytes that a candidate takes in the file: its arrays of deltas, the drivers of its correction targets,
/// and the bytes that are added to the animation tracks that drive these targets.
[[nodiscard]] std::size_t bytes_of(const GltfShading& shading, const MeshWeights& weights, const Candidate& candidate);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_DELTAS_CANDIDATE_H_
