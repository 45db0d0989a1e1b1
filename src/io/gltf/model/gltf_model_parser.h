/// The parser behind parse_model(), declared once for its source files. Private to io.
#ifndef CHRONORMAL_IO_GLTF_MODEL_GLTF_MODEL_PARSER_H_
#define CHRONORMAL_IO_GLTF_MODEL_GLTF_MODEL_PARSER_H_

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "io/gltf/model/gltf_model.h"
#include "io/json/json.h"

namespace chronormal::inline internal::gltf {

class Parser {
 public:
  Parser(const std::string& name, std::size_t file_bytes, bool is_strict)
      : complaint_(name), file_bytes_(file_bytes), is_strict_(is_strict) {}

  /// Parses a node. May be called before the document is complete.
  void parse_node(std::size_t index, const nlohmann::json& value);
  /// Parses all parts of the document except nodes, and checks the nodes against these parts.
  Result<Model> parse(const nlohmann::json& document);

 private:
  /// The use of an accessor, which decides the allowed types of its numbers.
  enum class Use {
    kPosition,
    kNormal,
    kTangent,
    kMovedPosition,
    kMovedNormal,
    kMovedTangent,
    kIndices,
    kTimes,
    kWeights,
    kJoints,  ///< joints of vertices, and their weights
    kJointWeights,
    kInverseBinds,
    kMovedNode,  ///< translations or scales of nodes over time
    kTurnedNode  ///< rotations of nodes over time
  };

  /// Parses a part whose faults matter only if other data need the part. Returns the first complaint of parse(), which
  /// then does not count as an error of the file.
  template <class Parse>
  std::optional<Error> fault_of(const Parse& parse) {
    if (complaint_.first()) return std::nullopt;
    parse();
    return complaint_.take();
  }

  /// Parses a part that may be skipped. If parse() complains, adds a note with the reason and returns false. Otherwise
  /// returns true.
  template <class Parse>
  bool understands(const Parse& parse) {
    if (complaint_.first()) return false;
    parse();
    if (!complaint_.first()) return true;
    if (!is_strict_) model_.notes.push_back(*complaint_.take());
    return false;
  }
  /// Adds a note that a part is skipped, with the reason `message`.
  void note(const JsonView& item, std::string message) {
    (void)understands([&] { item.complain(std::move(message)); });
  }

  template <class Parse>
  void for_each_item(const JsonView& root, const char* key, const Parse& parse) {
    const std::optional<JsonView> items = root.array(key);
    for (std::size_t i = 0; items && i < items->size() && !complaint_.first(); ++i) {
      if (const JsonView item = items->item(i); item.is_object()) parse(item);
    }
  }

  void parse_asset(const JsonView& root);
  /// Looks for extensions that the file requires but that are unknown. Complains about such an extension, or adds a
  /// note if the extension does not change the data that are read.
  void check_required(const JsonView& root);
  /// Adds notes on the faults of buffer views and accessors that are not used.
  void note_faults();
  /// Returns a flag for each node. The flag is true if the node or a node below it carries a mesh or is a joint of a
  /// skin.
  [[nodiscard]] std::vector<bool> nodes_that_place_meshes() const;
  void parse_buffer(const JsonView& item);
  void parse_view(const JsonView& item, BufferView& view);
  std::optional<Compression> parse_compression(const JsonView& item, const BufferView& view);
  void parse_accessor(const JsonView& item, Accessor& accessor);
  void parse_sparse(const JsonView& item, Accessor& accessor);
  void parse_transform(const JsonView& item, std::size_t index);
  void check_nodes(const JsonView& root);
  void connect_nodes();
  /// Gives each mesh without a mark of a bake the mark of a node that carries the mesh, or of the parent of such a
  /// node.
  void read_marks_of_nodes();
  /// Returns the member "weights" of a mesh or node, or an empty list if the member is missing.
  static std::vector<double> parse_weights(const JsonView& item);
  void check_weights(const std::string& pointer, const std::vector<double>& weights, std::size_t target_count);

