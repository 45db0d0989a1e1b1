/// Reads the chunks of Maya caches (.mc and .mcx files), and chooses a channel of points. Private to io.
#ifndef CHRONORMAL_IO_CACHE_MAYA_CHUNKS_H_
#define CHRONORMAL_IO_CACHE_MAYA_CHUNKS_H_

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/core/result.h"
#include "io/cache/maya_cache.h"
#include "io/cache/position_cache.h"

namespace chronormal::inline internal::maya {

/// The place of the points of one channel at one time in a file.
struct Points {
  std::string_view channel;  ///< the name of the channel; it lies in the bytes of the file
  std::int32_t ticks = 0;
  std::uint32_t count = 0;
  bool is_double = false;
  std::size_t begin = 0;  ///< offset of the first of 3 x count coordinates, which all lie inside the file
};

/// Lists the points of all channels in the order of the file. Errors: as for read_maya_points().
[[nodiscard]] Result<std::vector<Points>> list_points(std::string_view bytes, const std::string& name);

/// Returns the name of the channel that the options choose from a list. Errors: kInvalidInput with `name` as the place,
/// if no channel or several channels fit; the message names the existing channels.
[[nodiscard]] Result<std::string> choose_channel(const std::vector<Points>& list, const CacheOptions& options,
                                                 const std::vector<MayaCacheDescription::Channel>& described,
                                                 const std::string& name);

/// The origin of the points of one channel (io/mesh/far_origin.h). `origin` differs from zero if the first points are
/// far from zero. `has_more_digits` is true if some point has more digits than float32 holds.
struct FarPoints {
  Origin origin = {};
  bool has_more_digits = false;
};
[[nodiscard]] FarPoints find_far_points(std::string_view bytes, const std::vector<Points>& list,
                                        std::string_view channel);

/// Reads the points of one channel from a list, subtracts the origin of the cache, and appends them with their times in
/// seconds (ticks / 6000). Errors: those of read_maya_points().
[[nodiscard]] Status append_samples(std::string_view bytes, const std::vector<Points>& list, std::string_view channel,
                                    const std::string& name, PositionCache& cache);

}  // namespace chronormal::inline internal::maya

#endif  // CHRONORMAL_IO_CACHE_MAYA_CHUNKS_H_
