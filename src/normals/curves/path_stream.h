/// Paths of a motion that is longer than memory: which keyframes a path follows from, and how far paths bend, keyframe
/// by keyframe. Private to normals, io and workflow.
#ifndef CHRONORMAL_NORMALS_CURVES_PATH_STREAM_H_
#define CHRONORMAL_NORMALS_CURVES_PATH_STREAM_H_

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/motion/motion.h"
#include "chronormal/motion/motion_stream.h"
#include "chronormal/normals/paths.h"

namespace chronormal::inline internal {

/// The first and the last of the keyframes from which the paths in segments first to last follow.
[[nodiscard]] std::pair<std::size_t, std::size_t> keyframes_of_paths(const Motion& motion, std::size_t first,
                                                                     std::size_t last, PathKind path);

/// Holds the keyframes from which the paths in segments first to last follow: their ends, and on curved paths of a
/// sequence one keyframe more on each side; in the first and the last segment two on the one side that there is. So
/// one segment of a curved path takes four keyframes. Errors: those of the stream.
[[nodiscard]] Status hold_paths(MotionStream& stream, std::size_t first, std::size_t last, PathKind path);

/// The velocities at a keyframe, (V, 3), from the positions of the keyframes from which they follow.
/// There must be as many positions as shares, all of one size
[[nodiscard]] std::vector<float> velocities_of(const VelocityShares& velocity,
                                               std::span<const std::span<const float>> positions);

/// The two sums that bend_of() (paths.h) divides.
struct BendSums {
  double bent = 0, way = 0;

  void add(const BendSums& other) noexcept {
    bent += other.bent;
    way += other.way;
  }
  [[nodiscard]] double bend() const noexcept { return way > 0 ? bent / way : 0; }
};

/// The share of one keyframe in these sums, over all vertices: of the keyframe that ends a segment, so that shards add
/// up to the whole. It is zero for the last keyframe, and for those within `every` keyframes of an end.
/// The keyframes at - every, at and at + every must be held, as far as they are there
[[nodiscard]] BendSums bend_at(const Motion& motion, std::size_t at, std::size_t every = 1);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CURVES_PATH_STREAM_H_
