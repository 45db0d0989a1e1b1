/// Makes glTF files in memory, piece by piece, without chronormal's reader. For example, a quad with one target:
///
///     GltfBuilder builder;
///     const auto base = builder.add_positions({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
///     const auto lift = builder.add_positions({0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0});
///     const auto corners = builder.add_indices<std::uint8_t>({0, 1, 2, 0, 2, 3});
///     const auto mesh = builder.add_mesh(GltfBuilder::primitive(base, corners, {{{"POSITION", lift}}}));
///     builder.glb();
///
/// Tests change everything else through the public members json and buffer. They can therefore make invalid files, too.
#ifndef CHRONORMAL_TESTS_SUPPORT_GLTF_BUILDER_H_
#define CHRONORMAL_TESTS_SUPPORT_GLTF_BUILDER_H_

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "chronormal/io/gltf_document.h"

namespace chronormal::test {

/// Returns the bytes of some numbers as they are in memory. All machines that run the tests are little-endian, like
/// glTF.
template <class T>
[[nodiscard]] std::string bytes_of(const std::vector<T>& values) {
  std::string bytes(values.size() * sizeof(T), '\0');
  if (!values.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

[[nodiscard]] inline std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : kDigits[bits >> (18 - 6 * k) & 63U];
  }
  return text;
}

/// Makes a GLB file with two chunks, `json` and `bin`, and the required padding. If `bin` has no value, the file has no
/// second chunk.
[[nodiscard]] inline std::string glb_bytes(std::string json, std::optional<std::string> bin) {
  const auto word = [](std::size_t value) {
    return bytes_of(std::vector<std::uint32_t>{static_cast<std::uint32_t>(value)});
  };
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string body = word(json.size()) + "JSON" + json;
  if (bin) {
    bin->resize((bin->size() + 3) / 4 * 4, '\0');
    body += word(bin->size()) + std::string("BIN\0", 4) + *bin;
  }
  return "glTF" + word(2) + word(12 + body.size()) + body;
}

class GltfBuilder {
 public:
  using Json = nlohmann::json;

  Json json = {{"asset", {{"version", "2.0"}}}};
  std::string buffer;  ///< the bytes of buffer 0

  /// Adds a buffer view with new bytes, which begin at a multiple of four in the buffer. Returns the index of the view.
  std::size_t add_view(std::string_view bytes, std::size_t stride = 0) {
    buffer.resize((buffer.size() + 3) / 4 * 4, '\0');
    Json view = {{"buffer", 0}, {"byteOffset", buffer.size()}, {"byteLength", bytes.size()}};
    if (stride > 0) view["byteStride"] = stride;
    buffer += bytes;
    return add("bufferViews", std::move(view));
  }

  /// Adds an accessor with its own buffer view, in which the elements are packed without gaps. Returns the index of the
  /// accessor.
  template <class T>
  std::size_t add_accessor(const char* type, const std::vector<T>& values, bool normalized = false) {
    return add_accessor_over(add_view(bytes_of(values)), type, component_type<T>(), values.size() / components(type),
                             normalized);
  }
  std::size_t add_accessor_over(std::optional<std::size_t> view, const char* type, int component_type,
                                std::size_t count, bool normalized = false) {
    Json accessor = {{"componentType", component_type}, {"count", count}, {"type", type}};
    if (view) accessor["bufferView"] = *view;
    if (normalized) accessor["normalized"] = true;
    return add("accessors", std::move(accessor));
  }
  std::size_t add_positions(const std::vector<float>& values) { return add_accessor("VEC3", values); }
  template <class T>
  std::size_t add_indices(const std::vector<T>& values) {
    return add_accessor("SCALAR", values);
  }
  /// Adds an accessor in which an element begins every `stride` bytes. The gaps between the elements are filled with
  /// 0xEE.
  template <class T>
  std::size_t add_strided(const char* type, const std::vector<T>& values, std::size_t stride, bool normalized = false) {
    const std::size_t size = components(type) * sizeof(T), count = values.size() / components(type);
    const std::string packed = bytes_of(values);
    std::string bytes(count * stride, '\xEE');
    for (std::size_t i = 0; i < count; ++i) bytes.replace(i * stride, size, packed, i * size, size);
    return add_accessor_over(add_view(bytes, stride), type, component_type<T>(), count, normalized);
  }
  /// Replaces some elements of an accessor that add_accessor_over() has made, by sparse arrays of indices and values.
  template <class I, class T>
  void make_sparse(std::size_t accessor, const std::vector<I>& indices, const std::vector<T>& values) {
    const std::size_t index_view = add_view(bytes_of(indices)), value_view = add_view(bytes_of(values));
    json["accessors"][accessor]["sparse"] = {
        {"count", indices.size()},
        {"indices", {{"bufferView", index_view}, {"componentType", component_type<I>()}}},
        {"values", {{"bufferView", value_view}}}};
  }

