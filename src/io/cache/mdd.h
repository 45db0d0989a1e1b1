/// MDD, the point cache of LightWave. The format is big endian, and has no signature at its beginning by which a reader
/// could recognise it:
///
///     byte  0   int32    samples, S
///           4   int32    vertices, V
///           8   float32  S times, in seconds
///     8 + 4 S   float32  S x V x 3 coordinates
///
/// Threads    pure.
#ifndef CHRONORMAL_IO_CACHE_MDD_H_
#define CHRONORMAL_IO_CACHE_MDD_H_

#include <string>
#include <string_view>

#include "chronormal/core/result.h"
#include "chronormal/motion/motion.h"
#include "io/bytes/output_file.h"
#include "io/cache/cache_layout.h"
#include "io/cache/position_cache.h"

namespace chronormal::inline internal {

/// Reads an MDD file; `name` is for messages. The options have no effect.
///
/// The place of an error is "NAME, byte N", followed by sample and vertex if they are known. Errors: kInvalidInput for
/// a file without vertices or samples, for more or fewer bytes than the header declares (refused before memory is
/// taken), and for times and coordinates that are not finite.
[[nodiscard]] Result<PositionCache> read_mdd(std::string_view bytes, const std::string& name,
                                             const CacheOptions& options = {});

/// Finds the layout of a file of `size` bytes. `bytes` has its first kLayoutBytes bytes, or all bytes of a smaller
/// file. Errors: those of read_mdd(), except for coordinates; kInvalidInput if the times reach beyond these bytes.
[[nodiscard]] Result<CacheLayout> find_mdd_layout(std::string_view bytes, std::uint64_t size, const std::string& name,
                                                  const CacheOptions& options);

/// Returns the header of the MDD file for a motion: the counts and the times. Errors, without a place: kUsage for blend
/// shapes, for more than 2^31 - 1 vertices or keyframes, and for times that are equal in float32.
[[nodiscard]] Result<std::string> mdd_header(const Motion& motion);

/// Writes an MDD file: the header, and then the positions of each keyframe as soon as they are read. Errors: those of
/// mdd_header(), the stream and the file.
[[nodiscard]] Status write_mdd(MotionStream& stream, OutputFile& file);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_CACHE_MDD_H_
