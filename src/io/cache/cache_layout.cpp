// Reads samples at the offsets that a layout gives, and checks their coordinates.
#include "io/cache/cache_layout.h"

#include <algorithm>

#include "io/bytes/binary.h"

namespace chronormal::inline internal {

Status decode_coordinates(const CacheLayout& layout, const std::string& name, std::size_t k, std::size_t first,
                          std::string_view bytes, std::span<float> result) {
  const bool is_double = layout.item_size == sizeof(double);
  const std::size_t read =
      is_double ? binary::load_coordinates<double>(bytes.data(), result.size(), layout.order, result.data(),
                                                   layout.origin, first)
                : binary::load_coordinates<float>(bytes.data(), result.size(), layout.order, result.data());
  if (read == result.size()) return Success{};
  const std::size_t at = first + read;
  const char* const wrong = bytes.data() + read * layout.item_size;
  const double value =
      is_double ? binary::load<double>(wrong, layout.order) : double{binary::load<float>(wrong, layout.order)};
  const std::string vertex = std::to_string(at / 3), sample = std::to_string(k);
  const std::string place = layout.array.empty() ? binary::place(name, layout.sample_begin(k) + at * layout.item_size) +
                                                       ", sample " + sample + ", vertex " + vertex
                                                 : name + ", " + layout.array + "[" + sample + ", " + vertex + ", " +
                                                       std::to_string(at % 3) + "]";
  return invalid_input(place, binary::coordinate_fault(value));
}

Status read_sample(const CacheLayout& layout, const PositionedFile& file, const std::string& name, std::size_t k,
                   std::span<float> positions) {
  // the number of coordinates in a block, so small that a block stays in cache until its coordinates are checked
  constexpr std::size_t kBlock = std::size_t{1} << 15;
  std::vector<char> bytes(std::min(kBlock, positions.size()) * layout.item_size);
  for (std::size_t first = 0; first < positions.size(); first += kBlock) {
    const std::span<float> block = positions.subspan(first, std::min(kBlock, positions.size() - first));
    const std::span<char> raw = std::span(bytes).first(block.size() * layout.item_size);
    Status status = file.read(layout.sample_begin(k) + first * layout.item_size, raw);
    if (status) status = decode_coordinates(layout, name, k, first, {raw.data(), raw.size()}, block);
    if (!status) return status;
  }
  return Success{};
}

Result<PositionCache> read_all_samples(const CacheLayout& layout, std::string_view file, const std::string& name) {
  PositionCache cache;
  cache.vertex_count = layout.vertex_count;
  cache.origin = layout.origin;
  cache.samples.resize(layout.times.size());
  for (std::size_t k = 0; k < cache.samples.size(); ++k) {
    PositionCache::Sample& sample = cache.samples[k];
    sample.time = layout.times[k];
    sample.positions.resize(layout.coordinates());
    const std::string_view bytes = file.substr(static_cast<std::size_t>(layout.sample_begin(k)));
    if (const Status status = decode_coordinates(layout, name, k, 0, bytes, sample.positions); !status)
      return status.error();
  }
  return cache;
}

}  // namespace chronormal::inline internal