  [[nodiscard]] static Json primitive(std::size_t positions, std::optional<std::size_t> indices = std::nullopt,
                                      const std::vector<Json>& targets = {}, int mode = 4) {
    Json primitive = {{"attributes", {{"POSITION", positions}}}};
    if (indices) primitive["indices"] = *indices;
    if (!targets.empty()) primitive["targets"] = targets;
    if (mode != 4) primitive["mode"] = mode;
    return primitive;
  }
  std::size_t add_mesh(Json primitive, Json extra = Json::object()) {
    extra["primitives"] = Json::array({std::move(primitive)});
    return add("meshes", std::move(extra));
  }
  void add_primitive(std::size_t mesh, Json primitive) {
    json["meshes"][mesh]["primitives"].push_back(std::move(primitive));
  }
  std::size_t add_node(std::size_t mesh, Json extra = Json::object()) {
    extra["mesh"] = mesh;
    return add("nodes", std::move(extra));
  }

  std::size_t add_animation(const std::string& name) {
    Json animation = {{"channels", Json::array()}, {"samplers", Json::array()}};
    if (!name.empty()) animation["name"] = name;
    return add("animations", std::move(animation));
  }
  /// Adds a channel to an animation. The channel drives the weights of a node.
  template <class T>
  void add_track(std::size_t animation, std::size_t node, const std::vector<float>& times, const std::vector<T>& values,
                 const char* interpolation = "LINEAR") {
    const std::size_t input = add_accessor("SCALAR", times);
    const std::size_t output = add_accessor("SCALAR", values, !std::is_same_v<T, float>);
    Json& target = json["animations"][animation];
    const std::size_t sampler = target["samplers"].size();
    target["samplers"].push_back({{"input", input}, {"output", output}, {"interpolation", interpolation}});
    target["channels"].push_back({{"sampler", sampler}, {"target", {{"node", node}, {"path", "weights"}}}});
  }

  /// Returns the document as a .gltf file in which buffer 0 is embedded as base64.
  [[nodiscard]] std::string gltf() const {
    return gltf_with_uri("data:application/octet-stream;base64," + base64(buffer));
  }
  /// Returns the document as a .gltf file in which buffer 0 is a separate file with the given URI.
  [[nodiscard]] std::string gltf_with_uri(const std::string& uri) const { return with_buffer(uri).dump(); }
  [[nodiscard]] std::string glb() const { return glb_bytes(with_buffer(std::nullopt).dump(), buffer); }

  std::size_t add(const char* list, Json item) {
    Json& items = json[list];
    items.push_back(std::move(item));
    return items.size() - 1;
  }

  template <class T>
  [[nodiscard]] static constexpr int component_type() {
    if constexpr (std::is_same_v<T, std::int8_t>) return 5120;
    if constexpr (std::is_same_v<T, std::uint8_t>) return 5121;
    if constexpr (std::is_same_v<T, std::int16_t>) return 5122;
    if constexpr (std::is_same_v<T, std::uint16_t>) return 5123;
    if constexpr (std::is_same_v<T, std::uint32_t>) return 5125;
    if constexpr (std::is_same_v<T, float>) return 5126;
  }

