/// Geometry caches of Maya: a description in XML, and the points in .mc (32-bit sizes) or .mcx (64-bit sizes) files.
///
///     cache.xml   cache.mc                                           one file
///     cache.xml   cacheFrame1.mc  cacheFrame2.mc  cacheFrame2Tick125.mc   one file per frame or part of one
///
/// A file of points is a tree of chunks in big endian. After a group CACH with the times of start and end come groups
/// MYCH, one for each time:
///
///     TIME  int32 ticks; if it is missing, the start time of the file counts
///     CHNM  name of a channel, SIZE  int32 points, FVCA or DVCA  points x 3 of float32 or float64; any number of these
///     ...   other chunks, which are skipped
///
/// Maya counts 6000 ticks a second. A frame lasts as many ticks as the description says under TimePerFrame, or 250
/// ticks (24 frames a second) if it has no TimePerFrame. A cache may be sampled more or less often than once a frame.
///
/// A channel has the points of one mesh. The reader takes the channel that the caller names; otherwise the channel with
/// as many points as the mesh has vertices, and of several such channels the only one whose ChannelInterpretation is
/// "positions".
///
/// Threads    pure, except that read_maya_cache() opens files.
#ifndef CHRONORMAL_IO_CACHE_MAYA_CACHE_H_
#define CHRONORMAL_IO_CACHE_MAYA_CACHE_H_

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/core/result.h"
#include "io/cache/position_cache.h"

namespace chronormal::inline internal {

constexpr std::int32_t kMayaTicksPerSecond = 6000;

/// The content of a description, the XML file of a cache.
struct MayaCacheDescription {
  struct Channel {
    std::string name;
    std::string interpretation;       ///< "positions", "normals", ...
    bool is_regular = false;          ///< true if there is a sample every `step` ticks from start to end
    std::int32_t step = 0;            ///< ticks from one sample to the next; above 0 if is_regular
    std::int32_t start = 0, end = 0;  ///< first and last time, in ticks; start <= end if is_regular
  };

  bool has_file_per_frame = false;
  std::string extension;  ///< extension of the files of points: ".mc" or ".mcx"
  std::int32_t ticks_per_frame = 250;
  std::vector<Channel> channels;
};

/// Reads a description; `name` is the file name for messages. The place of an error is "NAME, byte N". Errors:
/// kInvalidInput for bytes that are not XML, another root element, unknown types and formats, malformed numbers, and
/// more than 16 MiB.
[[nodiscard]] Result<MayaCacheDescription> read_maya_description(std::string_view bytes, const std::string& name);

/// Reads a single .mc or .mcx file. The place of an error is "NAME, byte N", followed by channel and point for a
/// coordinate. Errors: kInvalidInput for a coordinate that is not finite or too large; chunks that do not lie inside
/// their parent chunk, or are in a meaningless order; no channel that the options choose, or several (the message names
/// them); a channel whose number of points changes.
[[nodiscard]] Result<PositionCache> read_maya_points(std::string_view bytes, const std::string& name,
                                                     const CacheOptions& options = {});

/// Reads a description and the files of points beside it. These are the files in the same folder that begin with the
/// name of the description without ".xml"; no other file is opened. The samples of the result are sorted by time.
///
/// Errors: those of read_maya_description() and read_maya_points(), with the file name in the place; kFailed for files
/// that cannot be opened; kInvalidInput with the missing time and the file, if a regularly sampled channel lacks
/// samples that the description declares. If `resolve` is given, this function finds files by their paths. In this
/// case, a cache with a file for each frame gives kUsage, because only a folder can list such files.
[[nodiscard]] Result<PositionCache> read_maya_cache(
    const std::string& xml_path, const CacheOptions& options = {},
    const std::function<Result<std::string_view>(const std::string& name)>& resolve = {});

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_CACHE_MAYA_CACHE_H_
