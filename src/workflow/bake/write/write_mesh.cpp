#include "workflow/bake/write/write_mesh.h"

#include <algorithm>
#include <limits>
#include <set>
#include <string>

#include "io/gltf/model/gltf_bake_mark.h"
#include "io/json/json_writer.h"
#include "workflow/bake/write/messages.h"

namespace chronormal::inline internal {
namespace {

// Returns a weight as JSON text. JSON has no infinity, so a weight beyond float32 becomes the largest float.
std::string weight_text(double weight) {
  constexpr auto kMostWeight = static_cast<double>(std::numeric_limits<float>::max());
  return json_number(static_cast<float>(std::clamp(weight, -kMostWeight, kMostWeight)));
}

}  // namespace

std::size_t ZeroVectors::of(std::size_t vertices) {
  const auto found = accessors_.find(vertices);
  if (found != accessors_.end()) return found->second;
  const std::vector<float> zeros(3 * vertices);
  return accessors_[vertices] = edit_.add_vectors(zeros, {true, dense_});
}

MeshWriter::MeshWriter(const GltfDocument& document, const GltfShading& shading, bool smooth, ZeroVectors& zeros,
                       GltfEdit& edit)
    : document_(document),
      shading_(shading),
      mesh_(document.meshes()[shading.mesh]),
      zeros_(zeros),
      edit_(edit),
      parts_(shading),
      pointer_(std::string("/meshes/").append(std::to_string(shading.mesh))),
      part_(mesh_.primitives.size()),
      attributes_(mesh_.primitives.size()) {
  for (std::size_t i = 0; i < shading.parts.size(); ++i) {
    const std::size_t p = shading.parts[i].primitive;
    if (mesh_.primitives[p].has_normals || smooth) part_[p] = i;
  }
  for (std::size_t p = 0; p < mesh_.primitives.size(); ++p) {
    Attributes& has = attributes_[p];
    for (const GltfPrimitive::Target& target : mesh_.primitives[p].targets) {
      has.positions |= target.positions;
      has.normals |= target.normals;
      has.tangents |= target.tangents;
    }
    has.normals |= is_shaded(p);
    // Adds positions to a target without attributes, because the glTF specification requires at least one attribute in
    // each target.
    has.positions |= !has.normals && mesh_.primitives[p].vertex_count > 0;
  }
}

std::string MeshWriter::pointer_of(std::size_t primitive) const {
  return pointer_ + "/primitives/" + std::to_string(primitive);
}

std::size_t MeshWriter::zeros_of(std::size_t primitive) { return zeros_.of(mesh_.primitives[primitive].vertex_count); }

std::optional<TargetDeltas> MeshWriter::joined(const std::optional<TargetDeltas>& deltas) const {
  std::optional<TargetDeltas> result = deltas;
  if (result) parts_.join(*result);
  return result;
}

std::size_t MeshWriter::deltas_of(std::size_t primitive, const TargetDeltas& deltas) {
  const std::vector<float>& of_part = deltas.of_parts[*part_[primitive]];
  return of_part.empty() ? zeros_of(primitive) : edit_.add_vectors(of_part, {false, zeros_.are_dense()});
}

Status MeshWriter::write_base(const std::vector<bool>& is_replaced, std::span<const float> normals) {
  for (std::size_t i = 0; i < shading_.parts.size(); ++i) {
    if (!is_replaced[i]) continue;
    const GltfPart& part = shading_.parts[i];
    const std::string pointer = pointer_of(part.primitive);
    const GltfPrimitive& primitive = mesh_.primitives[part.primitive];
    if (primitive.has_normals && primitive.has_draco) {
      return invalid_input(document_.name() + ", " + pointer,
                           "the base normals are compressed by Draco and cannot be replaced; leave --recompute-base "
                           "out, or decompress the file first");
    }
    const std::size_t accessor =
        edit_.add_vectors(normals.subspan(3 * part.first_vertex, 3 * part.vertex_count), {false, true});
    edit_.set(pointer + "/attributes/NORMAL", std::to_string(accessor));
  }
  return Success{};
}

void MeshWriter::add_tangents() {
  for (std::size_t p = 0; p < mesh_.primitives.size(); ++p)
    attributes_[p].tangents |= is_shaded(p) && mesh_.primitives[p].has_tangents;
}

void MeshWriter::write_target(std::size_t target, const std::optional<TargetDeltas>& of_normals,
                              const std::optional<TargetDeltas>& of_tangents) {
  const std::optional<TargetDeltas> deltas = joined(of_normals), tangents = joined(of_tangents);
  for (std::size_t p = 0; p < mesh_.primitives.size(); ++p) {
    if (target >= mesh_.primitives[p].targets.size()) continue;
    const std::string pointer = pointer_of(p) + "/targets/" + std::to_string(target);
    const GltfPrimitive::Target& has = mesh_.primitives[p].targets[target];
    // Adds the target to a primitive that has fewer targets than others.
    if (!edit_.has(pointer)) edit_.append(pointer_of(p) + "/targets", "{}");
    if (attributes_[p].positions && !has.positions) edit_.set(pointer + "/POSITION", std::to_string(zeros_of(p)));
    if (deltas && is_shaded(p))
      edit_.set(pointer + "/NORMAL", std::to_string(deltas_of(p, *deltas)));
    else if (attributes_[p].normals && !has.normals)
      edit_.set(pointer + "/NORMAL", std::to_string(zeros_of(p)));
    if (tangents && is_shaded(p) && mesh_.primitives[p].has_tangents)
      edit_.set(pointer + "/TANGENT", std::to_string(deltas_of(p, *tangents)));
    else if (attributes_[p].tangents && !has.tangents)
      edit_.set(pointer + "/TANGENT", std::to_string(zeros_of(p)));
  }
}

void MeshWriter::append_target(const TargetDeltas& of_normals) {
  const TargetDeltas deltas = *joined(of_normals);
  for (std::size_t p = 0; p < mesh_.primitives.size(); ++p) {
    JsonObject target;
    if (attributes_[p].positions) target.add("POSITION", zeros_of(p));
    if (attributes_[p].normals) target.add("NORMAL", is_shaded(p) ? deltas_of(p, deltas) : zeros_of(p));
    if (attributes_[p].tangents) target.add("TANGENT", zeros_of(p));
    edit_.append(pointer_of(p) + "/targets", target.text());
  }
}

void MeshWriter::append_weights(std::span<const GltfExtraTarget> extras, const PoseList& rest) {
  const auto append = [&](const std::string& pointer, const std::vector<double>& weights, std::size_t pose) {
    for (std::size_t k = 0; k < extras.size(); ++k)
      edit_.append(pointer, weight_text(rest.empty() ? extras[k].weight(weights) : rest[pose][k]));
  };
  // An empty list stays empty, since a list for some of the targets would not be valid.
  if (edit_.has(pointer_ + "/weights/0")) append(pointer_ + "/weights", mesh_.weights, 0);
  for (std::size_t n = 0, pose = 0; n < document_.nodes().size(); ++n) {
    const GltfNode& node = document_.nodes()[n];
    if (node.mesh == shading_.mesh && !node.weights.empty())
      append(std::string("/nodes/").append(std::to_string(n)).append("/weights"), node.weights, ++pose);
  }
  if (mesh_.target_names.empty()) return;
  // Older versions of UniVRM store the names of targets in each primitive instead of the mesh.
  std::vector<std::string> names;
  if (edit_.has(pointer_ + "/extras/targetNames")) names.push_back(pointer_ + "/extras/targetNames");
  for (std::size_t p = 0; p < mesh_.primitives.size(); ++p) {
    const std::string of_primitive = pointer_of(p) + "/extras/targetNames";
    if (edit_.has(of_primitive) && edit_.text(of_primitive).starts_with("[")) names.push_back(of_primitive);
  }
  // Names must be unique, because PlayCanvas finds targets by their names.
  std::set<std::string> taken(mesh_.target_names.begin(), mesh_.target_names.end());
  for (const GltfExtraTarget& extra : extras) {
    const std::string of_extra = name_of_extra(extra);
    std::string name = of_extra;
    for (std::size_t n = 2; !taken.insert(name).second; ++n)
      name = std::string(of_extra).append(" (").append(std::to_string(n)).append(")");
    for (const std::string& list : names) edit_.append(list, quote_json(name));
  }
}

std::vector<std::size_t> MeshWriter::set_mark(const GltfBakeMark& mark) {
  const std::string text = gltf::bake_mark_json(mark).dump();
  edit_.set(pointer_ + "/extras/chronormal", text);
  std::vector<std::size_t> unmarked;
  for (std::size_t n = 0; n < document_.nodes().size() && !mark.extras.empty(); ++n) {
    if (document_.nodes()[n].mesh != shading_.mesh) continue;
    const std::string extras = std::string("/nodes/").append(std::to_string(n)).append("/extras");
    if (edit_.has(extras) && !edit_.text(extras).starts_with("{"))
      unmarked.push_back(n);
    else
      edit_.set(extras + "/chronormal", text);
  }
  return unmarked;
}

}  // namespace chronormal::inline internal
