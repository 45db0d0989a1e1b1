/// MDD, the point cache of LightWave. Big endian, without a first word to know it by:
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
#include "io/cache/position_cache.h"

namespace chronormal::inline internal {

/// Reads an MDD file, of which name is the name for messages; nothing of options is needed.
///
/// Errors: kInvalidInput with the place "NAME, byte N", followed by sample and vertex where they are known: no vertices
/// or samples, more or fewer bytes than the header declares (refused before memory is taken), times and coordinates
/// that are not finite.
[[nodiscard]] Result<PositionCache> read_mdd(std::string_view bytes, const std::string& name,
                                             const CacheOptions& options = {});

/// Writes the positions and times of a motion. Errors: kUsage without a place: blend shapes, more than 2^31 - 1
/// vertices or keyframes, and times that are the same as float32.
[[nodiscard]] Result<std::string> write_mdd(const Motion& motion);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_CACHE_MDD_H_
