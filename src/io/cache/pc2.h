/// PC2, the point cache of 3ds Max, which most programs support. The format is little endian:
///
///     byte  0   "POINTCACHE2" and a zero byte
///          12   int32    version: 1
///          16   int32    vertices, V
///          20   float32  first frame
///          24   float32  frames from one sample to the next
///          28   int32    samples, S
///          32   float32  S x V x 3 coordinates
///
/// Sample k is at frame first + k * step. This frame divided by frames_per_second is the time of the sample in seconds.
///
/// Threads    pure.
#ifndef CHRONORMAL_IO_CACHE_PC2_H_
#define CHRONORMAL_IO_CACHE_PC2_H_

#include <string>
#include <string_view>

#include "chronormal/core/result.h"
#include "chronormal/motion/motion.h"
#include "io/bytes/output_file.h"
#include "io/cache/cache_layout.h"
#include "io/cache/position_cache.h"

namespace chronormal::inline internal {

/// Reads a PC2 file; `name` is for messages.
///
/// The place of an error is "NAME, byte N", followed by sample and vertex for a coordinate that is not finite. Errors:
/// kInvalidInput for another first word or version, no vertices or samples, more or fewer bytes than the header
/// declares (refused before memory is taken), a first frame that is not finite, and a step that is not above 0.
[[nodiscard]] Result<PositionCache> read_pc2(std::string_view bytes, const std::string& name,
                                             const CacheOptions& options = {});

/// Finds the layout of a file of `size` bytes. `bytes` has its first kLayoutBytes bytes, or all bytes of a smaller
/// file. Errors: those of read_pc2(), except for coordinates.
[[nodiscard]] Result<CacheLayout> find_pc2_layout(std::string_view bytes, std::uint64_t size, const std::string& name,
                                                  const CacheOptions& options);

/// Returns the header of the PC2 file for a motion. PC2 has no list of times. The times of the motion must therefore be
/// at equal steps, to a thousandth of a step. Errors, without a place: kUsage for times at other steps, for blend
/// shapes, and for more than 2^31 - 1 vertices or keyframes.
[[nodiscard]] Result<std::string> pc2_header(const Motion& motion, double frames_per_second = 1);

/// Writes a PC2 file: the header, with one frame per second, and then the positions of each keyframe as soon as they
/// are read. Errors: those of pc2_header(), the stream and the file.
[[nodiscard]] Status write_pc2(MotionStream& stream, OutputFile& file);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_CACHE_PC2_H_
