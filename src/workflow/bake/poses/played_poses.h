/// The poses of a file: poses that viewers play from its tracks, each target alone, and poses that a program may set.
/// Private to workflow.
///
/// Threads    pure; the poses are the same on every system.
#ifndef CHRONORMAL_WORKFLOW_BAKE_POSES_PLAYED_POSES_H_
#define CHRONORMAL_WORKFLOW_BAKE_POSES_PLAYED_POSES_H_

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "chronormal/workflow/viewers.h"
#include "workflow/bake/poses/mesh_weights.h"
#include "workflow/bake/poses/seen_pose.h"
#include "workflow/shading/target_weights.h"
#include "workflow/viewers/played_track.h"

namespace chronormal::inline internal {

/// A pose of the mesh's own targets, and the place from which the weights of correction targets come: a time of a
/// track, a pose that the file stores, or (if there is neither) the weights of the mesh's own targets.
struct PlayedPose {
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  SeenPose seen;  ///< with the weights of the mesh's own targets
  std::size_t track = kNone;
  double time = 0;  ///< of the track
  std::size_t standing = kNone;
};

/// Returns the keys after which a track shows something new, because weights move, come to rest or jump there;
/// ascending. If there are more than `most`, it prefers keys after which a weight, or the product of two weights, is
/// larger than anywhere else, so that a wink in a long animation is included; the other keys are chosen at even steps.
[[nodiscard]] std::vector<std::size_t> telling_keys(const WeightTrack& track, std::size_t most);

/// Returns the indices of at most `most` tracks, ascending. If there are more, it prefers tracks in which a weight, or
/// the product of two weights, is larger than anywhere else; the other tracks are chosen at even steps. All tracks must
/// have the same targets.
[[nodiscard]] std::vector<std::size_t> telling_tracks(std::span<const WeightTrack> tracks, std::size_t most);

/// Returns the poses that a viewer plays from the tracks of a mesh, in order, without poses that look the same as the
/// previous one. There are poses at each telling key and at instants up to the next one. If these are more than `most`,
/// it takes fewer instants after each key, and then fewer keys. The share of a track depends on the number of its
/// telling keys; each track has at least one pose.
///
/// If nodes have skins, a track is judged with each of these skins: at its own keys, at keys of the joints, and at
/// instants between. If these are more than `most`, some of them are chosen as above. The skins must outlive the poses.
[[nodiscard]] std::vector<PlayedPose> played_tracks(const MeshWeights& weights, const Viewer& viewer, std::size_t most);

/// Returns poses in which one of these targets has a weight and all others have none, at `steps` weights up to 1.
[[nodiscard]] PoseList alone_poses(std::span<const std::size_t> targets, std::size_t target_count, std::size_t steps);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_POSES_PLAYED_POSES_H_
