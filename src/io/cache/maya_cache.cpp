#include "io/cache/maya_cache.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <optional>
#include <pugixml.hpp>
#include <system_error>
#include <utility>

#include "core/charconv.h"
#include "io/bytes/binary.h"
#include "io/bytes/file.h"
#include "io/bytes/scan.h"
#include "io/cache/maya_chunks.h"
#include "io/system/names.h"

namespace chronormal::inline internal {
namespace {

class DescriptionReader {
 public:
  explicit DescriptionReader(const std::string& name) : name_(name) {}

  Result<MayaCacheDescription> read(std::string_view bytes) {
    constexpr std::size_t kLargest = std::size_t{1} << 24;
    if (bytes.size() > kLargest)
      return error(kLargest, "the description of the Maya cache is larger than 16 MiB; export the cache again");
    const pugi::xml_parse_result parsed = document_.load_buffer(bytes.data(), bytes.size());
    const pugi::xml_node root = document_.child("Autodesk_Cache_File");
    if (!parsed || !root)
      return error(parsed ? 0 : static_cast<std::size_t>(parsed.offset),
                   parsed ? "this is not the description of a Maya cache, since it has no element Autodesk_Cache_File; "
                            "name the .xml file that Maya wrote"
                          : "the XML is not valid; export the cache again. The XML reader says: " +
                                std::string(parsed.description()));

    const pugi::xml_node type = root.child("cacheType");
    if (Status status = read_type(type); !status) return status.error();
    if (const pugi::xml_node per_frame = root.child("cacheTimePerFrame")) {
      if (Status status = read_ticks(per_frame, "TimePerFrame", description_.ticks_per_frame); !status)
        return status.error();
      if (description_.ticks_per_frame <= 0)
        return error(per_frame, "TimePerFrame must be greater than 0; export the cache again");
    }
    for (const pugi::xml_node channel : root.child("Channels").children()) {
      if (channel.type() != pugi::node_element) continue;
      if (Status status = read_channel(channel); !status) return status.error();
    }
    return std::move(description_);
  }

 private:
  [[nodiscard]] Error error(std::size_t at, std::string message) const {
    return invalid_input(binary::place(name_, at), std::move(message));
  }
  [[nodiscard]] Error error(const pugi::xml_node& node, std::string message) const {
    return error(static_cast<std::size_t>(std::max<std::ptrdiff_t>(node.offset_debug(), 0)), std::move(message));
  }

  [[nodiscard]] Status read_type(const pugi::xml_node& type) {
    const std::string_view files = type.attribute("Type").value(), format = type.attribute("Format").value();
    if (files != "OneFile" && files != "OneFilePerFrame")
      return error(type, "Type of cacheType is " + scan::quoted(files) +
                             ", but must be OneFile or OneFilePerFrame; export the cache again");
    if (format != "mcc" && format != "mcx")
      return error(
          type, "Format of cacheType is " + scan::quoted(format) + ", but must be mcc or mcx; export the cache again");
    description_.has_file_per_frame = files == "OneFilePerFrame";
    description_.extension = format == "mcc" ? ".mc" : ".mcx";
    return Success{};
  }

  [[nodiscard]] Status read_ticks(const pugi::xml_node& node, const char* attribute, std::int32_t& ticks) const {
    const std::string_view word = node.attribute(attribute).value();
    std::int64_t value = 0;
    const scan::NumberFault fault = scan::parse_integer(word, value);
    if (fault == scan::NumberFault::kTooLarge || value != static_cast<std::int32_t>(value))
      return error(node, std::string(attribute) + ": " + scan::quoted(word) +
                             " is too large for 32 bits; export the cache again");
    if (fault != scan::NumberFault::kNone) return error(node, attribute + (": " + scan::describe(fault, word)));
    ticks = static_cast<std::int32_t>(value);
    return Success{};
  }

