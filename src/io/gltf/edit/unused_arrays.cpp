#include "io/gltf/edit/unused_arrays.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "io/json/json.h"
#include "io/json/json_writer.h"

namespace chronormal::inline internal::gltf {
namespace {

using Json = nlohmann::json;
using Range = UnusedArrays::Range;

constexpr std::size_t kRangeAlignment = 4;

// The extensions whose names begin with one of these texts need no check: their objects refer to textures, nodes and
// materials, but neither to accessors nor to buffer views.
constexpr std::string_view kKnownExtensions[] = {"KHR_materials_",
                                                 "KHR_texture_",
                                                 "EXT_texture_",
                                                 "KHR_lights_",
                                                 "KHR_animation_pointer",
                                                 "KHR_node_",
                                                 "KHR_mesh_quantization",
                                                 "KHR_xmp",
                                                 "MSFT_lod",
                                                 "MSFT_texture_",
                                                 "VRM",
                                                 "GODOT_",
                                                 "FB_",
                                                 "AGI_"};

bool is_known(std::string_view extension) {
  return std::any_of(std::begin(kKnownExtensions), std::end(kKnownExtensions),
                     [&](std::string_view known) { return extension.starts_with(known); });
}

// Returns true if a value and everything inside it uses only extensions of kKnownExtensions.
bool has_known_extensions_only(const Json& value) {
  if (value.is_object()) {
    const auto extensions = value.find("extensions");
    if (extensions != value.end() && extensions->is_object()) {
      for (const auto& [name, content] : extensions->items())
        if (!is_known(name)) return false;
    }
  }
  return !value.is_structured() || std::all_of(value.begin(), value.end(), has_known_extensions_only);
}

// Returns the member `key` of a JSON object, or null if the value has no such member.
const Json& at(const Json& value, const char* key) {
  static const Json kNull;
  const auto found = value.is_object() ? value.find(key) : value.end();
  return value.is_object() && found != value.end() ? *found : kNull;
}

// The accessors to which a document refers.
class References {
 public:
  References(const Json& root, std::size_t accessors) : referred_(accessors, false) {
    for (const Json& mesh : at(root, "meshes")) {
      for (const Json& primitive : at(mesh, "primitives")) {
        add(at(primitive, "indices"));
        for (const Json& accessor : at(primitive, "attributes")) add(accessor);
        for (const Json& target : at(primitive, "targets"))
          for (const Json& accessor : target) add(accessor);
      }
    }
    for (const Json& animation : at(root, "animations")) {
      for (const Json& sampler : at(animation, "samplers")) {
        add(at(sampler, "input"));
        add(at(sampler, "output"));
      }
    }
    for (const Json& skin : at(root, "skins")) add(at(skin, "inverseBindMatrices"));
  }

  bool operator[](std::size_t accessor) const { return referred_[accessor]; }

 private:
  void add(const Json& index) {
    if (!index.is_number()) return;
    const auto number = index.get<double>();
    if (number >= 0 && number < static_cast<double>(referred_.size()))
      referred_[static_cast<std::size_t>(number)] = true;
  }

