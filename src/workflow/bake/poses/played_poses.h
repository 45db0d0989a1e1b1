/// The poses of a file: those that viewers play from its tracks, its targets alone, and those that a program may set.
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

/// A pose of the mesh's own targets, and the source of the weights of correction targets: a track at a time, a pose
/// that the file stores, or else the weights of the mesh's own targets.
struct PlayedPose {
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  SeenPose seen;  ///< with the weights of the mesh's own targets
  std::size_t track = kNone;
  double time = 0;  ///< of the track
  std::size_t standing = kNone;
};

/// Returns the keys after which a track shows something new, because weights move, come to rest or jump there;
/// ascending. If there are more than `most`, it prefers keys after which a weight, or the product of two weights, is
/// larger than anywhere else, so that a wink in a long animation is included; the others are taken evenly.
[[nodiscard]] std::vector<std::size_t> telling_keys(const WeightTrack& track, std::size_t most);

/// Returns the indices of at most `most` tracks, ascending. If there are more, it prefers tracks in which a weight, or
/// the product of two weights, is larger than anywhere else; the others are taken evenly. All tracks must have the same
/// targets.
[[nodiscard]] std::vector<std::size_t> telling_tracks(std::span<const WeightTrack> tracks, std::size_t most);

/// Returns the poses that a viewer plays from the tracks of a mesh, one after the other, except poses that look the
/// same as the one before: for each telling key, the key itself and instants up to the next one. If these are more than
/// `most`, it takes fewer instants of each key, and then fewer keys. Each track gets a share by the number of its
/// telling keys, and at least one pose. With each skin of its nodes, which must outlive the poses, a track is judged at
/// its keys, at keys of the joints and at instants between; if these are more than `most`, at some of them, chosen as
/// above.
[[nodiscard]] std::vector<PlayedPose> played_tracks(const MeshWeights& weights, const Viewer& viewer, std::size_t most);

/// Returns each of these targets alone, at `steps` weights up to 1.
[[nodiscard]] PoseList alone_poses(std::span<const std::size_t> targets, std::size_t target_count, std::size_t steps);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_POSES_PLAYED_POSES_H_
