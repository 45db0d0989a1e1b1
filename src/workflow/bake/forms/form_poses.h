/// What a choice among forms of a mesh is made by: the vertices that are judged, and the poses at which. Private to
/// workflow.
///
/// Threads    on all cores; the same bits on any number of them.
#ifndef CHRONORMAL_WORKFLOW_BAKE_FORMS_FORM_POSES_H_
#define CHRONORMAL_WORKFLOW_BAKE_FORMS_FORM_POSES_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "workflow/bake/exact/deltas.h"
#include "workflow/bake/forms/harmless_form.h"
#include "workflow/bake/judge/host_judge.h"
#include "workflow/bake/judge/played_poses.h"
#include "workflow/bake/low_rank/extra_curves.h"
#include "workflow/bake/mesh_weights.h"

namespace chronormal::inline internal {

/// What the file stores, other than zero.
[[nodiscard]] std::vector<VertexVectors> stored_deltas(const GltfShading& shading);

/// The same of arrays that were computed for one target.
[[nodiscard]] VertexVectors as_column(const GltfShading& shading, const TargetDeltas& deltas);

/// The deltas that --encode endpoint writes for all targets, and the largest error that they are stated with.
[[nodiscard]] std::vector<VertexVectors> endpoint_deltas(const DeltaSource& source, double& error);

/// The vertices whose normal a target may turn: by its faces, or by what is stored.
[[nodiscard]] std::vector<std::uint32_t> judged_vertices(const DeltaSource& source,
                                                         const std::vector<VertexVectors>& stored);

/// Which of these each target may turn, as they are numbered there.
[[nodiscard]] std::vector<std::vector<std::uint32_t>> numbers_of_targets(const DeltaSource& source,
                                                                         const std::vector<VertexVectors>& stored,
                                                                         std::span<const std::uint32_t> vertices);

/// Of each vertex, whether its base normal is not the stored one.
[[nodiscard]] std::vector<bool> new_bases(const DeltaSource& source);

/// The columns of own targets and then those of extra ones.
[[nodiscard]] std::vector<const VertexVectors*> columns_of(const std::vector<VertexVectors>& own,
                                                           const std::vector<VertexVectors>& extras = {});

/// How many extra targets all hosts have room for, and the options.
[[nodiscard]] std::size_t most_extras(const BakeOptions& options, std::size_t targets);

/// The lengths of vectors that all hosts keep.
[[nodiscard]] FormLengths lengths_for(std::span<const Host> hosts);

/// How the poses of one look at a form are taken.
struct Sampling {
  std::size_t between_keys = 4, most = 0;
  double phase = 0;
  unsigned seed = 1;
  bool animations_only = false;  ///< no targets alone, no mixed poses
};

/// The poses of the file as hosts play it, its targets alone, random poses (of a rig those that it is made for) and
/// cross-fades.
[[nodiscard]] std::vector<PoseSet> pose_sets(const GltfShading& shading, const MeshWeights& weights,
                                             const ExtraDrivers& extras, std::span<const Host> hosts,
                                             std::span<const std::vector<std::uint32_t>> numbers,
                                             const Sampling& sampling);

/// How many poses may be looked at, with these forms.
[[nodiscard]] std::size_t enough_poses(const GltfShading& shading, std::span<const VertexColumns> forms);

/// Of the tolerance: what straight pieces may leave of it.
inline constexpr double kPartOfTracks = 0.25;

/// Decides how the tracks of a file carry the weights of extra targets, so that they turn no normal by more than the
/// tolerance (radians):
///
///     LINEAR        straight pieces of each gap, as far as a limit of their number allows; `left` becomes no less than
///                   what they turn. Where all hosts play cubic splines and a spline takes fewer numbers, or pieces
///                   leave too much, the track becomes one, which is exact
///     CUBICSPLINE   more keys where all hosts play them as the specification says, for formulas
///
/// drivers must have its formulas or curves, and columns be the form that they drive.
void cut_tracks(const RightNormals& rights, const MeshWeights& weights, std::span<const Host> hosts,
                std::span<const std::uint32_t> vertices, const VertexColumns& columns, double tolerance,
                ExtraDrivers& drivers, double& left);

/// Different normals that keep what is stored, though targets move them.
[[nodiscard]] std::size_t kept_elements(const GltfShading& shading, std::span<const std::uint32_t> vertices,
                                        std::span<const std::uint8_t> choice);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_FORMS_FORM_POSES_H_
