/// The JSON of a glTF file as structs whose references have been checked, so that readers of the bytes can rely on
/// them. Private to io.
///
/// The public half of the structs (meshes, nodes, animations) is in chronormal/io/gltf_document.h. This half has the
/// places of the arrays. A buffer view is checked against its buffer. An accessor that a primitive or a sampler names
/// is checked against its buffer view; other accessors only have to be well-formed.
#ifndef CHRONORMAL_IO_GLTF_MODEL_GLTF_MODEL_H_
#define CHRONORMAL_IO_GLTF_MODEL_GLTF_MODEL_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/io/gltf_document.h"

namespace chronormal::inline internal::gltf {

/// The type of a component, with the numbers that glTF uses.
enum class Component { kInt8 = 5120, kUint8 = 5121, kInt16 = 5122, kUint16 = 5123, kUint32 = 5125, kFloat = 5126 };

[[nodiscard]] constexpr std::size_t component_size(Component component) noexcept {
  if (component == Component::kInt8 || component == Component::kUint8) return 1;
  return component == Component::kInt16 || component == Component::kUint16 ? 2 : 4;
}

struct Buffer {
  std::optional<std::string> uri;
  std::size_t byte_length = 0;
};

/// The compressed bytes of a buffer view, as EXT_meshopt_compression describes them.
struct Compression {
  enum class Mode { kAttributes, kTriangles, kIndices };
  enum class Filter { kNone, kOctahedral, kQuaternion, kExponential };

  std::size_t buffer = 0, offset = 0, length = 0;  ///< buffer, offset and length of the compressed bytes
  std::size_t stride = 0, count = 0;               ///< size of an element in bytes, and number of elements
  /// True for KHR_meshopt_compression. The compressed bytes may then have a later version than our decoder understands.
  bool is_khr = false;
  Mode mode = Mode::kAttributes;
  Filter filter = Filter::kNone;
};

struct BufferView {
  std::size_t buffer = 0, offset = 0, length = 0;
  std::optional<std::size_t> stride;
  std::optional<Compression> compression;
  /// reason why the view cannot be read; becomes an error only when the view is needed
  std::optional<Error> fault = {};
};

struct Sparse {
  std::size_t count = 0;
  std::size_t indices_view = 0, indices_offset = 0;
  Component indices_component = Component::kUint16;
  std::size_t values_view = 0, values_offset = 0;
};

struct Accessor {
  std::optional<std::size_t> view;  ///< no value if all numbers are 0
  std::size_t offset = 0, count = 0;
  Component component = Component::kFloat;
  std::size_t components = 1;  ///< numbers in an element: 1 for SCALAR, 3 for VEC3
  bool is_matrix = false, normalized = false;
  std::optional<Sparse> sparse;
  /// reason why the accessor cannot be read; becomes an error only when the accessor is needed
  std::optional<Error> fault = {};

  [[nodiscard]] std::size_t element_size() const noexcept { return components * component_size(component); }
};

/// The indices of the accessors of a primitive's attributes.
struct Attributes {
  std::optional<std::size_t> position, normal, tangent;
};

/// The compressed data of a primitive, as KHR_draco_mesh_compression describes them. `attributes` has ids in the
/// compressed mesh.
struct Draco {
  std::size_t view = 0;
  Attributes attributes;
};

/// The accessor of an attribute of a primitive, and the id of the attribute in a compressed mesh.
struct AttributeSource {
  std::size_t accessor = 0;
  std::optional<std::size_t> draco = {};  ///< id of the attribute in the compressed mesh, if the mesh contains it
};

/// The attributes JOINTS_n and WEIGHTS_n of a primitive, for one n.
struct InfluenceSource {
  AttributeSource joints, weights;
};

struct PrimitiveSource {
  Attributes base;
  std::optional<std::size_t> indices;
  std::vector<Attributes> targets;
  std::optional<Draco> draco;
  std::vector<InfluenceSource> influences = {};
  std::optional<Error> influence_fault = {};  ///< reason why the influences cannot be read
};

struct SkinSource {
  std::vector<std::uint32_t> joints;         ///< indices of nodes
  std::optional<std::size_t> inverse_binds;  ///< index of an accessor
  std::optional<Error> fault;                ///< why the skin cannot be read
};

/// A channel of an animation that drives a single weight.
struct ElementSource {
  std::size_t target = 0, input = 0, output = 0;  ///< input and output are accessors
  GltfInterpolation interpolation = GltfInterpolation::kLinear;

  friend bool operator==(const ElementSource&, const ElementSource&) = default;
};

struct TrackSource {
  std::size_t sampler = 0, input = 0, output = 0;  ///< input and output are accessors
  /// The channels of single weights, in the order of targets, if the track consists of such channels. In this case,
  /// `input` and `output` above belong to the first channel, and weights without a channel keep their value in `rest`.
  std::vector<ElementSource> elements = {};
  std::vector<double> rest = {};
};

/// A channel of an animation that moves, turns or scales a node.
struct NodeChannel {
  enum class Path { kTranslation, kRotation, kScale };

  std::uint32_t node = 0;
  Path path = Path::kTranslation;
  GltfInterpolation interpolation = GltfInterpolation::kLinear;
  std::size_t input = 0, output = 0;  ///< indices of accessors
};

/// The channels of one animation that move nodes. Such channels are read only in files that have skins.
struct NodeChannels {
  std::vector<NodeChannel> channels;
  std::optional<Error> fault;  ///< reason why the channels cannot be read
};

/// The transform of a node relative to its parent: as a matrix, or as separate parts that animations can move.
using Placement = std::variant<AffineTransform, NodeTransform>;

struct Model {
  std::vector<Buffer> buffers;
  std::vector<BufferView> views;
  std::vector<Accessor> accessors;
  std::vector<GltfMesh> meshes;
  std::vector<std::vector<PrimitiveSource>> sources;  ///< sources[m][p] belongs to meshes[m].primitives[p]
  std::vector<GltfNode> nodes;
  std::vector<std::pair<std::size_t, Placement>> placements;  ///< the nodes that have a placement, in ascending order
  std::vector<SkinSource> skins;
  std::vector<GltfAnimation> animations;
  std::vector<std::vector<TrackSource>> track_sources;  ///< track_sources[a][t] belongs to animations[a].tracks[t]
  std::vector<NodeChannels> node_channels;              ///< one for each animation
  std::vector<std::string> extensions;
  std::vector<Error> notes;  ///< faults of parts on which no other part depends
};

/// Returns the transform of a node relative to its parent, as the file gives it, without animation. O(log nodes).
[[nodiscard]] Placement placement_of(const Model& model, std::size_t node) noexcept;
[[nodiscard]] AffineTransform transform_of(const Placement& placement) noexcept;

[[nodiscard]] std::string primitive_pointer(std::size_t mesh, std::size_t primitive);

/// Parses a document, whose JSON begins at byte `offset` of the file. file_bytes is the size of the file, which limits
/// the number of elements of an accessor without a buffer view. A fault in a part on which no other part depends
/// becomes a note of the model, or an error if is_strict is true. Errors: kInvalidInput, with the name and a JSON
/// pointer as the place, or with the name and a byte offset if the text is not JSON.
[[nodiscard]] Result<Model> parse_model(std::string_view json, const std::string& name, std::size_t offset,
                                        std::size_t file_bytes, bool is_strict);

}  // namespace chronormal::inline internal::gltf

#endif  // CHRONORMAL_IO_GLTF_MODEL_GLTF_MODEL_H_