  std::vector<bool> referred_;
};

// A part of a buffer view that an accessor reads. A sparse accessor reads up to three parts: its base values, its
// indices, and the values that replace some of the base values.
struct Part {
  std::size_t view = 0, offset = 0, length = 0;
};

// Returns the number of bytes from the first element to the end of the last element. An element has `size` bytes, and
// the next one begins `stride` bytes later. Returns nothing on overflow.
std::optional<std::size_t> length_of(std::size_t count, std::size_t stride, std::size_t size) {
  if (count == 0) return 0;
  if (stride > 0 && count - 1 > (static_cast<std::size_t>(-1) - size) / stride) return std::nullopt;
  return (count - 1) * stride + size;
}

// Returns the parts of views that an accessor reads, or nothing if a part is not inside its view.
std::optional<std::vector<Part>> parts_of(const Model& model, const Accessor& accessor) {
  std::vector<Part> parts;
  if (accessor.is_matrix && component_size(accessor.component) < kRangeAlignment)
    return std::nullopt;  // the columns of such matrices are padded
  const auto add = [&](std::size_t view, std::size_t offset, std::size_t count, std::size_t size, bool strides) {
    if (view >= model.views.size()) return false;
    const BufferView& of = model.views[view];
    const std::optional<std::size_t> length = length_of(count, strides ? of.stride.value_or(size) : size, size);
    if (!length || offset > of.length || *length > of.length - offset) return false;
    parts.push_back({view, offset, *length});
    return true;
  };
  if (accessor.view && !add(*accessor.view, accessor.offset, accessor.count, accessor.element_size(), true))
    return std::nullopt;
  if (accessor.sparse) {
    const Sparse& sparse = *accessor.sparse;
    if (!add(sparse.indices_view, sparse.indices_offset, sparse.count, component_size(sparse.indices_component),
             false) ||
        !add(sparse.values_view, sparse.values_offset, sparse.count, accessor.element_size(), false))
      return std::nullopt;
  }
  return parts;
}

// Returns the ranges in ascending order, with touching ranges joined.
std::vector<Range> joined(std::vector<Range> ranges) {
  std::sort(ranges.begin(), ranges.end(), [](const Range& a, const Range& b) { return a.begin < b.begin; });
  std::vector<Range> result;
  for (const Range& range : ranges) {
    if (range.begin == range.end) continue;
    if (!result.empty() && range.begin <= result.back().end)
      result.back().end = std::max(result.back().end, range.end);
    else
      result.push_back(range);
  }
  return result;
}

// Returns the bytes that are in `ranges` but not in `without`, as ranges. The sizes of the resulting ranges are
// multiples of kRangeAlignment.
std::vector<Range> aligned_difference(const std::vector<Range>& ranges, const std::vector<Range>& without) {
  std::vector<Range> result;
  auto other = without.begin();
  const auto add = [&](std::size_t begin, std::size_t end) {
    if (begin < end && end - begin >= kRangeAlignment) result.push_back({begin, end - (end - begin) % kRangeAlignment});
  };
  for (const Range& range : ranges) {
    std::size_t begin = range.begin;
    while (other != without.end() && other->end <= begin) ++other;
    for (auto next = other; next != without.end() && next->begin < range.end; ++next) {
      if (next->begin > begin) add(begin, next->begin);
      begin = std::max(begin, next->end);
    }
    add(begin, range.end);
  }
  return result;
}

// A map from the old place of a byte to its new place after some ranges were left out.
class Moved {
 public:
  explicit Moved(const std::vector<Range>& ranges) : ranges_(ranges) {
    std::size_t sum = 0;
    for (const Range& range : ranges) before_.push_back(std::exchange(sum, sum + range.end - range.begin));
  }

  std::size_t operator()(std::size_t offset) const {
    const auto next = std::upper_bound(ranges_.begin(), ranges_.end(), offset,
                                       [](std::size_t byte, const Range& range) { return byte < range.begin; });
    if (next == ranges_.begin()) return offset;
    const auto i = static_cast<std::size_t>(next - ranges_.begin()) - 1;
    return offset - before_[i] - (std::min(offset, ranges_[i].end) - ranges_[i].begin);
  }

