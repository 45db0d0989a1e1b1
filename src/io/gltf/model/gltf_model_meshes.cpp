// Reads meshes, checks the form of their accessors, and reads the expressions of VRM avatars.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>

#include "core/charconv.h"
#include "core/text.h"
#include "io/bytes/binary.h"
#include "io/gltf/model/gltf_bake_mark.h"
#include "io/gltf/model/gltf_model_parser.h"

namespace chronormal::inline internal::gltf {
namespace {

// The largest weight that an expression may give to a target. Larger weights are taken for errors and ignored.
constexpr double kLargestBind = 100;

constexpr std::size_t kAnyId = ~std::uint32_t{0};

std::string number(std::size_t value) { return std::to_string(value); }

bool is_one_of(Component component, std::initializer_list<Component> list) {
  return std::find(list.begin(), list.end(), component) != list.end();
}

}  // namespace

void Parser::parse_mesh(const JsonView& item) {
  GltfMesh mesh;
  std::vector<PrimitiveSource> sources;
  mesh.name = item.text("name");
  const std::optional<JsonView> primitives = item.array("primitives");
  if (!primitives) item.complain("the mesh has no primitives; remove the mesh, or export the file again");
  for (std::size_t p = 0; primitives && p < primitives->size() && !complaint_.first(); ++p) {
    const JsonView primitive = primitives->item(p);
    if (primitive.is_object()) parse_primitive(primitive, mesh, sources);
  }
  if (complaint_.first()) return;
  fill_targets(*primitives, mesh, sources);
  if (complaint_.first()) return;

  mesh.weights = parse_weights(item);
  if (!mesh.weights.empty()) check_weights(item.pointer(), mesh.weights, mesh.target_count);
  mesh.weights.resize(mesh.target_count, 0.0);
  // Target names are a convention and not part of glTF, so a list of the wrong form or length is not an error. Older
  // versions of UniVRM write the names into each primitive instead of the mesh.
  for (const char* const place : {"/extras/targetNames", "/primitives/0/extras/targetNames"}) {
    const nlohmann::json::json_pointer pointer(item.pointer() + place);
    if (!mesh.target_names.empty() || !document_->contains(pointer)) continue;
    try {
      const nlohmann::json& names = document_->at(pointer);
      if (names.is_array() && names.size() == mesh.target_count)
        mesh.target_names = names.get<std::vector<std::string>>();
    } catch (const nlohmann::json::exception&) {
      mesh.target_names.clear();
    }
  }
  read_bake_mark(*document_, item.pointer(), complaint_.place(""), mesh);
  model_.meshes.push_back(std::move(mesh));
  model_.sources.push_back(std::move(sources));
}

void Parser::parse_primitive(const JsonView& item, GltfMesh& mesh, std::vector<PrimitiveSource>& sources) {
  GltfPrimitive primitive;
  PrimitiveSource source;
  primitive.mode = static_cast<int>(item.count("mode", 6, 4));
  const std::optional<JsonView> attributes = item.object("attributes");
  if (!attributes) return item.complain("attributes", "the primitive has no attributes; export the file again");
  if (attributes->size() == 0)
    return attributes->complain("attributes of a primitive must not be empty; export the file again");

  source.draco = parse_draco(item, *attributes);
  if (complaint_.first()) return;
  primitive.has_draco = source.draco.has_value();
  if (primitive.has_draco && primitive.mode == 6)
    return item.complain(
        "mode",
        "the primitive is a triangle fan, which KHR_draco_mesh_compression does not allow; export plain triangles");
  const Attributes compressed = source.draco ? source.draco->attributes : Attributes();
  source.base.position = parse_use(*attributes, "POSITION", Use::kPosition, primitive.has_draco);
  if (source.base.position) {
    primitive.vertex_count = model_.accessors[*source.base.position].count;
    source.base.normal = parse_use(*attributes, "NORMAL", Use::kNormal, compressed.normal.has_value());
    source.base.tangent = parse_use(*attributes, "TANGENT", Use::kTangent, compressed.tangent.has_value());
    if (complaint_.first()) return;
    for (const auto& [key, index] : {std::pair("NORMAL", source.base.normal), {"TANGENT", source.base.tangent}}) {
      if (index && model_.accessors[*index].count != primitive.vertex_count)
        attributes->complain(key, "the accessor has " + counted(model_.accessors[*index].count, "element", "elements") +
                                      ", but the primitive has " +
                                      counted(primitive.vertex_count, "position", "positions") +
                                      "; export the file again");
    }
  }
  source.indices = parse_use(item, "indices", Use::kIndices, primitive.has_draco);
  if (complaint_.first()) return;
  primitive.has_normals = source.base.normal.has_value();
  primitive.has_tangents = source.base.tangent.has_value();
  primitive.element_count = source.indices ? model_.accessors[*source.indices].count : primitive.vertex_count;
  if (primitive.element_count > kAnyId || primitive.vertex_count > kAnyId)
    item.complain("the primitive has more vertices or indices than 32 bits can count; split the mesh");

  parse_targets(item, primitive, source);
  if (complaint_.first()) return;
  mesh.target_count = std::max(mesh.target_count, primitive.targets.size());
  mesh.primitives.push_back(std::move(primitive));
  sources.push_back(std::move(source));
}

void Parser::fill_targets(const JsonView& primitives, GltfMesh& mesh, std::vector<PrimitiveSource>& sources) {
  for (std::size_t p = 0; p < sources.size() && !complaint_.first(); ++p) {
    const JsonView item = primitives.item(p);
    const std::size_t own = sources[p].targets.size();
    if (own < mesh.target_count) {  // own + 1 <= target_count, so target_count is not 0
      (void)understands([&] {
        item.complain("targets", "the primitive has " + counted(own, "target", "targets") +
                                     ", but another one of its mesh has " + grouped(mesh.target_count) +
                                     "; here the missing targets move nothing");
      });
      sources[p].targets.resize(mesh.target_count);
      mesh.primitives[p].targets.resize(mesh.target_count);
    }
    sources[p].influence_fault = fault_of([&] { parse_influences(item, sources[p]); });
  }
}

std::optional<Draco> Parser::parse_draco(const JsonView& item, const JsonView& attributes) {
  const std::optional<JsonView> extensions = item.object("extensions");
  const std::optional<JsonView> found = extensions ? extensions->object("KHR_draco_mesh_compression") : std::nullopt;
  if (!found) return std::nullopt;
  Draco draco;
  const std::optional<std::size_t> view = found->required_index("bufferView", model_.views.size(), "buffer views");
  if (view) (void)view_of(*view);
  draco.view = view.value_or(0);
  const std::optional<JsonView> ids = found->object("attributes");
  if (!ids) {
    found->complain("attributes", "the Draco data of the primitive have no attributes; export the file again");
    return std::nullopt;
  }
  for (const std::string& key : ids->keys()) {
    if (!attributes.has(key.c_str()))
      ids->complain(key.c_str(),
                    "the Draco data have this attribute, but the primitive has not; export the file again");
  }
  if (attributes.has("POSITION") && !ids->has("POSITION"))
    ids->complain("the Draco data have no attribute POSITION; export the file again");
  draco.attributes.position = ids->find_index("POSITION", kAnyId, "attributes");
  draco.attributes.normal = ids->find_index("NORMAL", kAnyId, "attributes");
  draco.attributes.tangent = ids->find_index("TANGENT", kAnyId, "attributes");
  return draco;
}

void Parser::parse_targets(const JsonView& item, GltfPrimitive& primitive, PrimitiveSource& source) {
  const std::optional<JsonView> targets = item.array("targets");
  for (std::size_t k = 0; targets && k < targets->size() && !complaint_.first(); ++k) {
    const JsonView target = targets->item(k);
    if (!target.is_object()) return;
    if (target.size() == 0) note(target, "the target is empty, so it moves nothing");
    // A target is not read if it is empty or the primitive has no positions.
    if (target.size() == 0 || !source.base.position) {
      source.targets.emplace_back();
      primitive.targets.emplace_back();
      continue;
    }
    Attributes moved;
    const auto read = [&](const char* key, Use use, const std::optional<std::size_t>& base,
                          std::optional<std::size_t>& result) {
      if (!target.has(key)) return;
      if (!base)
        return target.complain(key, "the target has this attribute, but the primitive has not; export the file again");
      result = parse_use(target, key, use);
      if (result && model_.accessors[*result].count != primitive.vertex_count)
        target.complain(key, "the target has " + counted(model_.accessors[*result].count, "element", "elements") +
                                 ", but the primitive has " + counted(primitive.vertex_count, "vertex", "vertices") +
                                 "; export the file again");
    };
    read("POSITION", Use::kMovedPosition, source.base.position, moved.position);
    read("NORMAL", Use::kMovedNormal, source.base.normal, moved.normal);
    read("TANGENT", Use::kMovedTangent, source.base.tangent, moved.tangent);
    source.targets.push_back(moved);
    primitive.targets.push_back({moved.position.has_value(), moved.normal.has_value(), moved.tangent.has_value()});
  }
}

void Parser::parse_influences(const JsonView& item, PrimitiveSource& source) {
  const JsonView attributes = *item.object("attributes");
  const std::optional<JsonView> extensions = item.object("extensions");
  const std::optional<JsonView> draco = extensions ? extensions->object("KHR_draco_mesh_compression") : std::nullopt;
  const std::optional<JsonView> compressed = draco ? draco->object("attributes") : std::nullopt;
  for (std::size_t n = 0; !complaint_.first(); ++n) {
    const std::string joints_key = "JOINTS_" + number(n), weights_key = "WEIGHTS_" + number(n);
    const bool has_joints = attributes.has(joints_key.c_str()), has_weights = attributes.has(weights_key.c_str());
    if (!has_joints && !has_weights) return;
    if (!has_joints || !has_weights) {
      return attributes.complain("the primitive has " + (has_joints ? joints_key : weights_key) + " but no " +
                                 (has_joints ? weights_key : joints_key) + "; export the file again");
    }
    const auto read = [&](const std::string& key, Use use) {
      const std::optional<std::size_t> id =
          compressed ? compressed->find_index(key.c_str(), kAnyId, "attributes") : std::nullopt;
      const std::optional<std::size_t> index = parse_use(attributes, key.c_str(), use, id.has_value());
      if (index && source.base.position &&
          model_.accessors[*index].count != model_.accessors[*source.base.position].count)
        attributes.complain(key.c_str(),
                            "the accessor has " + counted(model_.accessors[*index].count, "element", "elements") +
                                ", but the primitive has " +
                                counted(model_.accessors[*source.base.position].count, "position", "positions") +
                                "; export the file again");
      return AttributeSource{index.value_or(0), id};
    };
    const AttributeSource joints = read(joints_key, Use::kJoints), weights = read(weights_key, Use::kJointWeights);
    if (!complaint_.first()) source.influences.push_back({joints, weights});
  }
}

void Parser::parse_skins() {
  const auto skins = document_->find("skins");
  if (complaint_.first() || skins == document_->end() || !skins->is_array()) return;
  for (std::size_t i = 0; i < skins->size(); ++i) {
    SkinSource& skin = model_.skins.emplace_back();
    skin.fault = fault_of([&] { parse_skin(JsonView((*skins)[i], "/skins/" + number(i), complaint_), skin); });
  }
}

void Parser::parse_skin(const JsonView& item, SkinSource& skin) {
  if (!item.is_object()) return;
  const std::optional<JsonView> joints = item.array("joints");
  if (!joints) return item.complain("joints", "the skin has no joints; export the file again");
  for (std::size_t j = 0; j < joints->size(); ++j) {
    const std::optional<std::size_t> joint = joints->item(j).as_index(model_.nodes.size(), "nodes");
    if (!joint) return;
    skin.joints.push_back(static_cast<std::uint32_t>(*joint));
  }
  skin.inverse_binds = parse_use(item, "inverseBindMatrices", Use::kInverseBinds);
  if (skin.inverse_binds && model_.accessors[*skin.inverse_binds].count < skin.joints.size())
    item.complain("inverseBindMatrices",
                  "the accessor has " + counted(model_.accessors[*skin.inverse_binds].count, "matrix", "matrices") +
                      ", but the skin has " + counted(skin.joints.size(), "joint", "joints") +
                      "; export the file again");
}

std::optional<std::size_t> Parser::parse_use(const JsonView& object, const char* key, Use use, bool compressed) {
  const std::optional<std::size_t> index = object.find_index(key, model_.accessors.size(), "accessors");
  if (!index || complaint_.first()) return std::nullopt;
  check_use(object, key, *index, use, compressed);
  if (complaint_.first()) return std::nullopt;
  return index;
}

void Parser::check_use(const JsonView& object, const char* key, std::size_t index, Use use, bool compressed) {
  using enum Component;
  const Accessor& accessor = model_.accessors[index];
  if (accessor.fault) return complaint_.add(*accessor.fault);
  const auto complain = [&](std::string message) {
    object.complain(key, "accessor " + number(index) + " " + std::move(message));
  };

  std::size_t components = 3;
  if (use == Use::kTangent || use == Use::kTurnedNode || use == Use::kJoints || use == Use::kJointWeights)
    components = 4;
  if (use == Use::kIndices || use == Use::kTimes || use == Use::kWeights) components = 1;
  if (use == Use::kInverseBinds) {
    if (!accessor.is_matrix || accessor.components != 16)
      return complain("must be of type MAT4; export the file again");
  } else if (accessor.is_matrix || accessor.components != components) {
    return complain("must be of type " + (components == 1 ? std::string("SCALAR") : "VEC" + number(components)) +
                    "; export the file again");
  }

  // The rules for the types of attributes are in section 3.7.2.1 of the specification, and in KHR_mesh_quantization.
  const bool small = is_one_of(accessor.component, {kInt8, kInt16});
  bool fits = accessor.component == kFloat;
  switch (use) {
    case Use::kPosition:
      fits = fits || (quantized_ && is_one_of(accessor.component, {kInt8, kUint8, kInt16, kUint16}));
      break;
    case Use::kMovedPosition:
      fits = fits || (quantized_ && small);
      break;
    case Use::kNormal:
    case Use::kTangent:
    case Use::kMovedNormal:
    case Use::kMovedTangent:
      fits = fits || (quantized_ && small && accessor.normalized);
      break;
    case Use::kTimes:
    case Use::kInverseBinds:
    case Use::kMovedNode:
      break;
    case Use::kJoints:
      fits = is_one_of(accessor.component, {kUint8, kUint16}) && !accessor.normalized;
      break;
    case Use::kJointWeights:
      fits = fits || (is_one_of(accessor.component, {kUint8, kUint16}) && accessor.normalized);
      break;
    case Use::kWeights:
    case Use::kTurnedNode:
      fits = fits || (accessor.component != kUint32 && accessor.normalized);
      break;
    case Use::kIndices:
      fits = is_one_of(accessor.component, {kUint8, kUint16, kUint32}) && !accessor.normalized;
      break;
  }
  if (!fits) return complain("has a componentType that glTF does not allow for this use; export the file again");

  if (compressed) return;  // the decoded data are checked later
  if (accessor.view) check_inside_view(object, key, index, use);
  const bool moved = use == Use::kMovedPosition || use == Use::kMovedNormal || use == Use::kMovedTangent;
  constexpr std::size_t kPlausible = 65536;
  if (!accessor.view && !moved && accessor.count > file_bytes_ + kPlausible)
    return complain("has " + counted(accessor.count, "element", "elements") +
                    " but no data (bufferView), which is more than a file of " + counted(file_bytes_, "byte", "bytes") +
                    " may declare; export the file again");
  if (accessor.sparse) check_sparse(object, key, index);
}

void Parser::check_inside_view(const JsonView& object, const char* key, std::size_t index, Use use) {
  const Accessor& accessor = model_.accessors[index];
  const BufferView& view = view_of(*accessor.view);
  if (complaint_.first()) return;
  const auto complain = [&](std::string message) {
    object.complain(key, "accessor " + number(index) + " " + std::move(message));
  };
  constexpr std::array kNoAttributes = {Use::kIndices,      Use::kTimes,     Use::kWeights,
                                        Use::kInverseBinds, Use::kMovedNode, Use::kTurnedNode};
  const bool is_attribute = std::find(kNoAttributes.begin(), kNoAttributes.end(), use) == kNoAttributes.end();
  if (!is_attribute) check_unstrided(object, key, view, "an accessor that is not an attribute of vertices");
  const std::size_t size = accessor.element_size(), stride = view.stride.value_or(size);
  const std::size_t alignment = component_size(accessor.component);
  if (accessor.offset % alignment != 0 || (view.offset + accessor.offset) % alignment != 0)
    return complain("must begin at a multiple of " + counted(alignment, "byte", "bytes") +
                    ", the size of its components; export the file again");
  if (is_attribute && (accessor.offset % 4 != 0 || stride % 4 != 0))
    return complain(
        "must have its elements at multiples of 4 bytes, since it is an attribute of vertices; export the file again");
  if (stride < size)
    return complain("has elements of " + counted(size, "byte", "bytes") + ", more than the byteStride of " +
                    number(stride) + "; export the file again");
  if (accessor.offset > view.length || view.length - accessor.offset < size ||
      accessor.count - 1 > (view.length - accessor.offset - size) / stride)
    return complain("ends beyond buffer view " + number(*accessor.view) + ", which has " +
                    counted(view.length, "byte", "bytes") + "; export the file again");
}

void Parser::check_sparse(const JsonView& object, const char* key, std::size_t index) {
  const Accessor& accessor = model_.accessors[index];
  const Sparse& sparse = *accessor.sparse;
  const auto check = [&](std::size_t view_index, std::size_t offset, std::size_t size, Component component,
                         const char* what) {
    const BufferView& view = view_of(view_index);
    if (complaint_.first()) return;
    check_unstrided(object, key, view, "a sparse accessor");
    const std::size_t alignment = component_size(component);
    if ((view.offset + offset) % alignment != 0)
      object.complain(key, "the sparse " + std::string(what) + " of accessor " + number(index) +
                               " must begin at a multiple of " + counted(alignment, "byte", "bytes") +
                               "; export the file again");
    if (offset > view.length || !binary::fits(sparse.count, size, view.length - offset))
      object.complain(key, "the sparse " + std::string(what) + " of accessor " + number(index) +
                               " end beyond buffer view " + number(view_index) + ", which has " +
                               counted(view.length, "byte", "bytes") + "; export the file again");
  };
  check(sparse.indices_view, sparse.indices_offset, component_size(sparse.indices_component), sparse.indices_component,
        "indices");
  check(sparse.values_view, sparse.values_offset, accessor.element_size(), accessor.component, "values");
}

const BufferView& Parser::view_of(std::size_t index) {
  const BufferView& view = model_.views[index];
  if (view.fault) complaint_.add(*view.fault);
  return view;
}

void Parser::check_unstrided(const JsonView& object, const char* key, const BufferView& view, const char* what) {
  if (view.stride)
    object.complain(
        key, std::string("the buffer view of ").append(what) + " must not have a byteStride; export the file again");
}

namespace {

// Calls visit(name, binds) for each expression of a VRM avatar. `binds` is the JSON list of the targets that the
// expression moves. Versions 0 and 1 of VRM store expressions in different places.
template <class Visit>
void for_each_expression(const nlohmann::json& root, const Visit& visit) {
  using Pointer = nlohmann::json::json_pointer;
  const Pointer of_0("/extensions/VRM/blendShapeMaster/blendShapeGroups");
  if (root.contains(of_0) && root[of_0].is_array()) {
    for (const nlohmann::json& group : root[of_0]) {
      if (!group.is_object() || !group.contains("binds")) continue;
      const bool is_named = group.contains("name") && group["name"].is_string();
      visit(is_named ? group["name"].get<std::string>() : std::string(), group["binds"]);
    }
  }
  for (const char* const list :
       {"/extensions/VRMC_vrm/expressions/preset", "/extensions/VRMC_vrm/expressions/custom"}) {
    const Pointer of_1(list);
    if (!root.contains(of_1) || !root[of_1].is_object()) continue;
    for (const auto& [name, expression] : root[of_1].items())
      if (expression.is_object() && expression.contains("morphTargetBinds"))
        visit(name, expression["morphTargetBinds"]);
  }
}

// Returns the value of the member `key` if it is a whole number below `limit`, and nothing otherwise.
std::optional<std::size_t> whole_below(const nlohmann::json& object, const char* key, std::size_t limit) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_number()) return std::nullopt;
  const double value = found->get<double>();
  if (!(value >= 0 && value < static_cast<double>(limit)) || value != std::floor(value)) return std::nullopt;
  return static_cast<std::size_t>(value);
}

}  // namespace

