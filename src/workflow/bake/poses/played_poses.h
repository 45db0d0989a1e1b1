/// Finds the poses in which a mesh is judged: poses that viewers play from the tracks of a file, each target alone, and
/// poses that a program may set. Private to workflow.
///
/// Threads    All functions are pure, and give the same poses on every system.
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

/// A pose of the mesh's own targets, and the place from which correction targets get their weights. The place is a time
/// of a track, or a pose that the file stores. If there is neither, the weights follow from the weights of the mesh's
/// own targets.
struct PlayedPose {
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  SeenPose seen;  ///< the weights of the mesh's own targets, and the skin
  std::size_t track = kNone;
  double time = 0;  ///< seconds: the time of the pose on the track
  std::size_t standing = kNone;
};

/// Returns keys of a track, in ascending order. After each of these keys, the track shows something new, because
/// weights change, come to rest or jump at the key. If there are more than `most` such keys, prefers keys after which a
/// weight, or the product of two weights, is larger than after all other keys, so that a wink in a long animation is
/// included. The rest of the result is evenly spaced among the other keys.
[[nodiscard]] std::vector<std::size_t> telling_keys(const WeightTrack& track, std::size_t most);

/// Returns the indices of at most `most` tracks, in ascending order. If there are more tracks, prefers tracks in which
/// a weight, or the product of two weights, is larger than in all other tracks. The rest of the result is evenly spaced
/// among the other tracks. All tracks must have the same targets.
[[nodiscard]] std::vector<std::size_t> telling_tracks(std::span<const WeightTrack> tracks, std::size_t most);

/// Returns the poses that a viewer plays from the tracks of a mesh, in order. Leaves out a pose that looks the same as
/// the pose before. There are poses at each telling key, and at several times up to the next telling key. If there
/// would be more than `most` poses, takes fewer times after each key, and then fewer keys. A track gets poses in
/// proportion to its number of telling keys, but at least one.
///
/// If nodes have skins, each track is judged with each of these skins: at its own keys, at keys of the joints, and at
/// times between them. If these are more than `most` poses, some of them are chosen in the same way. The skins must
/// outlive the poses.
[[nodiscard]] std::vector<PlayedPose> played_tracks(const MeshWeights& weights, const Viewer& viewer, std::size_t most);

/// Returns poses in which one of the listed targets has a weight and all other targets have weight 0. For each listed
/// target, there are poses at `steps` evenly spaced weights up to 1.
[[nodiscard]] PoseList alone_poses(std::span<const std::size_t> targets, std::size_t target_count, std::size_t steps);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_POSES_PLAYED_POSES_H_