 private:
  [[nodiscard]] static std::size_t components(std::string_view type) {
    return type == "SCALAR" ? 1 : static_cast<std::size_t>(type.back() - '0');
  }
  // Returns the JSON with the length and the URI of buffer 0. If a test has added buffers to the JSON, the first of
  // these buffers is buffer 0, and the other buffers are kept.
  [[nodiscard]] Json with_buffer(const std::optional<std::string>& uri) const {
    Json document = json;
    if (buffer.empty()) return document;
    Json first = {{"byteLength", buffer.size()}};
    if (uri) first["uri"] = *uri;
    if (!document.contains("buffers")) document["buffers"] = Json::array({Json::object()});
    document["buffers"][0].update(first);
    return document;
  }
};

/// A document together with the bytes from which it is read. By default, the reader is strict: notes
/// (gltf_notes_test.cpp) are errors.
class GltfFixture {
 public:
  explicit GltfFixture(std::string bytes, const std::optional<std::string>& folder = std::nullopt,
                       const GltfOptions& options = GltfOptions{.strict = true})
      : bytes_(std::move(bytes)), document_(GltfDocument::read(bytes_, "a.gltf", folder, options)) {}
  explicit GltfFixture(const GltfBuilder& builder) : GltfFixture(builder.glb()) {}
  GltfFixture(const GltfFixture&) = delete;
  GltfFixture& operator=(const GltfFixture&) = delete;

  [[nodiscard]] bool ok() const { return document_.ok(); }
  [[nodiscard]] std::string error() const { return ok() ? "" : document_.error().text(); }
  [[nodiscard]] const Result<GltfDocument>& result() const { return document_; }
  [[nodiscard]] const GltfDocument& operator*() const { return document_.value(); }
  [[nodiscard]] const GltfDocument* operator->() const { return &document_.value(); }

 private:
  std::string bytes_;
  Result<GltfDocument> document_;
};

// A quad that is not planar (positions and triangles), and the position deltas of two targets. All numbers are exact in
// float32.
inline const std::vector<float> kQuad = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0.5F};
inline const std::vector<std::uint16_t> kQuadCorners = {0, 1, 2, 0, 2, 3};
inline const std::vector<float> kLift = {0, 0, 1, 0, 0, -1, 0, 0, 2, 0.5F, 0, 0};
inline const std::vector<float> kShift = {0.25F, 0, 0, 0, -0.5F, 0, 0, 0, 0, 0, 0.125F, 4};

/// Makes a document with a node and a mesh: the quad with its two targets. The accessors are 0 the base, 1 the corners,
/// 2 and 3 the targets.
[[nodiscard]] inline GltfBuilder quad_document() {
  GltfBuilder builder;
  const std::size_t base = builder.add_positions(kQuad), corners = builder.add_indices(kQuadCorners);
  const std::size_t lift = builder.add_positions(kLift), shift = builder.add_positions(kShift);
  const std::size_t mesh = builder.add_mesh(
      GltfBuilder::primitive(base, corners, {{{"POSITION", lift}}, {{"POSITION", shift}}}), {{"name", "quad"}});
  builder.add_node(mesh, {{"name", "node"}});
  return builder;
}

/// Returns the morphed positions base + weights[0] targets[0] + weights[1] targets[1] + ..., computed in double.
[[nodiscard]] inline std::vector<double> morphed(const std::vector<float>& base,
                                                 const std::vector<std::vector<float>>& targets,
                                                 const std::vector<double>& weights) {
  std::vector<double> result(base.begin(), base.end());
  for (std::size_t k = 0; k < targets.size(); ++k) {
    for (std::size_t i = 0; i < targets[k].size(); ++i) result[i] += weights[k] * static_cast<double>(targets[k][i]);
  }
  return result;
}

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_GLTF_BUILDER_H_
