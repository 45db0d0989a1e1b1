/// How far a mesh is off along the animations of its file: what the choice among its forms is made by. Private to
/// workflow.
#ifndef CHRONORMAL_WORKFLOW_BAKE_JUDGE_PLAYED_ERRORS_H_
#define CHRONORMAL_WORKFLOW_BAKE_JUDGE_PLAYED_ERRORS_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "chronormal/workflow/bake.h"
#include "workflow/bake/judge/host_judge.h"
#include "workflow/bake/judge/right_normals.h"
#include "workflow/bake/judge/seen_pose.h"
#include "workflow/bake/low_rank/extra_curves.h"
#include "workflow/bake/mesh_weights.h"

namespace chronormal::inline internal {

/// Poses between the keys of all tracks, as they will be written with these extra targets, at instants that no form is
/// fitted or chosen by, and the poses that stand still; where nothing moves a weight, each target alone, at its end
/// too, where alone a normal may add up to zero, and poses that the rig is made for. No more than `most` of each kind:
/// of the tracks, those that tell most (telling_keys()), of the others evenly. They are
/// seen through the skins of weights (seen_tracks()), which must outlive them.
[[nodiscard]] std::vector<SeenPose> played_poses(const MeshWeights& weights, const ExtraDrivers& drivers,
                                                 std::size_t targets, std::size_t most);

/// The errors of vertices in a host that adds up what is stored, over pairs of a vertex and a pose in which its normal
/// n(w) is longer than a thousandth of n(0). Through a skin the shown and the right normal are both carried as the host
/// does it, and pairs in which this leaves nothing of the right one are left out. form has the deltas as the host keeps
/// them; the base normals become what it keeps. On all cores; the same bits on any number of them.
[[nodiscard]] ShownErrors played_errors(const RightNormals& rights, std::span<const std::uint32_t> vertices,
                                        std::span<const std::uint32_t> element_of_vertex, const VertexColumns& form,
                                        std::span<const SeenPose> poses, const Host& host = {});

/// What no choice of one of these forms for each vertex can be below: the largest of the least errors at worst, over
/// the same pairs.
[[nodiscard]] double least_worst(const RightNormals& rights, std::span<const std::uint32_t> vertices,
                                 std::span<const std::uint32_t> element_of_vertex, std::span<const VertexColumns> forms,
                                 std::span<const SeenPose> poses);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_JUDGE_PLAYED_ERRORS_H_
