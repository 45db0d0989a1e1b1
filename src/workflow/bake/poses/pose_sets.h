/// The poses in which a bake is judged, by kinds. Private to workflow.
///
/// Threads    pure; the poses are the same on every system.
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

/// The kinds of poses; in each kind a bake must be no worse than the file. kFile: the animations and the poses that
/// stand still. kAlone: each target alone. kPosed: poses that a program sets.
enum class PoseKind { kFile, kAlone, kPosed };
inline constexpr std::size_t kPoseKinds = 3;

/// Poses of one kind, and the viewers that render them, by index in a list.
struct PoseSet {
  PoseKind kind = PoseKind::kFile;
  std::vector<std::size_t> viewers;
  std::vector<PlayedPose> poses;
  std::vector<std::uint32_t> numbers = {};  ///< of the judged vertices that these poses move, ascending; empty: all
};

/// Lists the poses of a mesh: about `most` poses of its tracks, as each viewer plays them; the poses that stand still;
/// each target alone, unless only animations count; and the poses for which the rig is made. `numbers` has the judged
/// vertices that each target turns. A target that turns none of them is left out of all poses.
[[nodiscard]] std::vector<PoseSet> pose_sets(const MeshWeights& weights, std::span<const Viewer> viewers,
                                             std::span<const std::vector<std::uint32_t>> numbers, std::size_t most,
                                             bool animations_only);

/// Returns the poses of a set with the weights of correction targets, as a viewer plays these from the tracks that will
/// be written.
[[nodiscard]] std::vector<SeenPose> with_extra_targets(const PoseSet& set, const MeshWeights& weights,
                                                       const ExtraDrivers& drivers, const Viewer& viewer);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_POSES_POSE_SETS_H_
