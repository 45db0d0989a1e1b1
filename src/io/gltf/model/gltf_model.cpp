// Parses assets, buffers, buffer views, accessors and nodes. Meshes are parsed in gltf_model_meshes.cpp, and animations
// in gltf_model_animations.cpp.
#include "io/gltf/model/gltf_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "core/text.h"
#include "io/bytes/expansion.h"
#include "io/gltf/model/gltf_bake_mark.h"
#include "io/gltf/model/gltf_model_parser.h"

namespace chronormal::inline internal::gltf {
namespace {

constexpr std::size_t kMostBytes = addressable(std::uint64_t{1} << 53);  // JSON numbers are exact up to this size

constexpr std::array<std::string_view, 5> kUnderstood = {"KHR_mesh_quantization", "EXT_meshopt_compression",
                                                         "KHR_meshopt_compression", "KHR_draco_mesh_compression",
                                                         "KHR_animation_pointer"};
// Families of extensions that add materials, lights or meaning, and change no positions, faces or normals of a mesh.
constexpr std::array<std::string_view, 10> kHarmlessFamilies = {
    "KHR_materials_",       "KHR_texture_",     "EXT_texture_",  "KHR_lights_punctual",
    "EXT_mesh_features",    "EXT_structural_",  "EXT_instance_", "CESIUM_primitive_outline",
    "EXT_feature_metadata", "EXT_mesh_manifold"};

bool is_acceptable(std::string_view extension) {
  return std::find(kUnderstood.begin(), kUnderstood.end(), extension) != kUnderstood.end() ||
         std::any_of(kHarmlessFamilies.begin(), kHarmlessFamilies.end(),
                     [&](std::string_view family) { return extension.starts_with(family); });
}

std::optional<Component> to_component(std::size_t value) {
  for (const Component component : {Component::kInt8, Component::kUint8, Component::kInt16, Component::kUint16,
                                    Component::kUint32, Component::kFloat}) {
    if (static_cast<std::size_t>(component) == value) return component;
  }
  return std::nullopt;
}

std::optional<Component> read_component(const JsonView& object) {
  const std::size_t value = object.required_count("componentType", kMostBytes);
  const std::optional<Component> component = to_component(value);
  if (!component)
    object.complain("componentType",
                    "component type " + std::to_string(value) + " does not exist in glTF 2.0; export the file again");
  return component;
}

struct ElementType {
  std::string_view name;
  std::size_t components;
  bool is_matrix;
};
constexpr std::array<ElementType, 7> kElementTypes = {{{"SCALAR", 1, false},
                                                       {"VEC2", 2, false},
                                                       {"VEC3", 3, false},
                                                       {"VEC4", 4, false},
                                                       {"MAT2", 4, true},
                                                       {"MAT3", 9, true},
                                                       {"MAT4", 16, true}}};

std::string node_pointer(std::size_t index) { return std::string("/nodes/").append(std::to_string(index)); }

}  // namespace

Result<Model> Parser::parse(const nlohmann::json& document) {
  document_ = &document;
  const JsonView root(document, "", complaint_);
  if (root.is_object()) {
    parse_asset(root);
    check_required(root);
    for_each_item(root, "buffers", [&](const JsonView& item) { parse_buffer(item); });
    for_each_item(root, "bufferViews", [&](const JsonView& item) {
      BufferView view;
      std::optional<Error> fault = fault_of([&] { parse_view(item, view); });
      if (fault) view = {};
      view.fault = std::move(fault);
      model_.views.push_back(std::move(view));
    });
    for_each_item(root, "accessors", [&](const JsonView& item) {
      Accessor accessor;
      std::optional<Error> fault = fault_of([&] { parse_accessor(item, accessor); });
      if (fault) accessor = {};
      accessor.fault = std::move(fault);
      model_.accessors.push_back(std::move(accessor));
    });
    for_each_item(root, "meshes", [&](const JsonView& item) { parse_mesh(item); });
    check_nodes(root);
    parse_skins();
    for_each_item(root, "animations", [&](const JsonView& item) { parse_animation(item); });
    parse_expressions(document);
    note_faults();
  }
  if (complaint_.first()) return *complaint_.first();
  return std::move(model_);
}

void Parser::parse_asset(const JsonView& root) {
  const std::optional<JsonView> asset = root.object("asset");
  if (!asset)
    return root.complain(
        "asset", "this is not a glTF 2.0 file, since its JSON has no asset; name a glTF file, or export it again");
  // A file may set minVersion to the version of glTF that its readers must support. This reader supports only 2.0.
  const std::string version = asset->required_text("version"), least = asset->text("minVersion");
  if (!version.starts_with("2."))
    asset->complain("version", "the file needs another version of glTF than 2.0; export it as glTF 2.0");
  if (!least.empty() && least != "2.0")
    asset->complain("minVersion", "the file needs another version of glTF than 2.0; export it as glTF 2.0");
  if (const std::optional<JsonView> used = root.array("extensionsUsed")) {
    for (std::size_t i = 0; i < used->size(); ++i) model_.extensions.push_back(used->item(i).as_text());
  }
  quantized_ = std::find(model_.extensions.begin(), model_.extensions.end(), kUnderstood[0]) != model_.extensions.end();
}

void Parser::check_required(const JsonView& root) {
  const std::optional<JsonView> required = root.array("extensionsRequired");
  if (!required) return;
  // An unknown extension is an error only where it may change the meaning of data that are read here: in meshes and
  // their primitives, in buffers, buffer views and accessors, and in the samplers of animations.
  const auto is_extended = [](const nlohmann::json& value, const std::string& extension) {
    if (!value.is_object()) return false;
    // Primitives of points and lines are not read, so their extensions do not matter.
    const auto mode = value.find("mode");
    if (mode != value.end() && mode->is_number_unsigned() && mode->get<std::size_t>() < 4) return false;
    const auto found = value.find("extensions");
    return found != value.end() && found->is_object() && found->contains(extension);
  };
  const auto is_in = [&](const nlohmann::json& value, const char* list, const std::string& extension) {
    const auto items = value.is_object() ? value.find(list) : value.end();
    return value.is_object() && items != value.end() && items->is_array() &&
           std::any_of(items->begin(), items->end(), [&](const auto& item) { return is_extended(item, extension); });
  };
  const auto is_in_each = [&](const char* lists, const char* list, const std::string& extension) {
    const auto items = document_->find(lists);
    return items != document_->end() && items->is_array() &&
           std::any_of(items->begin(), items->end(), [&](const auto& item) { return is_in(item, list, extension); });
  };
  for (std::size_t i = 0; i < required->size(); ++i) {
    const std::string extension = required->item(i).as_text();
    if (is_acceptable(extension)) continue;
    const bool changes = is_in(*document_, "buffers", extension) || is_in(*document_, "bufferViews", extension) ||
                         is_in(*document_, "accessors", extension) || is_in(*document_, "meshes", extension) ||
                         is_in_each("meshes", "primitives", extension) ||
                         is_in_each("animations", "samplers", extension);
    const std::string message = std::string("the file requires the extension ").append(extension);
    if (changes)
      required->item(i).complain(message + ", which is not supported; export the file without it");
    else
      note(required->item(i), message + ", which is ignored here, since it moves no vertex of a mesh");
  }
}

void Parser::note_faults() {
  if (complaint_.first()) return;
  const auto note_fault = [&](const std::optional<Error>& fault) {
    if (fault) (void)understands([&] { complaint_.add(*fault); });
  };
  for (const BufferView& view : model_.views) note_fault(view.fault);
  for (const Accessor& accessor : model_.accessors) note_fault(accessor.fault);
}

void Parser::parse_buffer(const JsonView& item) {
  Buffer buffer;
  if (item.has("uri")) buffer.uri = item.text("uri");
  buffer.byte_length = item.required_count("byteLength", kMostBytes);
  if (buffer.byte_length == 0)
    item.complain("byteLength", "byteLength of a buffer must be at least 1; export the file again");
  model_.buffers.push_back(std::move(buffer));
}

void Parser::parse_view(const JsonView& item, BufferView& view) {
  view.buffer = item.required_index("buffer", model_.buffers.size(), "buffers").value_or(0);
  view.offset = item.count("byteOffset", kMostBytes, 0);
  view.length = item.required_count("byteLength", kMostBytes);
  view.stride = item.find_count("byteStride", 252);
  if (view.stride && (*view.stride < 4 || *view.stride % 4 != 0))
    item.complain("byteStride", "byteStride must be a multiple of 4 from 4 to 252; export the file again");
  if (complaint_.first()) return;
  if (view.length == 0)
    return item.complain("byteLength", "byteLength of a buffer view must be at least 1; export the file again");
  const std::size_t available = model_.buffers[view.buffer].byte_length;
  if (view.offset > available || view.length > available - view.offset)
    return item.complain("the buffer view ends at byte " + std::to_string(view.offset + view.length) + ", but buffer " +
                         std::to_string(view.buffer) + " has only " + counted(available, "byte", "bytes") +
                         "; export the file again");
  if (const std::optional<JsonView> extensions = item.object("extensions")) {
    for (const char* const name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
      const std::optional<JsonView> meshopt = extensions->object(name);
      if (!meshopt || view.compression) continue;
      view.compression = parse_compression(*meshopt, view);
      if (view.compression) view.compression->is_khr = name[0] == 'K';
    }
  }
}

std::optional<Compression> Parser::parse_compression(const JsonView& item, const BufferView& view) {
  using Mode = Compression::Mode;
  using Filter = Compression::Filter;
  constexpr std::array<std::pair<std::string_view, Mode>, 3> kModes = {
      {{"ATTRIBUTES", Mode::kAttributes}, {"TRIANGLES", Mode::kTriangles}, {"INDICES", Mode::kIndices}}};
  constexpr std::array<std::pair<std::string_view, Filter>, 5> kFilters = {{{"", Filter::kNone},
                                                                            {"NONE", Filter::kNone},
                                                                            {"OCTAHEDRAL", Filter::kOctahedral},
                                                                            {"QUATERNION", Filter::kQuaternion},
                                                                            {"EXPONENTIAL", Filter::kExponential}}};
  Compression result;
  result.buffer = item.required_index("buffer", model_.buffers.size(), "buffers").value_or(0);
  result.offset = item.count("byteOffset", kMostBytes, 0);
  result.length = item.required_count("byteLength", kMostBytes);
  result.stride = item.required_count("byteStride", 256);
  result.count = item.required_count("count", kMostBytes);
  const std::string mode = item.required_text("mode"), filter = item.text("filter");
  const auto* const found_mode = std::find_if(kModes.begin(), kModes.end(), [&](auto& m) { return m.first == mode; });
  const auto* const found_filter =
      std::find_if(kFilters.begin(), kFilters.end(), [&](auto& f) { return f.first == filter; });
  if (found_mode == kModes.end())
    item.complain("mode", "mode must be ATTRIBUTES, TRIANGLES or INDICES; compress the file again");
  if (found_filter == kFilters.end())
    item.complain("filter", "filter must be NONE, OCTAHEDRAL, QUATERNION or EXPONENTIAL; compress the file again");
  if (complaint_.first()) return std::nullopt;
  result.mode = found_mode->second;
  result.filter = found_filter->second;

  const std::size_t available = model_.buffers[result.buffer].byte_length;
  if (result.offset > available || result.length > available - result.offset)
    item.complain("the compressed data end at byte " + std::to_string(result.offset + result.length) + ", but buffer " +
                  std::to_string(result.buffer) + " has only " + counted(available, "byte", "bytes") +
                  "; export the file again");
  const bool of_attributes = result.mode == Mode::kAttributes;
  const bool stride_ok =
      of_attributes ? result.stride % 4 == 0 && result.stride > 0 : result.stride == 2 || result.stride == 4;
  if (view.stride && *view.stride != result.stride)
    item.complain("byteStride", "byteStride must be " + std::to_string(*view.stride) +
                                    ", as in the buffer view; compress the file again");
  if (!stride_ok)
    item.complain("byteStride",
                  of_attributes
                      ? "byteStride of attributes must be a multiple of 4 from 4 to 256; compress the file again"
                      : "byteStride of indices must be 2 or 4; compress the file again");
  const bool filter_ok = result.filter == Filter::kNone ||
                         (of_attributes && (result.filter == Filter::kExponential || result.stride == 8 ||
                                            (result.filter == Filter::kOctahedral && result.stride == 4)));
  if (!filter_ok)
    item.complain("filter", "the filter is not allowed with this mode and byteStride; compress the file again");
  if (result.mode == Mode::kTriangles && result.count % 3 != 0)
    item.complain("count", "count must be a multiple of 3 for triangles; compress the file again");
  if (complaint_.first()) return std::nullopt;
  if (result.count > view.length / result.stride || result.count * result.stride != view.length)
    item.complain("count", counted(result.count, "element", "elements") + " of " +
                               counted(result.stride, "byte", "bytes") + (result.count == 1 ? " does" : " do") +
                               " not fill the buffer view, which has " + counted(view.length, "byte", "bytes") +
                               "; compress the file again");
  // A bit of the compressed data stands for at most 8 bytes of the result, and a byte for at most 64. This check
  // refuses results that are longer than four times as much, because a small file must not ask for much memory.
  if (view.length / 256 > result.length)
    item.complain("byteLength", "the compressed data are too short for the " + counted(view.length, "byte", "bytes") +
                                    " that they should hold; compress the file again");
  return result;
}

void Parser::parse_accessor(const JsonView& item, Accessor& accessor) {
  accessor.view = item.find_index("bufferView", model_.views.size(), "buffer views");
  accessor.offset = item.count("byteOffset", kMostBytes, 0);
  accessor.count = item.required_count("count", kMostBytes);
  accessor.component = read_component(item).value_or(Component::kFloat);
  accessor.normalized = item.flag("normalized");
  const std::string type = item.required_text("type");
  const auto* const found =
      std::find_if(kElementTypes.begin(), kElementTypes.end(), [&](const auto& t) { return t.name == type; });
  if (found == kElementTypes.end()) {
    item.complain("type", "type must be SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4; export the file again");
  } else {
    accessor.components = found->components;
    accessor.is_matrix = found->is_matrix;
  }
  if (accessor.count == 0) item.complain("count", "count of an accessor must be at least 1; export the file again");
  if (item.has("byteOffset") && !item.has("bufferView"))
    item.complain("byteOffset", "byteOffset is not allowed without bufferView; export the file again");
  if (accessor.normalized && (accessor.component == Component::kFloat || accessor.component == Component::kUint32))
    item.complain("normalized", "normalized is only allowed for integers of 8 and 16 bits; export the file again");
  if (const std::optional<JsonView> sparse = item.object("sparse")) parse_sparse(*sparse, accessor);
}

void Parser::parse_sparse(const JsonView& item, Accessor& accessor) {
  Sparse sparse;
  sparse.count = item.required_count("count", kMostBytes);
  if (sparse.count == 0 || sparse.count > accessor.count)
    item.complain("count", "count is " + std::to_string(sparse.count) + ", but must be from 1 to " +
                               std::to_string(accessor.count) +
                               ", the number of elements of the accessor; export the file again");
  const std::optional<JsonView> indices = item.object("indices"), values = item.object("values");
  if (!indices || !values)
    return item.complain("a sparse accessor must have indices and values; export the file again");
  sparse.indices_view = indices->required_index("bufferView", model_.views.size(), "buffer views").value_or(0);
  sparse.indices_offset = indices->count("byteOffset", kMostBytes, 0);
  sparse.indices_component = read_component(*indices).value_or(Component::kUint16);
  if (sparse.indices_component != Component::kUint8 && sparse.indices_component != Component::kUint16 &&
      sparse.indices_component != Component::kUint32)
    indices->complain("componentType", "componentType of indices must be an unsigned integer; export the file again");
  sparse.values_view = values->required_index("bufferView", model_.views.size(), "buffer views").value_or(0);
  sparse.values_offset = values->count("byteOffset", kMostBytes, 0);
  accessor.sparse = sparse;
}

void Parser::parse_node(std::size_t index, const nlohmann::json& value) {
  constexpr std::size_t kMostNodes = ~std::uint32_t{0};
  if (complaint_.first()) return;
  const JsonView item(value, node_pointer(index), complaint_);
  if (index >= kMostNodes) return item.complain("the file has more nodes than can be read; split the file");
  GltfNode& node = model_.nodes.emplace_back();
  node.name = item.text("name");
  node.has_skin = item.has("skin");
  if (node.has_skin) {
    (void)fault_of([&] {
      if (const auto skin = item.find_index("skin", kMostNodes, "skins")) node.skin = static_cast<std::uint32_t>(*skin);
    });
  }
  if (const auto mesh = item.find_index("mesh", kMostNodes, "meshes")) node.mesh = static_cast<std::uint32_t>(*mesh);
  node.weights = parse_weights(item);
  if (std::optional<Error> fault = fault_of([&] { parse_transform(item, index); }))
    misplaced_.emplace_back(static_cast<std::uint32_t>(index), std::move(*fault));
  if (const auto extras = value.find("extras"); extras != value.end() && extras->is_object()) {
    if (const auto mark = extras->find("chronormal"); mark != extras->end())
      marked_["nodes"][std::to_string(index)]["extras"]["chronormal"] = *mark;
  }
  const std::optional<JsonView> children = item.array("children");
  for (std::size_t c = 0; children && c < children->size(); ++c) {
    const std::optional<std::size_t> child = children->item(c).as_index(kMostNodes, "nodes");
    if (!child) return;
    children_.emplace_back(static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(*child));
  }
}

void Parser::parse_transform(const JsonView& item, std::size_t index) {
  // Reads the array under `key`, which must have `count` numbers. Returns false if the array is missing.
  const auto read = [&](const char* key, std::size_t count, double* result) {
    const std::optional<JsonView> array = item.array(key);
    if (!array) return false;
    if (array->size() != count) {
      array->complain("the array must have " + counted(count, "number", "numbers") + ", but has " +
                      std::to_string(array->size()) + "; export the file again");
      return false;
    }
    for (std::size_t i = 0; i < count; ++i) result[i] = array->item(i).as_number();
    return true;
  };
  std::array<double, 16> matrix{};
  std::array<double, 3> translation = {0, 0, 0}, scale = {1, 1, 1};
  std::array<double, 4> rotation = {0, 0, 0, 1};
  const bool has_matrix = read("matrix", 16, matrix.data());
  const bool has_translation = read("translation", 3, translation.data());
  const bool has_rotation = read("rotation", 4, rotation.data());
  const bool has_scale = read("scale", 3, scale.data());
  const auto vector = [](const double* v) { return Vec3d{v[0], v[1], v[2]}; };
  if (has_matrix) {
    if (has_translation || has_rotation || has_scale)
      return item.complain(
          "matrix",
          "the node has a matrix and also translation, rotation or scale; remove either the matrix or the others");
    const double* m = matrix.data();
    model_.placements.emplace_back(index, AffineTransform{{vector(m), vector(m + 4), vector(m + 8)}, vector(m + 12)});
  } else if (has_translation || has_rotation || has_scale) {
    const double length = std::sqrt(rotation[0] * rotation[0] + rotation[1] * rotation[1] +
                                    (rotation[2] * rotation[2] + rotation[3] * rotation[3]));
    if (!(std::fabs(length - 1) < 1e-2))
      return item.complain("rotation", "the rotation must be a quaternion of length 1; export the file again");
    for (double& component : rotation) component /= length;
    model_.placements.emplace_back(index, NodeTransform{vector(translation.data()), rotation, vector(scale.data())});
  }
}

void Parser::check_nodes(const JsonView& root) {
  if (complaint_.first() || !root.has("nodes")) return;
  const std::size_t count = model_.nodes.size();
  // Nodes that are objects were moved out of the array before. Any item that is left is therefore not an object.
  if (const nlohmann::json& rest = (*document_)["nodes"]; count == 0 || !rest.is_array() || !rest.empty())
    return root.complain("nodes", "nodes must be an array of at least one object; export the file again");
  for (std::size_t i = 0; i < count && !complaint_.first(); ++i) {
    const GltfNode& node = model_.nodes[i];
    if (!node.mesh && node.weights.empty()) continue;
    const std::size_t mesh = node.mesh.value_or(0);
    if (node.mesh && mesh >= model_.meshes.size())
      complaint_.add(node_pointer(i) + "/mesh",
                     "the node refers to mesh " + std::to_string(mesh) + ", but the file has " +
                         counted(model_.meshes.size(), "mesh", "meshes") + "; export the file again");
    else if (!node.weights.empty())
      check_weights(node_pointer(i), node.weights, node.mesh ? model_.meshes[mesh].target_count : 0);
  }
  if (!complaint_.first()) connect_nodes();
  if (!complaint_.first() && !marked_.empty()) read_marks_of_nodes();
  if (misplaced_.empty() || complaint_.first()) return;
  const std::vector<bool> places = nodes_that_place_meshes();
  for (auto& misplaced : misplaced_) {
    const auto add = [&] { complaint_.add(std::move(misplaced.second)); };
    if (places[misplaced.first])
      add();
    else
      (void)understands(add);
  }
}

std::vector<bool> Parser::nodes_that_place_meshes() const {
  std::vector<bool> places(model_.nodes.size(), false);
  const auto add = [&](std::size_t node) {
    for (std::optional<std::uint32_t> at = static_cast<std::uint32_t>(node); at && !places[*at];
         at = model_.nodes[*at].parent)
      places[*at] = true;
  };
  for (std::size_t i = 0; i < model_.nodes.size(); ++i)
    if (model_.nodes[i].mesh) add(i);
  const auto skins = document_->find("skins");
  if (skins == document_->end() || !skins->is_array()) return places;
  for (const nlohmann::json& skin : *skins) {
    const auto joints = skin.is_object() ? skin.find("joints") : skin.end();
    if (!skin.is_object() || joints == skin.end() || !joints->is_array()) continue;
    for (const nlohmann::json& joint : *joints)
      if (joint.is_number_unsigned() && joint.get<std::size_t>() < places.size()) add(joint.get<std::size_t>());
  }
  return places;
}

void Parser::connect_nodes() {
  const std::size_t count = model_.nodes.size();
  for (const auto& [parent, child] : children_) {
    const std::string pointer = node_pointer(parent) + "/children";
    if (child >= count)
      return complaint_.add(pointer, "the node refers to node " + std::to_string(child) + ", but the file has " +
                                         counted(count, "node", "nodes") + "; export the file again");
    if (model_.nodes[child].parent)
      return complaint_.add(
          pointer,
          "node " + std::to_string(child) +
              " is listed as a child more than once, but a node has at most one parent; export the file again");
    model_.nodes[child].parent = parent;
  }
  // A walk from a node up through its parents must end at a root. If a walk meets its own path again, the parents form
  // a circle. No node is visited twice.
  std::vector<std::uint32_t> seen_from(count, 0);
  for (std::size_t i = 0; i < count; ++i) {
    const auto mark = static_cast<std::uint32_t>(i + 1);
    for (std::size_t at = i; seen_from[at] == 0;) {
      seen_from[at] = mark;
      if (!model_.nodes[at].parent) break;
      at = *model_.nodes[at].parent;
      if (seen_from[at] == mark)
        return complaint_.add(node_pointer(at),
                              "the node is its own parent, directly or through other nodes; export the file again");
    }
  }
}

// Takes the marks of bakes also from nodes, because other programs keep the extras of nodes and drop the extras of
// meshes. Some of these programs also move the mesh to a new child of the node.
void Parser::read_marks_of_nodes() {
  for (std::size_t i = 0; i < model_.nodes.size(); ++i) {
    const GltfNode& node = model_.nodes[i];
    if (!node.mesh) continue;
    GltfMesh& mesh = model_.meshes[*node.mesh];
    const auto read = [&](std::size_t index) {
      const bool is_known = mesh.mark || mesh.mark_fault;
      if (!is_known) read_bake_mark(marked_, node_pointer(index), complaint_.place(""), mesh);
    };
    read(i);
    if (node.parent && !model_.nodes[*node.parent].mesh) read(*node.parent);
  }
}

std::vector<double> Parser::parse_weights(const JsonView& item) {
  std::vector<double> weights;
  const std::optional<JsonView> array = item.array("weights");
  for (std::size_t i = 0; array && i < array->size(); ++i) weights.push_back(array->item(i).as_number());
  return weights;
}

void Parser::check_weights(const std::string& pointer, const std::vector<double>& weights, std::size_t target_count) {
  if (weights.size() != target_count)
    complaint_.add(pointer + "/weights",
                   "the list has " + counted(weights.size(), "weight", "weights") + ", but the mesh has " +
                       counted(target_count, "morph target", "morph targets") + "; export the file again");
}

Placement placement_of(const Model& model, std::size_t node) noexcept {
  const auto found = std::lower_bound(model.placements.begin(), model.placements.end(), node,
                                      [](const auto& entry, std::size_t index) { return entry.first < index; });
  return found != model.placements.end() && found->first == node ? found->second : NodeTransform{};
}

AffineTransform transform_of(const Placement& placement) noexcept {
  if (const auto* const node = std::get_if<NodeTransform>(&placement)) return affine_transform(*node);
  return std::get<AffineTransform>(placement);
}

std::string primitive_pointer(std::size_t mesh, std::size_t primitive) {
  std::string pointer = "/meshes/";
  return pointer.append(std::to_string(mesh)).append("/primitives/").append(std::to_string(primitive));
}

Result<Model> parse_model(std::string_view json, const std::string& name, std::size_t offset, std::size_t file_bytes,
                          bool is_strict) {
  Parser parser(name, file_bytes, is_strict);
  const auto take_node = [&](std::size_t index, const nlohmann::json& item) { parser.parse_node(index, item); };
  const Result<nlohmann::json> document = parse_json(json, name, offset, {"nodes", take_node});
  if (!document) return document.error();
  return parser.parse(document.value());
}

}  // namespace chronormal::inline internal::gltf