  [[nodiscard]] Status read_channel(const pugi::xml_node& node) {
    MayaCacheDescription::Channel channel;
    channel.name = node.attribute("ChannelName").value();
    channel.interpretation = node.attribute("ChannelInterpretation").value();
    channel.is_regular = std::string_view(node.attribute("SamplingType").value()) == "Regular";
    if (channel.is_regular) {
      for (const auto& [attribute, ticks] : {std::pair<const char*, std::int32_t*>{"SamplingRate", &channel.step},
                                             {"StartTime", &channel.start},
                                             {"EndTime", &channel.end}}) {
        if (Status status = read_ticks(node, attribute, *ticks); !status) return status;
      }
      if (channel.step <= 0 || channel.start > channel.end)
        return error(node,
                     "a regular channel must have a SamplingRate greater than 0, and a StartTime not later than its "
                     "EndTime; export the cache again");
    }
    description_.channels.push_back(std::move(channel));
    return Success{};
  }

  const std::string& name_;
  pugi::xml_document document_;
  MayaCacheDescription description_;
};

// Removes a word and the integer after it from the beginning of the text. Returns false if the text does not begin with
// the word and an integer.
bool take_number_after(std::string_view& text, std::string_view word, std::int32_t& number) {
  if (!text.starts_with(word)) return false;
  const std::string_view digits = text.substr(word.size());
  const auto [end, code] = from_chars(digits.data(), digits.data() + digits.size(), number);
  if (code != std::errc{}) return false;
  text = digits.substr(static_cast<std::size_t>(end - digits.data()));
  return true;
}

// Returns true if a file name has the form STEM "Frame" N EXTENSION or STEM "Frame" N "Tick" M EXTENSION.
bool is_frame_file(std::string_view file, std::string_view stem, std::string_view extension) {
  if (!file.starts_with(stem) || !file.ends_with(extension) || file.size() < stem.size() + extension.size())
    return false;
  file = file.substr(stem.size(), file.size() - stem.size() - extension.size());
  std::int32_t frame = 0, tick = 0;
  if (!take_number_after(file, "Frame", frame)) return false;
  return file.empty() || (take_number_after(file, "Tick", tick) && file.empty());
}

std::string frame_file(std::string_view stem, std::string_view extension, std::int64_t ticks, std::int32_t per_frame) {
  const std::int64_t tick = ((ticks % per_frame) + per_frame) % per_frame, frame = (ticks - tick) / per_frame;
  return std::string(stem) + "Frame" + std::to_string(frame) + (tick == 0 ? "" : "Tick" + std::to_string(tick)) +
         std::string(extension);
}

Result<std::vector<std::string>> list_frame_files(const std::filesystem::path& folder, const std::string& stem,
                                                  const std::string& extension) {
  std::error_code code;
  std::filesystem::directory_iterator entries(folder.empty() ? "." : folder, code);
  std::vector<std::string> files;
  while (!code && entries != std::filesystem::directory_iterator{}) {
    std::string file = utf8_of(entries->path().filename());
    if (is_frame_file(file, stem, extension)) files.push_back(std::move(file));
    entries.increment(code);
  }
  if (code) return Error{ErrorCode::kFailed, utf8_of(folder), code.message()};
  // The order in which the file system lists files must not change the messages.
  std::sort(files.begin(), files.end());
  return files;
}

// Returns the first time, in ticks, at which a regularly sampled channel should have a sample but has none. The samples
// must be sorted by time.
std::optional<std::int64_t> find_missing(const MayaCacheDescription::Channel& channel, const PositionCache& cache) {
  std::size_t k = 0;
  for (std::int64_t ticks = channel.start; ticks <= channel.end; ticks += channel.step, ++k) {
    const auto ticks_of = [&] { return std::llround(cache.samples[k].time * kMayaTicksPerSecond); };
    while (k < cache.samples.size() && ticks_of() < ticks) ++k;
    if (k == cache.samples.size() || ticks_of() != ticks) return ticks;
  }
  return std::nullopt;
}

}  // namespace

Result<MayaCacheDescription> read_maya_description(std::string_view bytes, const std::string& name) {
  return DescriptionReader(name).read(bytes);
}

Result<PositionCache> read_maya_points(std::string_view bytes, const std::string& name, const CacheOptions& options) {
  const Result<std::vector<maya::Points>> list = maya::list_points(bytes, name);
  if (!list) return list.error();
  const Result<std::string> channel = maya::choose_channel(list.value(), options, {}, name);
  if (!channel) return channel.error();
  PositionCache cache;
  const maya::FarPoints far = maya::find_far_points(bytes, list.value(), channel.value());
  if (far.has_more_digits) cache.origin = far.origin;
  if (Status status = maya::append_samples(bytes, list.value(), channel.value(), name, cache); !status)
    return status.error();
  return cache;
}

Result<PositionCache> read_maya_cache(const std::string& xml_path, const CacheOptions& options,
                                      const std::function<Result<std::string_view>(const std::string& name)>& resolve) {
  const std::filesystem::path path = path_of(xml_path);
  const std::string name = utf8_of(path.filename()), stem = utf8_of(path.stem());
  Result<MayaCacheDescription> description = Error{};
  {
    const Result<FileBytes> xml = FileBytes::open(xml_path, resolve);
    if (!xml) return xml.error();
    description = read_maya_description(xml.value().bytes(), name);
  }
  if (!description) return description.error();
  const MayaCacheDescription& described = description.value();

  std::vector<std::string> files = {stem + described.extension};
  if (described.has_file_per_frame) {
    if (resolve)
      return Error{
          ErrorCode::kUsage, name,
          "the cache has a file for each frame, and such files can only be found in a folder on disk; give the path "
          "of the .xml file in that folder"};
    Result<std::vector<std::string>> found = list_frame_files(path.parent_path(), stem, described.extension);
    if (!found) return found.error();
    files = std::move(found).value();
    if (files.empty())
      return invalid_input(name, "the files of the cache are missing; they should be in the same folder, named like " +
                                     frame_file(stem, described.extension, 0, 1));
  }

  PositionCache cache;
  CacheOptions choice = options;
  using Use = std::function<Status(std::string_view bytes, const std::vector<maya::Points>& list)>;
  const auto with_points_of = [&](const std::string& file, const Use& use) -> Status {
    const Result<FileBytes> opened = FileBytes::open(utf8_of(path.parent_path() / path_of(file)), resolve);
    if (!opened) return opened.error();
    const Result<std::vector<maya::Points>> list = maya::list_points(opened.value().bytes(), file);
    if (!list) return list.error();
    return use(opened.value().bytes(), list.value());
  };
  // The first file decides which channel is read, because a channel that is sampled less often may be missing from
  // other files. The first file also decides the origin from which positions are measured. The origin is subtracted
  // only if some position has more digits than float32 holds, so every file is searched for such a position.
  maya::FarPoints far;
  for (const std::string& file : files) {
    const bool is_first = &file == files.data();
    const Status status =
        with_points_of(file, [&](std::string_view bytes, const std::vector<maya::Points>& list) -> Status {
          if (is_first) {
            Result<std::string> channel = maya::choose_channel(list, choice, described.channels, file);
            if (!channel) return channel.error();
            choice.channel = std::move(channel).value();
          }
          const maya::FarPoints found = maya::find_far_points(bytes, list, choice.channel);
          if (is_first) far.origin = found.origin;
          far.has_more_digits = found.has_more_digits;
          return Success{};
        });
    if (!status) return status.error();
    if (far.origin == Origin{} || far.has_more_digits) break;
  }
  if (far.has_more_digits) cache.origin = far.origin;
  for (const std::string& file : files) {
    const Status status = with_points_of(file, [&](std::string_view bytes, const std::vector<maya::Points>& list) {
      return maya::append_samples(bytes, list, choice.channel, file, cache);
    });
    if (!status) return status.error();
  }
  std::stable_sort(cache.samples.begin(), cache.samples.end(),
                   [](const PositionCache::Sample& a, const PositionCache::Sample& b) { return a.time < b.time; });

  for (const MayaCacheDescription::Channel& channel : described.channels) {
    if (channel.name != choice.channel || !channel.is_regular) continue;
    if (const std::optional<std::int64_t> ticks = find_missing(channel, cache))
      return invalid_input(name, "the sample at tick " + std::to_string(*ticks) + " is missing in the cache" +
                                     (described.has_file_per_frame
                                          ? "; copy its file into the folder of the .xml file; its name should be " +
                                                frame_file(stem, described.extension, *ticks, described.ticks_per_frame)
                                          : ""));
  }
  return cache;
}

}  // namespace chronormal::inline internal
