/// MDD, the point cache of LightWave. It is big endian, and does not begin with a word by which it could be recognised:
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
/// Errors: kInvalidInput with the place "NAME, byte N", followed by sample and vertex if they are known: no vertices or
/// samples, more or fewer bytes than the header declares (refused before memory is taken), times and coordinates that
/// are not finite.
[[nodiscard]] Result<PositionCache> read_mdd(std::string_view bytes, const std::string& name,
                                             const CacheOptions& options = {});

/// Finds the layout of a file of `size` bytes from its first kLayoutBytes bytes, or from all of them. Errors: those of
/// read_mdd(), except for coordinates; kInvalidInput for times beyond these bytes.
[[nodiscard]] Result<CacheLayout> find_mdd_layout(std::string_view bytes, std::uint64_t size, const std::string& name,
                                                  const CacheOptions& options);

/// Makes the header of a motion, its counts and times. Errors, without a place: kUsage for blend shapes, for more than
/// 2^31 - 1 vertices or keyframes, and for times that are equal in float32.
[[nodiscard]] Result<std::string> mdd_header(const Motion& motion);

/// Writes the header, and the positions as they are read. Errors: from the header, the stream and the file.
[[nodiscard]] Status write_mdd(MotionStream& stream, OutputFile& file);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_CACHE_MDD_H_