void Parser::parse_expressions(const nlohmann::json& root) {
  for_each_expression(root, [&](const std::string& name, const nlohmann::json& binds) {
    std::map<std::size_t, std::vector<double>> of_meshes;
    if (!binds.is_array()) return;
    for (const nlohmann::json& bind : binds) {
      if (!bind.is_object() || !bind.contains("weight") || !bind["weight"].is_number()) continue;
      // VRM 0 names the mesh, and gives weights in percent. VRM 1 names a node of the mesh, and gives weights from 0 to
      // 1.
      const auto node = whole_below(bind, "node", model_.nodes.size());
      auto mesh = whole_below(bind, "mesh", model_.meshes.size());
      if (node && model_.nodes[*node].mesh) mesh = *model_.nodes[*node].mesh;
      const auto target = mesh ? whole_below(bind, "index", model_.meshes[*mesh].target_count) : std::nullopt;
      const double weight = bind["weight"].get<double>() / (node ? 1 : 100);
      if (!target || !(std::fabs(weight) <= kLargestBind)) continue;
      std::vector<double>& weights = of_meshes[*mesh];
      weights.resize(model_.meshes[*mesh].target_count);
      weights[*target] = weight;
    }
    for (auto& [mesh, weights] : of_meshes) model_.meshes[mesh].expressions.push_back({name, std::move(weights)});
  });
}

}  // namespace chronormal::inline internal::gltf
