/// Poses to judge a bake at: what hosts play of the tracks of a file, targets alone, and what a program may mix.
/// Private to workflow.
///
/// Poses      weights of the mesh's own targets, then those of extra targets.
/// Threads    pure; random poses are the same on every system.
#ifndef CHRONORMAL_WORKFLOW_BAKE_JUDGE_PLAYED_POSES_H_
#define CHRONORMAL_WORKFLOW_BAKE_JUDGE_PLAYED_POSES_H_

#include <cstddef>
#include <span>
#include <vector>

#include "chronormal/workflow/hosts.h"
#include "workflow/bake/judge/seen_pose.h"
#include "workflow/bake/low_rank/extra_curves.h"
#include "workflow/bake/mesh_weights.h"
#include "workflow/bake/write/tracks.h"
#include "workflow/hosts/played_track.h"
#include "workflow/shading/target_weights.h"

namespace chronormal::inline internal {

/// A track that drives a mesh, with the weights of extra targets.
struct DrivingTrack {
  WeightTrack track;
  TimeRange animation;
  double cuts = 1;  ///< into how many pieces a gap between two keys of the file was cut, on average: each piece gets so
                    ///< many times fewer instants
};

/// The keys after which a track shows something new, because weights move, come to rest or jump there; ascending. Where
/// there are more than `most`, those come first after which a weight is as large as nowhere else, or the product of two
/// weights is, so that a wink in a long animation is among them; the others are taken evenly.
[[nodiscard]] std::vector<std::size_t> telling_keys(const WeightTrack& track, std::size_t most);

/// The numbers of at most so many tracks, ascending. Where there are more, those come first in which a weight, or the
/// product of two weights, is as large as nowhere else; the others are taken evenly. All have the same targets.
[[nodiscard]] std::vector<std::size_t> telling_tracks(std::span<const WeightTrack> tracks, std::size_t most);

/// What a host plays of some tracks, one after the other, but for poses that look as the one before: for each telling
/// key, `phase` (in [0, 1)) and as many instants as asked for in all up to the next key, evenly; where these are more
/// than `most`, fewer instants of each key, and then fewer keys. Each track gets a share by the number of its telling
/// keys, and one pose at least. Through each of the skins of its nodes, which must outlive the poses, a track is seen
/// at its keys, those of the joints and instants between, and only where these are more than `most` at some of them and
/// as above.
[[nodiscard]] std::vector<SeenPose> seen_tracks(std::span<const DrivingTrack> tracks, const MeshSkins& skins,
                                                const Host& host, std::size_t between_keys, double phase,
                                                std::size_t most);

/// Each of these targets alone, at `steps` weights up to 1, the first of which is 1 / steps minus phase / steps.
[[nodiscard]] PoseList alone_poses(std::span<const std::size_t> targets, std::size_t target_count,
                                   const ExtraDrivers& extras, std::size_t steps, double phase);

/// Poses with 2 to 16 of these targets active, at weights from 0 to 1. None where there are less than two.
[[nodiscard]] PoseList random_poses(std::span<const std::size_t> targets, std::size_t target_count,
                                    const ExtraDrivers& extras, std::size_t count, unsigned seed);

/// Poses on the way from one track to another, as mixers blend them: all weights linearly. None where there are less
/// than two tracks.
[[nodiscard]] PoseList cross_fades(std::span<const DrivingTrack> tracks, std::size_t count, unsigned seed);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_JUDGE_PLAYED_POSES_H_
