/// What PC2 and MDD share: samples of V positions, one after the other. Private to io.
#ifndef CHRONORMAL_IO_CACHE_POINT_CACHE_BODY_H_
#define CHRONORMAL_IO_CACHE_POINT_CACHE_BODY_H_

#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "chronormal/core/result.h"
#include "io/bytes/binary.h"
#include "io/cache/position_cache.h"

namespace chronormal::inline internal::point_cache {

/// The counts of a header.
struct Counts {
  std::int32_t vertices = 0;
  std::int32_t samples = 0;
};

/// Checks that there are vertices and samples, and as many bytes from `begin` on as they take: times_size bytes and
/// 3 x vertices float32 for each sample. Afterwards no product of them overflows.
[[nodiscard]] inline Status check_counts(std::string_view file, const std::string& name, Counts counts,
                                         std::size_t begin, std::size_t times_size) {
  const std::string place = binary::place(name, begin);
  if (counts.vertices <= 0 || counts.samples <= 0)
    return invalid_input(place, "the header declares " + std::to_string(counts.vertices) + " vertices and " +
                                    std::to_string(counts.samples) + " samples");
  const std::uint64_t left = file.size() - begin;
  const std::uint64_t sample_size = times_size + std::uint64_t{12} * static_cast<std::uint32_t>(counts.vertices);
  const auto samples = static_cast<std::uint64_t>(counts.samples);
  const bool fits = binary::fits(samples, sample_size, left);
  if (!fits || samples * sample_size != left)
    return invalid_input(place, "the header declares " + std::to_string(counts.samples) + " samples of " +
                                    std::to_string(counts.vertices) + " vertices, for which the file is too " +
                                    (fits ? "long" : "short"));
  return Success{};
}

/// Reads the positions of all samples; their times are set by the caller. Precondition: check_counts().
[[nodiscard]] inline Result<PositionCache> read_positions(std::string_view file, const std::string& name, Counts counts,
                                                          std::size_t begin, std::endian order) {
  PositionCache cache;
  cache.vertex_count = static_cast<std::size_t>(counts.vertices);
  cache.samples.resize(static_cast<std::size_t>(counts.samples));
  const std::size_t coordinates = 3 * cache.vertex_count;
  for (std::size_t k = 0; k < cache.samples.size(); ++k) {
    std::vector<float>& positions = cache.samples[k].positions;
    positions.resize(coordinates);
    const std::size_t at = begin + 4 * coordinates * k;
    const std::size_t read = binary::load_coordinates<float>(file.data() + at, coordinates, order, positions.data());
    if (read < coordinates)
      return invalid_input(
          binary::place(name, at + 4 * read) + ", sample " + std::to_string(k) + ", vertex " + std::to_string(read / 3),
          "the coordinate is not a finite number");
  }
  return cache;
}

/// Whether the counts of a motion fit into a header, and its segments into the format. Errors: kUsage.
[[nodiscard]] inline Status check_writable(const Motion& motion) {
  constexpr std::size_t kMost = std::numeric_limits<std::int32_t>::max();
  if (Status status = check_is_sequence(motion); !status) return status;
  if (motion.keyframes.size() > kMost || motion.topology.vertex_count() > kMost)
    return Error{ErrorCode::kUsage, "", "this format holds no more than 2,147,483,647 vertices and keyframes"};
  return Success{};
}

inline void append_positions(std::string& file, const Motion& motion, std::endian order) {
  for (const Motion::Keyframe& keyframe : motion.keyframes) {
    for (const float coordinate : keyframe.positions) binary::append(file, coordinate, order);
  }
}

}  // namespace chronormal::inline internal::point_cache

#endif  // CHRONORMAL_IO_CACHE_POINT_CACHE_BODY_H_
