/// Positions of vertices at several times, without faces, as in point caches. A mesh provides the faces:
///
///     mesh (faces, V vertices)  +  cache (V vertices at 11 times)  =  motion of 11 keyframes and 10 segments
///
/// Vertex v of the cache is vertex v of the mesh. Nothing in a cache confirms this, and a program that renumbers
/// vertices when it exports a mesh breaks the match unnoticed. The positions of the mesh itself are not used.
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

/// The result of a cache reader: at least one vertex and one sample, finite times and positions. The times need not
/// ascend.
struct PositionCache {
  struct Sample {
    double time = 0;               ///< in seconds
    std::vector<float> positions;  ///< (V, 3)
  };

  std::size_t vertex_count = 0;
  std::vector<Sample> samples;
  Origin origin = {};  ///< the point from which positions are measured
};

/// The facts that a cache reader may need. Most formats need only some of these facts.
struct CacheOptions {
  double frames_per_second = 1;  ///< finite and > 0; for formats whose times are in frames (PC2, npy)
  std::size_t vertex_count = 0;  ///< vertices of the mesh, to choose among the channels of a Maya cache; 0 if unknown
  std::string channel;           ///< name of a channel of a Maya cache; if empty, vertex_count decides
};

/// Combines the samples of a cache with the faces of a mesh into a sequence or a motion of another given kind. Every
/// keyframe gets the name of the cache. The result is valid (motion/motion.h), except that samples without positions
/// give keyframes without positions.
///
/// Errors: kInvalidInput with cache_name in the place, for a number of vertices that differs from that of the mesh (the
/// message has both numbers), for fewer than two samples, and for times that do not ascend as the kind demands (the
/// place has the sample).
[[nodiscard]] Result<Motion> motion_from_cache(Topology faces, PositionCache cache, const std::string& mesh_name,
                                               const std::string& cache_name, MotionKind kind = MotionKind::kSequence);

/// Checks that a motion has at least two keyframes, and segments between them. Errors: kUsage without a place.
[[nodiscard]] Status check_keyframes(const Motion& motion);

/// Checks that each keyframe is joined to the next one by a segment. Such a motion is a plain sequence, which even the
/// simplest format can store. Errors: kUsage without a place.
[[nodiscard]] Status check_is_sequence(const Motion& motion);

/// Passes the coordinates of each keyframe in order to each(), as bytes of float32 with the origin of the motion added.
/// Errors: from the stream and from each().
[[nodiscard]] Status each_keyframe(MotionStream& stream, std::endian order,
                                   const std::function<Status(std::string_view bytes)>& each);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_CACHE_POSITION_CACHE_H_
