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
#include "workflow/bake/judge/right_normals.h"
#include "workflow/bake/low_rank/extra_curves.h"
#include "workflow/bake/write/tracks.h"
#include "workflow/hosts/played_track.h"
#include "workflow/shading/target_weights.h"

namespace chronormal::inline internal {

/// A track that drives a mesh, with the weights of extra targets.
struct DrivingTrack {
  WeightTrack track;
  TimeRange animation;
};

/// Adds what a host plays of a track: at `phase` (in [0, 1)) and as many instants as asked for in all between two keys,
/// evenly; no more than `most` in all, evenly too.
void add_played_poses(const DrivingTrack& driving, const Host& host, std::size_t between_keys, double phase,
                      std::size_t most, PoseList& poses);

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
