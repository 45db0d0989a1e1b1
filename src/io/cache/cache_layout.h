/// The layout of a point cache in its file. A sample has the positions of all vertices at one time. With the layout, a
/// sample can be read without the samples before it. Private to io.
///
///     byte begin                       sample 0: (V, 3) numbers, float32 or float64
///     byte begin + 3 V item_size       sample 1, and so on
///
/// PC2 files, MDD files and arrays of NumPy in C order have this form. The readers of these files find the layout, and
/// then read the samples by the layout.
///
/// Threads    pure.
#ifndef CHRONORMAL_IO_CACHE_CACHE_LAYOUT_H_
#define CHRONORMAL_IO_CACHE_CACHE_LAYOUT_H_

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/core/result.h"
#include "io/bytes/file.h"
#include "io/cache/position_cache.h"

namespace chronormal::inline internal {

/// The number of bytes at the beginning of a file from which its layout must be found. If these bytes are too few, the
/// file counts as a file without a layout.
inline constexpr std::size_t kLayoutBytes = std::size_t{1} << 20;

struct CacheLayout {
  std::size_t vertex_count = 0;
  std::vector<double> times;  ///< times of the samples, in seconds
  std::uint64_t begin = 0;
  std::size_t item_size = sizeof(float);  ///< bytes of a coordinate: 4 or 8
  std::endian order = std::endian::little;
  Origin origin = {};  ///< the point from which positions are measured; (0, 0, 0) for float32
  /// the name of the array in a NumPy file; if given, errors name an element instead of a byte
  std::string array = {};

  [[nodiscard]] std::size_t coordinates() const noexcept { return 3 * vertex_count; }
  [[nodiscard]] std::uint64_t sample_begin(std::size_t k) const noexcept {
    return begin + std::uint64_t{k} * coordinates() * item_size;
  }
};

/// Converts the bytes of coordinates of sample k to float32. `first` is the index of the first coordinate in the
/// sample. Errors: kInvalidInput for a coordinate that is not finite or too large for float32, with the place "NAME,
/// byte N, sample K, vertex V", or "NAME, positions[K, V, C]".
[[nodiscard]] Status decode_coordinates(const CacheLayout& layout, const std::string& name, std::size_t k,
                                        std::size_t first, std::string_view bytes, std::span<float> result);

/// Reads sample k of a file. Errors: as for decode_coordinates(), and errors of PositionedFile.
[[nodiscard]] Status read_sample(const CacheLayout& layout, const PositionedFile& file, const std::string& name,
                                 std::size_t k, std::span<float> positions);

/// Reads all samples of a file whose bytes are in memory. Errors: as for decode_coordinates().
[[nodiscard]] Result<PositionCache> read_all_samples(const CacheLayout& layout, std::string_view file,
                                                     const std::string& name);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_CACHE_CACHE_LAYOUT_H_