 private:
  const std::vector<Range>& ranges_;
  std::vector<std::size_t> before_;  // for each range, the number of bytes that are left out before it
};

}  // namespace

std::size_t UnusedArrays::bytes_of(std::size_t buffer) const noexcept {
  std::size_t sum = 0;
  if (any())
    for (const Range& range : ranges[buffer]) sum += range.end - range.begin;
  return sum;
}

std::size_t UnusedArrays::bytes() const noexcept {
  std::size_t sum = 0;
  for (std::size_t buffer = 0; buffer < ranges.size(); ++buffer) sum += bytes_of(buffer);
  return sum;
}

std::vector<std::string_view> UnusedArrays::kept(std::size_t buffer, std::string_view bytes) const {
  std::vector<std::string_view> result;
  std::size_t begin = 0;
  if (any()) {
    for (const Range& range : ranges[buffer]) {
      result.push_back(bytes.substr(begin, range.begin - begin));
      begin = range.end;
    }
  }
  result.push_back(bytes.substr(begin));
  return result;
}

UnusedArrays find_unused_arrays(const Model& model, std::span<const std::optional<std::size_t>> sizes,
                                std::string_view before, std::string_view after) {
  const auto parse = [](std::string_view text) {
    return parse_json(text, "", 0, {"", [](std::size_t, const Json&) {}});
  };
  const Result<Json> source = parse(before), edited = parse(after);
  if (!source || !edited || !has_known_extensions_only(edited.value())) return {};
  // Arrays that could not be read may refer to any bytes, so the file keeps all its bytes.
  const auto has_fault = [](const auto& array) { return array.fault.has_value(); };
  if (std::any_of(model.accessors.begin(), model.accessors.end(), has_fault) ||
      std::any_of(model.views.begin(), model.views.end(), has_fault))
    return {};
  const std::size_t count = model.accessors.size();
  const References was(source.value(), count), is(edited.value(), count);

  // A view is used if an image or a used accessor refers to it. A view is unused if only unused accessors refer to it.
  std::vector<bool> is_used(model.views.size(), false), is_unused(model.views.size(), false);
  for (const Json& image : at(edited.value(), "images")) {
    const Json& view = at(image, "bufferView");
    if (view.is_number() && view.get<double>() < static_cast<double>(is_used.size()))
      is_used[view.get<std::size_t>()] = true;
  }
  std::vector<bool> is_whole = is_used;
  std::vector<std::vector<Part>> parts(count);
  std::vector<std::vector<Range>> used(sizes.size()), unused(sizes.size());
  std::vector<std::size_t> unused_accessors;
  for (std::size_t a = 0; a < count; ++a) {
    std::optional<std::vector<Part>> found = parts_of(model, model.accessors[a]);
    if (!found) return {};
    parts[a] = std::move(*found);
    const bool is_dead = was[a] && !is[a];
    // A view of interleaved arrays is kept completely, because three.js reads a whole stride for every element, also
    // for the last element.
    if (const std::optional<std::size_t> view = model.accessors[a].view; view && !is_dead)
      is_whole[*view] = is_whole[*view] || model.views[*view].stride.value_or(0) > model.accessors[a].element_size();
    if (is_dead && !parts[a].empty()) unused_accessors.push_back(a);
    for (const Part& part : parts[a]) {
      const BufferView& view = model.views[part.view];
      (is_dead ? is_unused : is_used)[part.view] = true;
      const std::size_t begin = view.offset + part.offset;
      (is_dead ? unused : used)[view.buffer].push_back({begin, begin + part.length});
    }
  }
  for (std::size_t v = 0; v < model.views.size(); ++v) {
    const BufferView& view = model.views[v];
    const std::optional<std::size_t>& size = sizes[view.buffer];
    if (size && (view.offset > *size || view.length > *size - view.offset)) return {};
    const Range whole{view.offset, view.offset + view.length};
    if (is_unused[v] && !is_used[v])
      unused[view.buffer].push_back(whole);
    else if (is_whole[v] || !is_used[v])
      used[view.buffer].push_back(whole);
  }

  UnusedArrays result;
  std::vector<Moved> moved;
  result.ranges.resize(sizes.size());
  for (std::size_t b = 0; b < sizes.size(); ++b) {
    std::vector<Range>& ranges = result.ranges[b];
    if (sizes[b]) ranges = aligned_difference(joined(std::move(unused[b])), joined(std::move(used[b])));
    if (result.bytes_of(b) > 0 && result.bytes_of(b) == sizes[b]) {
      // The only range is the whole buffer. Its first bytes must stay, because glTF has no empty buffers.
      ranges.front().begin = kRangeAlignment;
      if (ranges.front().begin == ranges.front().end) ranges.clear();
    }
    moved.emplace_back(ranges);
  }
  if (result.bytes() == 0) return {};
  const auto set = [&](const std::string& pointer, std::size_t offset, std::size_t now) {
    if (now != offset) result.changes.emplace_back(pointer, std::to_string(now));
  };
  for (std::size_t v = 0; v < model.views.size(); ++v) {
    const BufferView& view = model.views[v];
    const std::string pointer = "/bufferViews/" + std::to_string(v);
    if (is_unused[v] && !is_used[v] && !result.ranges[view.buffer].empty()) {
      result.view_offsets.push_back(0);
      result.changes.emplace_back(pointer, R"({"buffer":)" + std::to_string(view.buffer) + R"(,"byteLength":1})");
      continue;
    }
    const std::size_t begin = moved[view.buffer](view.offset);
    result.view_offsets.push_back(begin);
    set(pointer + "/byteOffset", view.offset, begin);
    set(pointer + "/byteLength", view.length, moved[view.buffer](view.offset + view.length) - begin);
  }
  const auto set_part = [&](const std::string& pointer, const Part& part) {
    const BufferView& view = model.views[part.view];
    const Moved& in_buffer = moved[view.buffer];
    set(pointer, part.offset, in_buffer(view.offset + part.offset) - in_buffer(view.offset));
  };
  auto next = unused_accessors.begin();
  for (std::size_t a = 0; a < count; ++a) {
    const std::string pointer = "/accessors/" + std::to_string(a);
    if (next != unused_accessors.end() && *next == a) {
      ++next;
      result.changes.emplace_back(pointer, R"({"componentType":5121,"count":1,"type":"SCALAR"})");
      continue;
    }
    auto part = parts[a].begin();
    if (model.accessors[a].view) set_part(pointer + "/byteOffset", *part++);
    if (!model.accessors[a].sparse) continue;
    set_part(pointer + "/sparse/indices/byteOffset", *part++);
    set_part(pointer + "/sparse/values/byteOffset", *part);
  }
  return result;
}

}  // namespace chronormal::inline internal::gltf
