#include "io/cache/mdd.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "io/cache/point_cache_body.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kHeaderSize = 8;
constexpr std::endian kOrder = std::endian::big;

}  // namespace

Result<PositionCache> read_mdd(std::string_view bytes, const std::string& name, const CacheOptions&) {
  if (bytes.size() < kHeaderSize)
    return invalid_input(binary::place(name, bytes.size()), "the file ends inside its header of 8 bytes");
  const point_cache::Counts counts{binary::load<std::int32_t>(bytes.data() + 4, kOrder),
                                   binary::load<std::int32_t>(bytes.data(), kOrder)};
  if (Status status = point_cache::check_counts(bytes, name, counts, kHeaderSize, sizeof(float)); !status)
    return status.error();

  const std::size_t body = kHeaderSize + sizeof(float) * static_cast<std::size_t>(counts.samples);
  Result<PositionCache> cache = point_cache::read_positions(bytes, name, counts, body, kOrder);
  if (!cache) return cache;
  for (std::size_t k = 0; k < cache.value().samples.size(); ++k) {
    const std::size_t at = kHeaderSize + sizeof(float) * k;
    const double time = double{binary::load<float>(bytes.data() + at, kOrder)};
    if (!std::isfinite(time))
      return invalid_input(binary::place(name, at) + ", sample " + std::to_string(k),
                           "the time is not a finite number");
    cache.value().samples[k].time = time;
  }
  return cache;
}

Result<std::string> write_mdd(const Motion& motion) {
  if (Status status = point_cache::check_writable(motion); !status) return status.error();
  std::string bytes;
  bytes.reserve(kHeaderSize + (4 + 12 * motion.topology.vertex_count()) * motion.keyframes.size());
  binary::append(bytes, static_cast<std::int32_t>(motion.keyframes.size()), kOrder);
  binary::append(bytes, static_cast<std::int32_t>(motion.topology.vertex_count()), kOrder);
  float before = -std::numeric_limits<float>::infinity();
  for (std::size_t k = 0; k < motion.keyframes.size(); ++k) {
    const auto time = static_cast<float>(motion.keyframes[k].time);
    if (!(before < time) || !std::isfinite(time))
      return Error{ErrorCode::kUsage, "",
                   "MDD holds times as float32, for which keyframe " + std::to_string(k) +
                       " is too near to the one before or too far from 0; write .npz"};
    binary::append(bytes, time, kOrder);
    before = time;
  }
  point_cache::append_positions(bytes, motion, kOrder);
  return bytes;
}

}  // namespace chronormal::inline internal
