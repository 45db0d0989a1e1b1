/// What a bake might write for a mesh: deltas of the mesh's own targets, extra targets, and what drives these. Private to
/// workflow.
#ifndef CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_CANDIDATE_H_
#define CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_CANDIDATE_H_

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
  std::string_view name;              ///< as BakedCandidate::name has it
  std::vector<VertexVectors> own;     ///< of each target of the mesh: the deltas of all vertices that show a normal
  std::vector<VertexVectors> extras;  ///< of each extra target
  ExtraDrivers drivers;               ///< of the extra targets
  std::size_t left_out = 0;           ///< extra targets beyond a limit, which would have gained least
  double track_error = 0;             ///< radians: of straight pieces between keys, at worst
  double fit_error = 0;               ///< radians: a bound for the deltas of targets alone
  bool animations_only = false;       ///< its deltas mean nothing for a target alone
};

/// The same deltas by vertex: those of targets of the mesh, and then those of extra ones.
[[nodiscard]] VertexColumns columns_of(const Candidate& candidate, std::span<const std::uint32_t> vertices);

/// What the file stores, other than zero, of vertices that show a normal.
[[nodiscard]] std::vector<VertexVectors> stored_deltas(const GltfShading& shading);

/// Arrays that were computed for one target, as a column.
[[nodiscard]] VertexVectors as_column(const GltfShading& shading, const TargetDeltas& deltas);

/// The vertices whose normal a target may turn: by its faces, or by what is stored.
[[nodiscard]] std::vector<std::uint32_t> judged_vertices(const DeltaSource& source,
                                                         const std::vector<VertexVectors>& stored);

/// Which of these each target may turn, as they are numbered there.
[[nodiscard]] std::vector<std::vector<std::uint32_t>> numbers_of_targets(const DeltaSource& source,
                                                                         const std::vector<VertexVectors>& stored,
                                                                         std::span<const std::uint32_t> vertices);

/// The deltas of a target of the mesh as the file will have them; nothing where all of them stay as they are.
[[nodiscard]] std::optional<TargetDeltas> own_deltas(const GltfShading& shading, const Candidate& candidate,
                                                     std::size_t target);
/// Those of an extra target.
[[nodiscard]] TargetDeltas extra_deltas(const GltfShading& shading, const Candidate& candidate, std::size_t extra);
/// Whether anything becomes other than it is stored.
[[nodiscard]] bool changes(const GltfShading& shading, const Candidate& candidate);
/// About how many bytes its arrays of deltas take, what says how extra targets are driven, and what their tracks grow by.
[[nodiscard]] std::size_t bytes_of(const GltfShading& shading, const MeshWeights& weights, const Candidate& candidate);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_CANDIDATE_H_
