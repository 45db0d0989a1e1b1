#include "io/gltf/decode/gltf_draco.h"

#include <cmath>
#include <cstdint>
#include <exception>
#include <memory>
#include <optional>
#include <utility>

// Turns off compiler warnings that the headers of the Draco library cause.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wpedantic"
#include <draco/compression/decode.h>
#include <draco/compression/point_cloud/point_cloud_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/metadata/metadata_decoder.h>
#pragma GCC diagnostic pop

#include "core/text.h"
#include "io/gltf/decode/gltf_bytes.h"

namespace chronormal::inline internal::gltf {
namespace {

draco::DataType data_type(Component component) {
  switch (component) {
    case Component::kInt8:
      return draco::DT_INT8;
    case Component::kUint8:
      return draco::DT_UINT8;
    case Component::kInt16:
      return draco::DT_INT16;
    case Component::kUint16:
      return draco::DT_UINT16;
    case Component::kUint32:
      return draco::DT_UINT32;
    case Component::kFloat:
      return draco::DT_FLOAT32;
  }
  return draco::DT_INVALID;
}

// Copies the values of an attribute to floats. The conversion of the library is not used, because the library believes
// flags in the file without a check.
Status read_attribute(const draco::Mesh& mesh, std::size_t id, const Accessor& accessor, const std::string& place,
                      std::vector<float>& result) {
  const draco::PointAttribute* const attribute = mesh.GetAttributeByUniqueId(static_cast<std::uint32_t>(id));
  const std::size_t components = accessor.components, size = component_size(accessor.component);
  if (attribute == nullptr || attribute->buffer() == nullptr ||
      static_cast<std::size_t>(attribute->num_components()) != components ||
      attribute->data_type() != data_type(accessor.component) ||
      (!attribute->is_mapping_identity() && attribute->indices_map_size() < mesh.num_points()))
    return invalid_input(place, "the Draco data lack an attribute that the primitive declares; export the file again");
  const auto offset = static_cast<std::uint64_t>(attribute->byte_offset());
  const auto stride = static_cast<std::uint64_t>(attribute->byte_stride());
  const std::size_t available = attribute->buffer()->data_size();
  result.resize(std::size_t{mesh.num_points()} * components);
  for (std::uint32_t v = 0; v < mesh.num_points(); ++v) {
    // The index has 32 bits, so its product with a stride of at most the size of the buffer cannot overflow.
    const std::uint64_t value = attribute->mapped_index(draco::PointIndex(v)).value();
    bool ok = stride <= available && offset <= available && value * stride + components * size <= available - offset;
    const char* const at =
        reinterpret_cast<const char*>(attribute->buffer()->data()) + (ok ? offset + value * stride : 0);
    for (std::size_t c = 0; ok && c < components; ++c) {
      const double number = load_number(at + c * size, accessor.component, accessor.normalized);
      ok = std::isfinite(number);
      result[v * components + c] = static_cast<float>(number);
    }
    if (!ok)
      return invalid_input(place,
                           "vertex " + std::to_string(v) + " of the Draco data is damaged; export the file again");
  }
  return Success{};
}

// Returns the number of faces that a compressed mesh declares, or nothing if this number cannot be determined. The
// caller checks the number first, because the library allocates memory for the faces before it reads any of them.
std::optional<std::uint32_t> declared_faces(draco::DecoderBuffer buffer) {
  draco::DracoHeader header;
  if (!draco::PointCloudDecoder::DecodeHeader(&buffer, &header).ok()) return std::nullopt;
  const auto version = static_cast<std::uint16_t>(DRACO_BITSTREAM_VERSION(header.version_major, header.version_minor));
  buffer.set_bitstream_version(version);
  draco::GeometryMetadata metadata;
  if ((header.flags & METADATA_FLAG_MASK) != 0 && !draco::MetadataDecoder().DecodeGeometryMetadata(&buffer, &metadata))
    return std::nullopt;
  const auto count = [&](bool is_varint) {
    std::uint32_t number = 0;
    const bool ok = is_varint ? draco::DecodeVarint(&number, &buffer) : buffer.Decode(&number);
    return ok ? std::optional(number) : std::nullopt;
  };
  if (header.encoder_method == draco::MESH_SEQUENTIAL_ENCODING) return count(version >= DRACO_BITSTREAM_VERSION(2, 2));
  // The header has the method of traversal, the number of new vertices (in versions up to 2.1), the number of vertices,
  // and then the number of faces.
  const bool is_varint = version >= DRACO_BITSTREAM_VERSION(2, 0);
  std::uint8_t traversal = 0;
  if (!buffer.Decode(&traversal)) return std::nullopt;
  if (version < DRACO_BITSTREAM_VERSION(2, 2) && !count(is_varint)) return std::nullopt;
  return count(is_varint) ? count(is_varint) : std::nullopt;
}

// Decodes a mesh, which must have the number of vertices that its accessors declare.
Result<std::unique_ptr<draco::Mesh>> decode_mesh(std::string_view bytes, std::size_t vertex_count,
                                                 const Expansion& expansion, const std::string& place) {
  constexpr std::uint64_t kBytesPerFace = 64;  // memory for the tables of the library and for our own
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  std::unique_ptr<draco::Mesh> mesh;
  std::string reason = "there is no triangle mesh in them";
  try {
    if (const auto faces = declared_faces(buffer)) {
      if (Status status = expansion.check(kBytesPerFace * *faces, place); !status) return status.error();
    }
    const auto type = draco::Decoder::GetEncodedGeometryType(&buffer);
    if (type.ok() && type.value() == draco::TRIANGULAR_MESH) {
      draco::Decoder decoder;
      auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
      if (decoded.ok())
        mesh = std::move(decoded).value();
      else
        reason = decoded.status().error_msg_string();
    }
    // The library throws if it trusts a wrong length in the file.
  } catch (const std::exception& exception) {
    reason = exception.what();
  }
  if (!mesh)
    return invalid_input(
        place,
        std::string("the Draco data cannot be decoded; export the file again. The decoder says: ").append(reason));
  if (mesh->num_points() != vertex_count)
    return invalid_input(place, "the Draco data have " + counted(mesh->num_points(), "vertex", "vertices") +
                                    ", but the accessors declare " + grouped(vertex_count) + "; export the file again");
  return mesh;
}

}  // namespace

Result<GltfGeometry> decode_draco(std::string_view bytes, const Model& model, const PrimitiveSource& source,
                                  bool with_shading, const Expansion& expansion, const std::string& place) {
  const std::size_t vertex_count = model.accessors[*source.base.position].count;
  const Result<std::unique_ptr<draco::Mesh>> decoded = decode_mesh(bytes, vertex_count, expansion, place);
  if (!decoded) return decoded.error();
  const draco::Mesh& mesh = *decoded.value();
  GltfGeometry geometry;
  geometry.corners.reserve(std::size_t{3} * mesh.num_faces());
  for (std::uint32_t f = 0; f < mesh.num_faces(); ++f) {
    for (const draco::PointIndex& corner : mesh.face(draco::FaceIndex(f))) {
      if (corner.value() >= vertex_count)
        return invalid_input(place, "face " + std::to_string(f) + " of the Draco data refers to vertex " +
                                        std::to_string(corner.value()) +
                                        ", which does not exist; export the file again");
      geometry.corners.push_back(corner.value());
    }
  }
  const Attributes& ids = source.draco->attributes;
  const auto read = [&](const std::optional<std::size_t>& id, const std::optional<std::size_t>& accessor,
                        std::vector<float>& result) -> Status {
    if (!id || !accessor) return Success{};
    return read_attribute(mesh, *id, model.accessors[*accessor], place, result);
  };
  if (Status status = read(ids.position, source.base.position, geometry.positions); !status) return status.error();
  if (!with_shading) return geometry;
  if (Status status = read(ids.normal, source.base.normal, geometry.normals); !status) return status.error();
  if (Status status = read(ids.tangent, source.base.tangent, geometry.tangents); !status) return status.error();
  return geometry;
}

Result<std::vector<std::vector<float>>> decode_draco_attributes(
    std::string_view bytes, const Model& model, std::size_t vertex_count, std::span<const AttributeSource> attributes,
    const Expansion& expansion, const std::string& place, const std::function<std::string(std::size_t n)>& place_of) {
  const Result<std::unique_ptr<draco::Mesh>> mesh = decode_mesh(bytes, vertex_count, expansion, place);
  if (!mesh) return mesh.error();
  std::vector<std::vector<float>> result(attributes.size());
  for (std::size_t n = 0; n < attributes.size(); ++n) {
    const auto& [accessor, id] = attributes[n];
    if (const Status status = read_attribute(*mesh.value(), *id, model.accessors[accessor], place_of(n), result[n]);
        !status)
      return status.error();
  }
  return result;
}

}  // namespace chronormal::inline internal::gltf
