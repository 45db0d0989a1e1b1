/// The JSON of a glTF file as structs whose references were checked, and by which its bytes are read. Private to io.
///
/// The public half (meshes, nodes, animations) is in chronormal/io/gltf_document.h; this half has the places of their
/// arrays. Parts that are read are checked: a buffer view against its buffer, and an accessor that a primitive or a
/// sampler names against its buffer view; other accessors only have to be well-formed.
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

/// A buffer view that EXT_meshopt_compression compresses.
struct Compression {
  enum class Mode { kAttributes, kTriangles, kIndices };
  enum class Filter { kNone, kOctahedral, kQuaternion, kExponential };

  std::size_t buffer = 0, offset = 0, length = 0;  ///< the compressed bytes
  std::size_t stride = 0, count = 0;               ///< the elements
  /// True for KHR_meshopt_compression, whose bytes may have a later version than can be decoded.
  bool is_khr = false;
  Mode mode = Mode::kAttributes;
  Filter filter = Filter::kNone;
};

struct BufferView {
  std::size_t buffer = 0, offset = 0, length = 0;
  std::optional<std::size_t> stride;
  std::optional<Compression> compression;
  std::optional<Error> fault = {};  ///< reason why it cannot be read; becomes an error only when it is needed
};

struct Sparse {
  std::size_t count = 0;
  std::size_t indices_view = 0, indices_offset = 0;
  Component indices_component = Component::kUint16;
  std::size_t values_view = 0, values_offset = 0;
};

struct Accessor {
  std::optional<std::size_t> view;  ///< none for all zeros
  std::size_t offset = 0, count = 0;
  Component component = Component::kFloat;
  std::size_t components = 1;  ///< numbers in an element: 1 for SCALAR, 3 for VEC3
  bool is_matrix = false, normalized = false;
  std::optional<Sparse> sparse;
  std::optional<Error> fault = {};  ///< reason why it cannot be read; becomes an error only when it is needed

  [[nodiscard]] std::size_t element_size() const noexcept { return components * component_size(component); }
};

/// The accessors of a primitive's attributes, by index.
struct Attributes {
  std::optional<std::size_t> position, normal, tangent;
};

/// A primitive that KHR_draco_mesh_compression compresses. `attributes` has ids in the compressed mesh.
struct Draco {
  std::size_t view = 0;
  Attributes attributes;
};

/// An attribute of a primitive.
struct AttributeSource {
  std::size_t accessor = 0;
  std::optional<std::size_t> draco = {};  ///< its id in the compressed mesh, if that contains it
};

/// A set of JOINTS_n and WEIGHTS_n.
struct InfluenceSource {
  AttributeSource joints, weights;
};

struct PrimitiveSource {
  Attributes base;
  std::optional<std::size_t> indices;
  std::vector<Attributes> targets;
  std::optional<Draco> draco;
  std::vector<InfluenceSource> influences = {};
  std::optional<Error> influence_fault = {};  ///< why they cannot be read
};

struct SkinSource {
  std::vector<std::uint32_t> joints;         ///< nodes
  std::optional<std::size_t> inverse_binds;  ///< an accessor
  std::optional<Error> fault;                ///< why the skin cannot be read
};

/// A channel that drives a single weight.
struct ElementSource {
  std::size_t target = 0, input = 0, output = 0;  ///< input, output: accessors
  GltfInterpolation interpolation = GltfInterpolation::kLinear;

  friend bool operator==(const ElementSource&, const ElementSource&) = default;
};

struct TrackSource {
  std::size_t sampler = 0, input = 0, output = 0;  ///< input, output: accessors
  /// The channels of single weights, in the order of targets, if the track consists of such channels. Then `input` and
  /// `output` above belong to the first channel. Weights without a channel keep their value in `rest`.
  std::vector<ElementSource> elements = {};
  std::vector<double> rest = {};
};

/// A channel that moves a node.
struct NodeChannel {
  enum class Path { kTranslation, kRotation, kScale };

  std::uint32_t node = 0;
  Path path = Path::kTranslation;
  GltfInterpolation interpolation = GltfInterpolation::kLinear;
  std::size_t input = 0, output = 0;  ///< accessors
};

/// The channels of one animation that move nodes. They are read only in files that have skins.
struct NodeChannels {
  std::vector<NodeChannel> channels;
  std::optional<Error> fault;  ///< why they cannot be read
};

/// The transform of a node relative to its parent: as a matrix, or as separate parts that animations can move.
using Placement = std::variant<AffineTransform, NodeTransform>;

struct Model {
  std::vector<Buffer> buffers;
  std::vector<BufferView> views;
  std::vector<Accessor> accessors;
  std::vector<GltfMesh> meshes;
  std::vector<std::vector<PrimitiveSource>> sources;  ///< beside meshes[m].primitives
  std::vector<GltfNode> nodes;
  std::vector<std::pair<std::size_t, Placement>> placements;  ///< nodes with a placement, in order
  std::vector<SkinSource> skins;
  std::vector<GltfAnimation> animations;
  std::vector<std::vector<TrackSource>> track_sources;  ///< beside animations[a].tracks
  std::vector<NodeChannels> node_channels;              ///< beside animations
  std::vector<std::string> extensions;
  std::vector<Error> notes;  ///< faults of parts that no other part needs
};

/// Returns the transform of a node relative to its parent, without animation. O(log nodes).
[[nodiscard]] Placement placement_of(const Model& model, std::size_t node) noexcept;
/// Returns a placement as a transform.
[[nodiscard]] AffineTransform transform_of(const Placement& placement) noexcept;

/// Returns the JSON pointer of a primitive.
[[nodiscard]] std::string primitive_pointer(std::size_t mesh, std::size_t primitive);

/// Parses a document, whose JSON begins at byte `offset` of the file. file_bytes is the size of the file, which limits
/// the elements of an accessor without a buffer view. A fault in a part that no other part needs becomes a note of the
/// model, or an error if is_strict. Errors: kInvalidInput, with the name and a JSON pointer as the place, or the name
/// and a byte offset if the text is not JSON.
[[nodiscard]] Result<Model> parse_model(std::string_view json, const std::string& name, std::size_t offset,
                                        std::size_t file_bytes, bool is_strict);

}  // namespace chronormal::inline internal::gltf

#endif  // CHRONORMAL_IO_GLTF_MODEL_GLTF_MODEL_H_
