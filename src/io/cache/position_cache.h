/// Positions of vertices at several times, without faces, as point caches hold them. A mesh gives them their faces:
///
///     mesh (faces, V vertices)  +  cache (V vertices at 11 times)  =  motion of 11 keyframes and 10 segments
///
/// Vertex v of the cache is vertex v of the mesh. A cache does not say so, and programs that renumber vertices when
/// they export a mesh break it without a trace. The positions of the mesh itself are not used.
///
/// Shapes     V = vertices; positions are (V, 3).
/// Units      times: seconds.
/// Threads    pure.
#ifndef CHRONORMAL_IO_CACHE_POSITION_CACHE_H_
#define CHRONORMAL_IO_CACHE_POSITION_CACHE_H_

#include <bit>
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/motion/motion.h"
#include "io/mesh/far_origin.h"

namespace chronormal::inline internal {

/// Holds the result of a cache reader: at least one vertex and one sample, finite times and positions. The times need
/// not ascend.
struct PositionCache {
  struct Sample {
    double time = 0;               ///< seconds
    std::vector<float> positions;  ///< (V, 3)
  };

  std::size_t vertex_count = 0;
  std::vector<Sample> samples;
  Origin origin = {};  ///< the point from which positions count
};

/// Holds what a cache reader may need to know; most formats need little of it.
struct CacheOptions {
  double frames_per_second = 1;  ///< finite and > 0; for formats whose times are frames (PC2, npy)
  std::size_t vertex_count = 0;  ///< vertices of the mesh, to choose among the channels of a Maya cache; 0 if unknown
  std::string channel;           ///< name of a channel of a Maya cache; if empty, vertex_count decides
};

/// Gives the samples of a cache the faces of a mesh, as a sequence or another kind that is known. Every keyframe takes
/// the name of the cache. The result is valid (motion/motion.h), except that samples without positions give keyframes
/// without positions.
/// keyframes without any.
///
/// Errors: kInvalidInput with cache_name in the place: another number of vertices than the mesh (the message has both),
/// fewer than two samples, times that do not ascend as the kind has it (the place has the sample).
[[nodiscard]] Result<Motion> motion_from_cache(Topology faces, PositionCache cache, const std::string& mesh_name,
                                               const std::string& cache_name, MotionKind kind = MotionKind::kSequence);

/// Checks that the keyframes of a motion are a list of two samples or more. Errors: kUsage without a place.
[[nodiscard]] Status check_keyframes(const Motion& motion);

/// Checks this, and that segments join all neighbours: such a motion is one sequence, which even the simplest format
/// can hold. Errors: kUsage without a place.
[[nodiscard]] Status check_is_sequence(const Motion& motion);

/// Calls each() with the coordinates of one keyframe after the other, as bytes of float32, to which the origin of the
/// motion was added. Errors: from the stream and from each().
[[nodiscard]] Status each_keyframe(MotionStream& stream, std::endian order,
                                   const std::function<Status(std::string_view bytes)>& each);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_CACHE_POSITION_CACHE_H_