  void parse_mesh(const JsonView& item);
  void parse_primitive(const JsonView& item, GltfMesh& mesh, std::vector<PrimitiveSource>& sources);
  std::optional<Draco> parse_draco(const JsonView& item, const JsonView& attributes);
  void parse_targets(const JsonView& item, GltfPrimitive& primitive, PrimitiveSource& source);
  /// Adds targets that move nothing to primitives that have fewer targets than other primitives of their mesh.
  void fill_targets(const JsonView& primitives, GltfMesh& mesh, std::vector<PrimitiveSource>& sources);
  /// Reads the attributes JOINTS_n and WEIGHTS_n of a primitive: joints and weights of vertices.
  void parse_influences(const JsonView& item, PrimitiveSource& source);
  void parse_skins();
  void parse_skin(const JsonView& item, SkinSource& skin);
  /// Returns the accessor that the member `key` names, after checking that the accessor fits its use. Returns nothing
  /// if there is no such member, or after a complaint.
  std::optional<std::size_t> parse_use(const JsonView& object, const char* key, Use use, bool compressed = false);
  void check_use(const JsonView& object, const char* key, std::size_t index, Use use, bool compressed);
  void check_inside_view(const JsonView& object, const char* key, std::size_t index, Use use);
  void check_sparse(const JsonView& object, const char* key, std::size_t index);
  /// Returns the buffer view of an accessor, and complains if the view cannot be read.
  const BufferView& view_of(std::size_t index);
  void check_unstrided(const JsonView& object, const char* key, const BufferView& view, const char* what);

  void parse_animation(const JsonView& item);
  /// Reads the channels of an animation that drive weights, and skips channels that cannot be understood.
  void parse_channels(const JsonView& item, GltfAnimation& animation, std::vector<TrackSource>& sources);
  /// The weights that a channel drives: all weights of some nodes, or only the weight `target`. The list of nodes is
  /// empty if the channel drives no weights.
  struct Driven {
    std::vector<std::size_t> nodes = {};
    std::optional<std::size_t> target = {};
  };
  /// Returns the weights to which a pointer of KHR_animation_pointer refers.
  Driven pointed_to(const JsonView& target);
  /// A channel that drives a single weight: the index of the channel, and of the target whose weight it is.
  struct LoneWeight {
    std::size_t channel = 0, target = 0;
  };
  /// Lists a channel that drives all weights of nodes, but that cannot be read, in `result.unread`.
  void keep_unread(const JsonView& animation, std::size_t channel_index, const Driven& driven, GltfAnimation& result);
  void parse_track(const JsonView& animation, std::size_t channel_index, std::size_t node, GltfAnimation& result,
                   std::vector<TrackSource>& sources);
  /// Assembles the channels of single weights of a node into one track.
  void assemble_track(const JsonView& animation, std::size_t node, const std::vector<LoneWeight>& weights,
                      GltfAnimation& result, std::vector<TrackSource>& sources);
  /// Reads and checks the sampler of a channel. per_key is the number of elements for each key. Returns false after a
  /// complaint.
  bool parse_sampler(const JsonView& animation, std::size_t channel_index, Use use, std::size_t per_key,
                     GltfTrack& track, TrackSource& source);
  /// Reads the channels of an animation that move, turn or scale nodes.
  void parse_node_channels(const JsonView& animation, std::vector<NodeChannel>& result);
  /// Reads the expressions of a VRM avatar. Malformed expressions are skipped, since no geometry depends on them.
  void parse_expressions(const nlohmann::json& root);

  const nlohmann::json* document_ = nullptr;
  JsonComplaint complaint_;
  std::size_t file_bytes_;
  bool is_strict_;
  bool quantized_ = false;
  Model model_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> children_;  // pairs of parent and child
  std::vector<std::pair<std::uint32_t, Error>> misplaced_;         // nodes whose placement cannot be read
  nlohmann::json marked_;  // the extras.chronormal of nodes, each at the JSON pointer of its node
};

}  // namespace chronormal::inline internal::gltf

#endif  // CHRONORMAL_IO_GLTF_MODEL_GLTF_MODEL_PARSER_H_
