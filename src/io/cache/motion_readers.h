/// The lists of formats that hold a whole motion, and of point caches, which need a mesh besides; one entry each.
///
/// A new format is a new entry; tests/io/motion_readers_test.cpp walks the lists and fails for an entry that has no
/// truncation, boundary and mutation tests, or no fuzz target fuzz/NAME_fuzz.cpp.
#ifndef CHRONORMAL_IO_CACHE_MOTION_READERS_H_
#define CHRONORMAL_IO_CACHE_MOTION_READERS_H_

#include <span>
#include <string>
#include <string_view>

#include "chronormal/core/result.h"
#include "chronormal/motion/motion.h"
#include "io/cache/position_cache.h"

namespace chronormal {

struct MotionReader {
  std::string_view name;                         ///< "npz": in messages, and of its fuzz target
  std::span<const std::string_view> extensions;  ///< lower case, with the dot: ".npz"
  /// Whether a file that begins with these bytes looks like this format.
  bool (*recognises)(std::string_view first_bytes);
  /// Reads a motion; name is for messages. Errors: kInvalidInput, always with a place.
  Result<Motion> (*read)(std::string_view bytes, const std::string& name, double frames_per_second);
};

struct CacheReader {
  std::string_view name;                         ///< "pc2"
  std::span<const std::string_view> extensions;  ///< ".pc2"
  /// Reads a cache; name is for messages. Errors: kInvalidInput, always with a place.
  Result<PositionCache> (*read)(std::string_view bytes, const std::string& name, const CacheOptions& options);
};

/// Formats that hold a whole motion: npz, md2.
[[nodiscard]] std::span<const MotionReader> motion_readers() noexcept;

/// Formats of positions alone: pc2, mdd, npy, and the .mc and .mcx files of Maya, each by itself. (A Maya cache of
/// several files is read by its .xml: io/cache/maya_cache.h.)
[[nodiscard]] std::span<const CacheReader> cache_readers() noexcept;

/// The reader whose extension the file name has (in upper or lower case), or nullptr.
[[nodiscard]] const MotionReader* find_motion_reader(std::string_view file_name) noexcept;
[[nodiscard]] const CacheReader* find_cache_reader(std::string_view file_name) noexcept;

}  // namespace chronormal

#endif  // CHRONORMAL_IO_CACHE_MOTION_READERS_H_
