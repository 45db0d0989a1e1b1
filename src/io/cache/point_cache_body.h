/// The common part of PC2 and MDD: samples of V positions, one after the other. Private to io.
#ifndef CHRONORMAL_IO_CACHE_POINT_CACHE_BODY_H_
#define CHRONORMAL_IO_CACHE_POINT_CACHE_BODY_H_

#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

#include "chronormal/core/result.h"
#include "core/text.h"
#include "io/bytes/binary.h"
#include "io/cache/cache_layout.h"
#include "io/cache/position_cache.h"

namespace chronormal::inline internal::point_cache {

/// The counts in the header of a cache.
struct Counts {
  std::int32_t vertices = 0;
  std::int32_t samples = 0;
};

/// Checks the counts in a header against the size of the file. There must be vertices and samples. From byte `begin`
/// on, the file must have exactly times_size bytes for times, and 3 x vertices float32 for each sample. If there is no
/// error, products of the counts do not overflow.
[[nodiscard]] inline Status check_counts(std::uint64_t file_size, const std::string& name, Counts counts,
                                         std::size_t begin, std::size_t times_size) {
  const std::string place = binary::place(name, begin);
  if (counts.vertices <= 0 || counts.samples <= 0)
    return invalid_input(place, "the number of vertices is " + std::to_string(counts.vertices) +
                                    " and the number of samples is " + std::to_string(counts.samples) +
                                    ", but both must be at least 1; export the file again");
  const std::uint64_t left = file_size - begin;
  const auto vertices = static_cast<std::uint64_t>(counts.vertices);
  const auto samples = static_cast<std::uint64_t>(counts.samples);
  const std::uint64_t sample_size = times_size + 12 * vertices;
  const bool fits = binary::fits(samples, sample_size, left);
  if (!fits || samples * sample_size != left)
    return invalid_input(place, "the file is too " + std::string(fits ? "long" : "short") + " for the " +
                                    counted(samples, "sample", "samples") + " of " +
                                    counted(vertices, "vertex", "vertices") +
                                    " in its header; copy or export it again");
  return Success{};
}

/// Returns the layout of a file with the given counts, in which all times are 0 until the caller sets the times.
/// check_counts() must have accepted the counts before.
[[nodiscard]] inline CacheLayout layout_of(Counts counts, std::size_t begin, std::endian order) {
  CacheLayout layout;
  layout.vertex_count = static_cast<std::size_t>(counts.vertices);
  layout.times.resize(static_cast<std::size_t>(counts.samples));
  layout.begin = begin;
  layout.order = order;
  return layout;
}

/// Checks that a motion is a sequence, and that its counts fit into 32 bits. Errors: kUsage.
[[nodiscard]] inline Status check_writable(const Motion& motion) {
  constexpr std::size_t kMost = std::numeric_limits<std::int32_t>::max();
  if (Status status = check_is_sequence(motion); !status) return status;
  if (motion.keyframes.size() > kMost || motion.topology.vertex_count() > kMost)
    return Error{ErrorCode::kUsage, "",
                 "this format can have at most 2,147,483,647 vertices and keyframes; write .npz instead"};
  return Success{};
}

/// Writes a header, and after it the positions of all keyframes. Errors: those of the header, the stream and the file.
[[nodiscard]] inline Status write(const Result<std::string>& header, MotionStream& stream, std::endian order,
                                  OutputFile& file) {
  if (!header) return header.error();
  if (Status status = file.append(header.value()); !status) return status;
  return each_keyframe(stream, order, [&file](std::string_view bytes) { return file.append(bytes); });
}

}  // namespace chronormal::inline internal::point_cache

#endif  // CHRONORMAL_IO_CACHE_POINT_CACHE_BODY_H_
