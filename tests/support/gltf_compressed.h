/// Makes compressed parts of glTF files with the encoders of meshoptimizer and Draco.
#ifndef CHRONORMAL_TESTS_SUPPORT_GLTF_COMPRESSED_H_
#define CHRONORMAL_TESTS_SUPPORT_GLTF_COMPRESSED_H_

#include <draco/compression/expert_encode.h>
#include <draco/mesh/mesh.h>
#include <meshoptimizer.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "tests/support/gltf_builder.h"

namespace chronormal::test {

/// Encodes vertex data by EXT_meshopt_compression in the mode ATTRIBUTES. `stride` is the number of bytes per element.
[[nodiscard]] inline std::string meshopt_attributes(const std::string& bytes, std::size_t stride) {
  const std::size_t count = bytes.size() / stride;
  std::vector<unsigned char> coded(meshopt_encodeVertexBufferBound(count, stride));
  meshopt_encodeVertexVersion(0);
  coded.resize(meshopt_encodeVertexBuffer(coded.data(), coded.size(), bytes.data(), count, stride));
  return {coded.begin(), coded.end()};
}

/// Encodes triangles by EXT_meshopt_compression in the mode TRIANGLES. The encoder may rotate the corners of a
/// triangle, but keeps the order of triangles.
[[nodiscard]] inline std::string meshopt_triangles(const std::vector<std::uint32_t>& corners, std::size_t vertices) {
  std::vector<unsigned char> coded(meshopt_encodeIndexBufferBound(corners.size(), vertices));
  meshopt_encodeIndexVersion(1);
  coded.resize(meshopt_encodeIndexBuffer(coded.data(), coded.size(), corners.data(), corners.size()));
  return {coded.begin(), coded.end()};
}

/// Encodes indices by EXT_meshopt_compression in the mode INDICES.
[[nodiscard]] inline std::string meshopt_indices(const std::vector<std::uint32_t>& indices, std::size_t vertices) {
  std::vector<unsigned char> coded(meshopt_encodeIndexSequenceBound(indices.size(), vertices));
  meshopt_encodeIndexVersion(1);
  coded.resize(meshopt_encodeIndexSequence(coded.data(), coded.size(), indices.data(), indices.size()));
  return {coded.begin(), coded.end()};
}

/// Adds a buffer view with `count` elements of `size` bytes that exist only in compressed form. The extension demands a
/// fallback buffer for the uncompressed bytes. The fallback buffer is buffer 1, and has no URI.
inline std::size_t add_meshopt_view(GltfBuilder& builder, const std::string& coded, std::size_t count, std::size_t size,
                                    const char* mode, const char* filter = nullptr) {
  builder.buffer.resize((builder.buffer.size() + 3) / 4 * 4, '\0');
  GltfBuilder::Json extension = {{"buffer", 0},
                                 {"byteOffset", builder.buffer.size()},
                                 {"byteLength", coded.size()},
                                 {"count", count},
                                 {"byteStride", size},
                                 {"mode", mode}};
  if (filter != nullptr) extension["filter"] = filter;
  builder.buffer += coded;

  GltfBuilder::Json& buffers = builder.json["buffers"];
  if (buffers.size() < 2)
    buffers = {GltfBuilder::Json::object(),
               {{"byteLength", 0}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}}};
  const std::size_t offset = (buffers[1]["byteLength"].get<std::size_t>() + 3) / 4 * 4;
  buffers[1]["byteLength"] = offset + count * size;
  GltfBuilder::Json view = {{"buffer", 1},
                            {"byteOffset", offset},
                            {"byteLength", count * size},
                            {"extensions", {{"EXT_meshopt_compression", std::move(extension)}}}};
  if (std::string_view(mode) == "ATTRIBUTES") view["byteStride"] = size;
  builder.json["extensionsUsed"] = builder.json["extensionsRequired"] = {"EXT_meshopt_compression"};
  return builder.add("bufferViews", std::move(view));
}

/// Adds a compressed buffer view of positions, without a filter, and an accessor. Returns the index of the accessor.
inline std::size_t add_meshopt_positions(GltfBuilder& builder, const std::vector<float>& positions) {
  const std::string coded = meshopt_attributes(bytes_of(positions), 12);
  const std::size_t count = positions.size() / 3;
  return builder.add_accessor_over(add_meshopt_view(builder, coded, count, 12, "ATTRIBUTES"), "VEC3", 5126, count);
}

enum class DracoOrder {
  kKept,
  kFree
};  ///< sequential encoding keeps the order of vertices and faces, edgebreaker does not

