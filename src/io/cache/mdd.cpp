// Finds the samples of an MDD file, and writes MDD files.
#include "io/cache/mdd.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "io/cache/point_cache_body.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kMddHeaderSize = 8;
constexpr std::endian kMddOrder = std::endian::big;

}  // namespace

Result<CacheLayout> find_mdd_layout(std::string_view bytes, std::uint64_t size, const std::string& name,
                                    const CacheOptions& /*options*/) {
  if (bytes.size() < kMddHeaderSize)
    return invalid_input(binary::place(name, bytes.size()),
                         "the file is cut off inside its header of 8 bytes; copy or export it again");
  const point_cache::Counts counts{binary::load<std::int32_t>(bytes.data() + 4, kMddOrder),
                                   binary::load<std::int32_t>(bytes.data(), kMddOrder)};
  if (Status status = point_cache::check_counts(size, name, counts, kMddHeaderSize, sizeof(float)); !status)
    return status.error();
  const std::size_t body = kMddHeaderSize + sizeof(float) * static_cast<std::size_t>(counts.samples);
  if (body > bytes.size())
    return invalid_input(binary::place(name, bytes.size()),
                         "the file is cut off inside the times of its samples; copy or export it again");
  CacheLayout layout = point_cache::layout_of(counts, body, kMddOrder);
  for (std::size_t k = 0; k < layout.times.size(); ++k) {
    const std::size_t at = kMddHeaderSize + sizeof(float) * k;
    layout.times[k] = double{binary::load<float>(bytes.data() + at, kMddOrder)};
    if (!std::isfinite(layout.times[k]))
      return invalid_input(binary::place(name, at) + ", sample " + std::to_string(k),
                           "the time is NaN or infinite; times must be finite numbers");
  }
  return layout;
}

Result<PositionCache> read_mdd(std::string_view bytes, const std::string& name, const CacheOptions& options) {
  const Result<CacheLayout> layout = find_mdd_layout(bytes, bytes.size(), name, options);
  if (!layout) return layout.error();
  return read_all_samples(layout.value(), bytes, name);
}

Result<std::string> mdd_header(const Motion& motion) {
  if (Status status = point_cache::check_writable(motion); !status) return status.error();
  std::string bytes;
  binary::append(bytes, static_cast<std::int32_t>(motion.keyframes.size()), kMddOrder);
  binary::append(bytes, static_cast<std::int32_t>(motion.topology.vertex_count()), kMddOrder);
  float before = -std::numeric_limits<float>::infinity();
  for (std::size_t k = 0; k < motion.keyframes.size(); ++k) {
    const auto time = static_cast<float>(motion.keyframes[k].time);
    if (!(before < time) || !std::isfinite(time))
      return Error{ErrorCode::kUsage, "",
                   "keyframe " + std::to_string(k) +
                       " is so close to the keyframe before, or so late, that the float32 times of MDD cannot tell "
                       "them apart; write .npz instead"};
    binary::append(bytes, time, kMddOrder);
    before = time;
  }
  return bytes;
}

Status write_mdd(MotionStream& stream, OutputFile& file) {
  return point_cache::write(mdd_header(stream.motion()), stream, kMddOrder, file);
}

}  // namespace chronormal::inline internal
