// Finds the samples of a PC2 file, and writes PC2 files.
#include "io/cache/pc2.h"

#include <bit>
#include <cmath>
#include <cstdint>

#include "io/cache/point_cache_body.h"

namespace chronormal::inline internal {
namespace {

constexpr std::string_view kFirstWord("POINTCACHE2\0", 12);
constexpr std::size_t kPc2HeaderSize = 32;
constexpr std::endian kPc2Order = std::endian::little;

}  // namespace

Result<CacheLayout> find_pc2_layout(std::string_view bytes, std::uint64_t size, const std::string& name,
                                    const CacheOptions& options) {
  if (!bytes.starts_with(kFirstWord))
    return invalid_input(binary::place(name, 0),
                         "this is not a PC2 file, since it does not begin with POINTCACHE2; name a .pc2 file");
  if (bytes.size() < kPc2HeaderSize)
    return invalid_input(binary::place(name, bytes.size()),
                         "the file is cut off inside its header of 32 bytes; copy or export it again");
  if (const auto version = binary::load<std::int32_t>(bytes.data() + 12, kPc2Order); version != 1)
    return invalid_input(binary::place(name, 12),
                         "version " + std::to_string(version) + " of PC2 cannot be read; export the file as version 1");
  const point_cache::Counts counts{binary::load<std::int32_t>(bytes.data() + 16, kPc2Order),
                                   binary::load<std::int32_t>(bytes.data() + 28, kPc2Order)};
  const double first = double{binary::load<float>(bytes.data() + 20, kPc2Order)};
  const double step = double{binary::load<float>(bytes.data() + 24, kPc2Order)};
  if (!std::isfinite(first))
    return invalid_input(binary::place(name, 20), "the start frame is NaN or infinite; export the file again");
  if (!std::isfinite(step) || !(step > 0))
    return invalid_input(binary::place(name, 24),
                         "the number of frames between two samples must be greater than 0; export the file again");
  if (Status status = point_cache::check_counts(size, name, counts, kPc2HeaderSize, 0); !status) return status.error();
  CacheLayout layout = point_cache::layout_of(counts, kPc2HeaderSize, kPc2Order);
  for (std::size_t k = 0; k < layout.times.size(); ++k)
    layout.times[k] = (first + static_cast<double>(k) * step) / options.frames_per_second;
  return layout;
}

Result<PositionCache> read_pc2(std::string_view bytes, const std::string& name, const CacheOptions& options) {
  const Result<CacheLayout> layout = find_pc2_layout(bytes, bytes.size(), name, options);
  if (!layout) return layout.error();
  return read_all_samples(layout.value(), bytes, name);
}

Result<std::string> pc2_header(const Motion& motion, double frames_per_second) {
  if (Status status = point_cache::check_writable(motion); !status) return status.error();
  const std::size_t last = motion.keyframes.size() - 1;
  const auto frame_of = [&](std::size_t k) { return motion.keyframes[k].time * frames_per_second; };
  const auto first = static_cast<float>(frame_of(0));
  const auto step = static_cast<float>((frame_of(last) - frame_of(0)) / static_cast<double>(last));
  for (std::size_t k = 0; k <= last; ++k) {
    const double frame = double{first} + static_cast<double>(k) * double{step};
    if (!(std::fabs(frame - frame_of(k)) <= 1e-3 * double{step}))
      return Error{ErrorCode::kUsage, "",
                   "PC2 needs equal times between keyframes, but keyframe " + std::to_string(k) +
                       " is earlier or later than that; write .mdd or .npz instead"};
  }

  std::string bytes(kFirstWord);
  binary::append(bytes, std::int32_t{1}, kPc2Order);
  binary::append(bytes, static_cast<std::int32_t>(motion.topology.vertex_count()), kPc2Order);
  binary::append(bytes, first, kPc2Order);
  binary::append(bytes, step, kPc2Order);
  binary::append(bytes, static_cast<std::int32_t>(motion.keyframes.size()), kPc2Order);
  return bytes;
}

Status write_pc2(MotionStream& stream, OutputFile& file) {
  return point_cache::write(pc2_header(stream.motion()), stream, kPc2Order, file);
}

}  // namespace chronormal::inline internal
