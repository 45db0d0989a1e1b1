#include "io/cache/maya_chunks.h"

#include <algorithm>
#include <bit>
#include <map>
#include <optional>
#include <utility>

#include "core/text.h"
#include "io/bytes/binary.h"
#include "io/bytes/scan.h"

namespace chronormal::inline internal::maya {
namespace {

constexpr std::endian kMayaOrder = std::endian::big;

struct Chunk {
  std::string_view tag;
  std::size_t begin = 0, end = 0;  // offsets at which the content begins and ends
  std::size_t next = 0;            // offset of the next chunk
};

class ChunkReader {
 public:
  ChunkReader(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  Result<std::vector<Points>> read() {
    is_wide_ = bytes_.starts_with("FOR8");
    if (!is_wide_ && !bytes_.starts_with("FOR4"))
      return error(
          0, "this is not a Maya cache, since it begins neither with FOR4 nor with FOR8; name a .mc or .mcx file");
    for (std::size_t at = 0; at < bytes_.size();) {
      Chunk group;
      if (Status status = read_chunk(at, bytes_.size(), group); !status) return status.error();
      if (group.tag != (is_wide_ ? "FOR8" : "FOR4"))
        return error(at, "the cache is damaged, since " + scan::quoted(group.tag) +
                             " stands where a group must begin; copy or export the cache again");
      if (group.end - group.begin < kTagSize)
        return error(
            at, "the cache is damaged, since the group that begins here has no name; copy or export the cache again");
      if (Status status = read_group(bytes_.substr(group.begin, kTagSize), group); !status) return status.error();
      // Unlike other chunks, groups have no padding.
      at = group.end;
    }
    return std::move(list_);
  }

 private:
  static constexpr std::size_t kTagSize = 4;

  [[nodiscard]] Error error(std::size_t at, std::string message) const {
    return invalid_input(binary::place(name_, at), std::move(message));
  }

  [[nodiscard]] Status read_chunk(std::size_t at, std::size_t end, Chunk& chunk) const {
    const std::size_t header = is_wide_ ? 16 : 8, alignment = is_wide_ ? 8 : 4;
    if (end - at < header)
      return error(at, "the cache is damaged or cut off inside the header of a chunk; copy or export it again");
    chunk.tag = bytes_.substr(at, kTagSize);
    chunk.begin = at + header;
    const std::uint64_t size = is_wide_ ? binary::load<std::uint64_t>(bytes_.data() + at + 8, kMayaOrder)
                                        : binary::load<std::uint32_t>(bytes_.data() + at + 4, kMayaOrder);
    if (size > end - chunk.begin)
      return error(at, "the chunk " + scan::quoted(chunk.tag) + " should have " + counted(size, "byte", "bytes") +
                           ", but only " + counted(end - chunk.begin, "is left", "are left") +
                           "; copy or export the cache again");
    chunk.end = chunk.begin + static_cast<std::size_t>(size);
    const auto filled = static_cast<std::size_t>((alignment - size % alignment) % alignment);
    chunk.next = chunk.end + std::min(filled, end - chunk.end);
    return Success{};
  }

  [[nodiscard]] Status read_integer(const Chunk& chunk, std::int32_t& value) const {
    if (chunk.end - chunk.begin != sizeof value)
      return error(chunk.begin, "the chunk " + scan::quoted(chunk.tag) + " must have 4 bytes; export the cache again");
    value = binary::load<std::int32_t>(bytes_.data() + chunk.begin, kMayaOrder);
    return Success{};
  }

  [[nodiscard]] Status read_group(std::string_view group, const Chunk& whole) {
    if (group != "CACH" && group != "MYCH") return Success{};
    const bool has_points = group == "MYCH";
    std::optional<std::int32_t> time = start_;
    std::optional<std::string_view> channel;
    std::int32_t count = 0;
    bool has_count = false;
    for (std::size_t at = whole.begin + kTagSize; at < whole.end;) {
      Chunk chunk;
      if (Status status = read_chunk(at, whole.end, chunk); !status) return status;
      const std::string_view content = bytes_.substr(chunk.begin, chunk.end - chunk.begin);
      std::int32_t number = 0;
      if (chunk.tag == (has_points ? "TIME" : "STIM") || (has_points && chunk.tag == "SIZE")) {
        if (Status status = read_integer(chunk, number); !status) return status;
      }
      if (!has_points) {
        if (chunk.tag == "STIM") start_ = number;
      } else if (chunk.tag == "TIME") {
        time = number;
      } else if (chunk.tag == "CHNM") {
        channel = content.substr(0, content.find('\0'));
        has_count = false;
      } else if (chunk.tag == "SIZE") {
        count = number;
        has_count = true;
      } else if (chunk.tag == "FVCA" || chunk.tag == "DVCA") {
        if (!channel || !has_count)
          return error(at,
                       "the cache is damaged, since these points have no channel name (CHNM) or no size (SIZE); export "
                       "the cache again");
        if (!time)
          return error(
              at, "the points have no time, since neither TIME nor STIM comes before them; export the cache again");
        const bool is_double = chunk.tag == "DVCA";
        const std::uint64_t point_size = is_double ? 24 : 12;
        if (count < 0 || content.size() % point_size != 0 ||
            content.size() / point_size != static_cast<std::uint32_t>(count))
          return error(at, "the number of points of the channel " + scan::quoted(*channel) + " is " +
                               std::to_string(count) + ", which does not fit its " +
                               counted(content.size(), "byte", "bytes") + "; export the cache again");
        list_.push_back({*channel, *time, static_cast<std::uint32_t>(count), is_double, chunk.begin});
        channel.reset();
        has_count = false;
      }
      at = chunk.next;
    }
    return Success{};
  }

  std::string_view bytes_;
  const std::string& name_;
  bool is_wide_ = false;
  std::optional<std::int32_t> start_;  // start time of the file in ticks
  std::vector<Points> list_;
};

// Returns the names of channels with their numbers of points: "'a' (36), 'b' (72)". A long list is cut short.
std::string names_of(const std::map<std::string_view, std::uint32_t>& channels) {
  constexpr std::size_t kMostNames = 8;
  std::string text;
  std::size_t named = 0;
  for (const auto& [channel, count] : channels) {
    if (named > 0) text += ", ";
    if (named++ == kMostNames) return text + "...";
    text += scan::quoted(channel) + " (" + std::to_string(count) + ")";
  }
  return text;
}

}  // namespace

Result<std::vector<Points>> list_points(std::string_view bytes, const std::string& name) {
  return ChunkReader(bytes, name).read();
}

Result<std::string> choose_channel(const std::vector<Points>& list, const CacheOptions& options,
                                   const std::vector<MayaCacheDescription::Channel>& described,
                                   const std::string& name) {
  const std::string place = name + ", channels";
  std::map<std::string_view, std::uint32_t> all, left;
  for (const Points& points : list) all.emplace(points.channel, points.count);
  if (all.empty()) return invalid_input(place, "the cache has no points; export it again");
  if (!options.channel.empty()) {
    if (all.contains(options.channel)) return options.channel;
    return invalid_input(
        place, "the cache has no channel " + scan::quoted(options.channel) + "; choose one of " + names_of(all));
  }

  for (const auto& channel : all) {
    if (options.vertex_count == 0 || channel.second == options.vertex_count) left.insert(channel);
  }
  if (left.empty())
    return invalid_input(place, "no channel has the " + counted(options.vertex_count, "point", "points") +
                                    " of the mesh, only " + names_of(all) +
                                    "; give the mesh that the cache was made for");
  if (left.size() > 1) {
    std::map<std::string_view, std::uint32_t> positions;
    for (const MayaCacheDescription::Channel& channel : described) {
      const auto found = left.find(channel.name);
      if (found != left.end() && channel.interpretation == "positions") positions.insert(*found);
    }
    if (!positions.empty()) left = std::move(positions);
  }
  if (left.size() > 1)
    return invalid_input(place, "several channels fit the mesh, " + names_of(left) +
                                    "; name one of them, as in cache.xml#" + scan::quoted(left.begin()->first));
  return std::string(left.begin()->first);
}

FarPoints find_far_points(std::string_view bytes, const std::vector<Points>& list, std::string_view channel) {
  FarPoints found;
  bool is_first = true;
  for (const Points& points : list) {
    if (points.channel != channel) continue;
    const std::size_t size = points.is_double ? sizeof(double) : sizeof(float);
    std::vector<double> positions(3 * std::size_t{points.count});
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const char* const at = bytes.data() + points.begin + i * size;
      positions[i] =
          points.is_double ? binary::load<double>(at, kMayaOrder) : double{binary::load<float>(at, kMayaOrder)};
      if (binary::coordinate_fault(positions[i]) != nullptr) return {};  // append_samples() reports the bad coordinate
      if (loses_digits(positions[i], 0)) found.has_more_digits = true;
    }
    if (is_first) found.origin = far_origin(std::span<const double>(positions));
    is_first = false;
  }
  return found;
}

Status append_samples(std::string_view bytes, const std::vector<Points>& list, std::string_view channel,
                      const std::string& name, PositionCache& cache) {
  for (const Points& points : list) {
    if (points.channel != channel) continue;
    const std::size_t count = points.count;
    if (count == 0)
      return invalid_input(binary::place(name, points.begin),
                           "the channel " + scan::quoted(channel) + " has no points; export the cache again");
    if (cache.samples.empty()) cache.vertex_count = count;
    if (count != cache.vertex_count)
      return invalid_input(binary::place(name, points.begin), "the channel " + scan::quoted(channel) + " has " +
                                                                  counted(count, "point", "points") + " here, but " +
                                                                  grouped(cache.vertex_count) +
                                                                  " in earlier samples; export the cache again");
    PositionCache::Sample sample;
    sample.time = static_cast<double>(points.ticks) / kMayaTicksPerSecond;
    sample.positions.resize(3 * count);
    const char* const begin = bytes.data() + points.begin;
    const std::size_t read =
        points.is_double
            ? binary::load_coordinates<double>(begin, 3 * count, kMayaOrder, sample.positions.data(), cache.origin)
            : binary::load_coordinates<float>(begin, 3 * count, kMayaOrder, sample.positions.data(), cache.origin);
    if (read < 3 * count) {
      const std::size_t size = points.is_double ? sizeof(double) : sizeof(float);
      const char* const at = begin + read * size;
      return invalid_input(binary::place(name, points.begin + read * size) + ", channel " + scan::quoted(channel) +
                               ", point " + std::to_string(read / 3),
                           binary::coordinate_fault(points.is_double ? binary::load<double>(at, kMayaOrder)
                                                                     : double{binary::load<float>(at, kMayaOrder)}));
    }
    cache.samples.push_back(std::move(sample));
  }
  return Success{};
}

}  // namespace chronormal::inline internal::maya