template <class T>
[[nodiscard]] constexpr draco::DataType draco_type() {
  if constexpr (std::is_same_v<T, std::int8_t>) return draco::DT_INT8;
  if constexpr (std::is_same_v<T, std::uint8_t>) return draco::DT_UINT8;
  if constexpr (std::is_same_v<T, std::int16_t>) return draco::DT_INT16;
  if constexpr (std::is_same_v<T, std::uint16_t>) return draco::DT_UINT16;
  if constexpr (std::is_same_v<T, float>) return draco::DT_FLOAT32;
}

/// The joints and weights of a skin, four for each vertex.
struct DracoShares {
  std::vector<std::uint8_t> joints = {};
  std::vector<float> weights = {};
};

/// Encodes a triangle mesh with Draco. The given attributes get the numbers 0, 1, ... in the order POSITION, NORMAL,
/// JOINTS, WEIGHTS. If `bits` is 0, the encoding is lossless. Otherwise, coordinates are rounded to the given number of
/// bits.
template <class T>
[[nodiscard]] std::string draco_mesh(const std::vector<T>& positions, const std::vector<std::uint32_t>& corners,
                                     DracoOrder order, const std::vector<float>& normals = {}, int bits = 0,
                                     const DracoShares& shares = {}) {
  draco::Mesh mesh;
  const auto vertex_count = static_cast<std::uint32_t>(positions.size() / 3);
  mesh.set_num_points(vertex_count);
  const auto add = [&](draco::GeometryAttribute::Type type, const auto& values) {
    using Value = typename std::decay_t<decltype(values)>::value_type;
    const std::size_t width = values.size() / vertex_count;
    draco::GeometryAttribute attribute;
    attribute.Init(type, nullptr, static_cast<std::uint8_t>(width), draco_type<Value>(), false,
                   static_cast<std::int64_t>(width * sizeof(Value)), 0);
    const int id = mesh.AddAttribute(attribute, true, vertex_count);
    for (std::uint32_t i = 0; i < vertex_count; ++i)
      mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i), &values[width * i]);
  };
  add(draco::GeometryAttribute::POSITION, positions);
  if (!normals.empty()) add(draco::GeometryAttribute::NORMAL, normals);
  if (!shares.joints.empty()) add(draco::GeometryAttribute::GENERIC, shares.joints);
  if (!shares.weights.empty()) add(draco::GeometryAttribute::GENERIC, shares.weights);
  mesh.SetNumFaces(corners.size() / 3);
  for (std::uint32_t f = 0; f < mesh.num_faces(); ++f) {
    draco::Mesh::Face face;
    for (std::uint32_t k = 0; k < 3; ++k) face[k] = draco::PointIndex(corners[3 * f + k]);
    mesh.SetFace(draco::FaceIndex(f), face);
  }

  draco::ExpertEncoder encoder(mesh);
  encoder.SetEncodingMethod(order == DracoOrder::kKept ? draco::MESH_SEQUENTIAL_ENCODING
                                                       : draco::MESH_EDGEBREAKER_ENCODING);
  if (bits > 0) encoder.SetAttributeQuantization(0, bits);
  draco::EncoderBuffer coded;
  if (!encoder.EncodeToBuffer(&coded).ok()) throw std::runtime_error("Draco did not encode the mesh");
  return {coded.data(), coded.size()};
}

/// Makes a primitive whose indices, positions and normals exist only in Draco's encoding. Targets are not compressed.
[[nodiscard]] inline GltfBuilder::Json draco_primitive(GltfBuilder& builder, const std::string& coded,
                                                       std::size_t vertex_count, std::size_t corner_count,
                                                       bool has_normals,
                                                       const std::vector<GltfBuilder::Json>& targets) {
  const std::size_t view = builder.add_view(coded);
  const std::size_t base = builder.add_accessor_over(std::nullopt, "VEC3", 5126, vertex_count);
  const std::size_t indices = builder.add_accessor_over(std::nullopt, "SCALAR", 5125, corner_count);
  GltfBuilder::Json primitive = GltfBuilder::primitive(base, indices, targets);
  GltfBuilder::Json attributes = {{"POSITION", 0}};
  if (has_normals) {
    primitive["attributes"]["NORMAL"] = builder.add_accessor_over(std::nullopt, "VEC3", 5126, vertex_count);
    attributes["NORMAL"] = 1;
  }
  primitive["extensions"] = {{"KHR_draco_mesh_compression", {{"bufferView", view}, {"attributes", attributes}}}};
  builder.json["extensionsUsed"] = builder.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  return primitive;
}

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_GLTF_COMPRESSED_H_
