/// Makes the sets of poses in which a bake is judged. A set has poses of one kind. Private to workflow.
///
/// Threads    All functions are pure, and give the same poses on every system.
#ifndef CHRONORMAL_WORKFLOW_BAKE_POSES_POSE_SETS_H_
#define CHRONORMAL_WORKFLOW_BAKE_POSES_POSE_SETS_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "chronormal/workflow/viewers.h"
#include "workflow/bake/poses/extra_curves.h"
#include "workflow/bake/poses/mesh_weights.h"
#include "workflow/bake/poses/played_poses.h"

namespace chronormal::inline internal {

/// The kinds of poses. A baked file must be no worse than the file before in any kind. kFile has poses of the
/// animations and poses that stand still, kAlone has each target alone, and kPosed has poses that a program may set.
enum class PoseKind { kFile, kAlone, kPosed };
inline constexpr std::size_t kPoseKinds = 3;

/// Poses of one kind, and the viewers that render them, as indices in a list of viewers.
struct PoseSet {
  PoseKind kind = PoseKind::kFile;
  std::vector<std::size_t> viewers;
  std::vector<PlayedPose> poses;
  std::vector<std::uint32_t> numbers = {};  ///< the judged vertices that these poses move, ascending; if empty, all
};

/// Returns the sets of poses of a mesh. The sets have about `most` poses of the mesh's tracks, as each viewer plays
/// them, and the poses that stand still. Unless only animations count, the sets also have poses with each target alone,
/// and the poses for which the rig is made. `numbers` has the judged vertices that each target turns. A target that
/// turns no judged vertex is left out of all poses.
[[nodiscard]] std::vector<PoseSet> pose_sets(const MeshWeights& weights, std::span<const Viewer> viewers,
                                             std::span<const std::vector<std::uint32_t>> numbers, std::size_t most,
                                             bool animations_only);

/// Returns the poses of a set with the weights of correction targets appended. For poses of tracks, these are the
/// weights that the viewer plays from the tracks which the bake will write. With a target alone, they are zero if
/// animations drive the mesh and no program does (are_sliders_driven), because a viewer moves nothing but the slider.
[[nodiscard]] std::vector<SeenPose> with_extra_targets(const PoseSet& set, const MeshWeights& weights,
                                                       const ExtraDrivers& drivers, const Viewer& viewer,
                                                       bool are_sliders_driven);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_POSES_POSE_SETS_H_
