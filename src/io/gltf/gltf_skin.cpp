// Computes a pose from the roots down to the joints. Each bone first gets its transform relative to its parent, in
// which animated parts come from their curves. The transform of the parent in the world is then applied to this
// transform.
#include "io/gltf/gltf_skin.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>
#include <utility>

#include "core/text.h"
#include "io/bytes/expansion.h"
#include "io/gltf/decode/gltf_draco.h"
#include "io/gltf/gltf_document_state.h"

namespace chronormal::inline internal {
namespace {

using Path = gltf::NodeChannel::Path;
using Quaternion = std::array<double, 4>;

constexpr std::uint32_t kNoBone = ~std::uint32_t{0};

// Scales a quaternion to length 1, and returns the identity for a quaternion of length 0.
Quaternion as_rotation(const Quaternion& q) {
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + (q[2] * q[2] + q[3] * q[3]));
  if (!(length > 0)) return {0, 0, 0, 1};
  return {q[0] / length, q[1] / length, q[2] / length, q[3] / length};
}

Vec3d vector_at(const gltf::WeightCurve& curve, double time, bool just_before) {
  std::array<double, 3> v{};
  curve.at(time, just_before, v);
  return {v[0], v[1], v[2]};
}

}  // namespace

Result<GltfSkin> GltfSkin::read(const GltfDocument& document, std::size_t node, std::optional<std::size_t> animation) {
  GltfDocument::State& state = *document.state_;
  const gltf::Model& model = state.model;
  const std::optional<std::uint32_t> index = model.nodes[node].skin;
  if (!index || *index >= model.skins.size())
    return invalid_input(state.bytes.place("/nodes/" + std::to_string(node) + "/skin"),
                         "the node refers to a skin that does not exist, since the file has only " +
                             counted(model.skins.size(), "skin", "skins") + "; export the file again");
  const gltf::SkinSource& source = model.skins[*index];
  if (source.fault) return *source.fault;
  GltfSkin skin;
  skin.joints_ = source.joints;
  skin.inverse_binds_.resize(source.joints.size());
  if (source.inverse_binds) {
    const Result<std::vector<float>> numbers = state.bytes.floats(*source.inverse_binds);
    if (!numbers) return numbers.error();
    for (std::size_t j = 0; j < source.joints.size(); ++j) {
      const float* const m = numbers.value().data() + 16 * j;
      if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1)
        return invalid_input(
            state.bytes.accessor_place(*source.inverse_binds),
            "the last row of matrix " + std::to_string(j) + " must be 0, 0, 0, 1; export the file again");
      const auto column = [m](std::size_t c) { return to_double(Vec3f{m[4 * c], m[4 * c + 1], m[4 * c + 2]}); };
      skin.inverse_binds_[j] = {{column(0), column(1), column(2)}, column(3)};
    }
  }
  skin.add_bones(document);
  if (!animation) return skin;
  const gltf::NodeChannels& moving = model.node_channels[*animation];
  if (moving.fault) return *moving.fault;
  for (const gltf::NodeChannel& channel : moving.channels) {
    if (skin.bone_of_node_[channel.node] == kNoBone) continue;
    if (const Status status = skin.add_curve(document, channel); !status) return status.error();
  }
  return skin;
}

void GltfSkin::add_bones(const GltfDocument& document) {
  const gltf::Model& model = document.state_->model;
  bone_of_node_.assign(model.nodes.size(), kNoBone);
  for (const std::uint32_t joint : joints_) {
    // The nodes from the joint upwards that are not bones yet.
    std::vector<std::uint32_t> path;
    for (std::optional<std::uint32_t> at = joint; at && bone_of_node_[*at] == kNoBone; at = model.nodes[*at].parent)
      path.push_back(*at);
    for (auto at = path.rbegin(); at != path.rend(); ++at) {
      const std::optional<std::uint32_t> parent = model.nodes[*at].parent;
      bone_of_node_[*at] = static_cast<std::uint32_t>(bones_.size());
      bones_.push_back(
          {gltf::placement_of(model, *at), parent ? std::optional<std::size_t>(bone_of_node_[*parent]) : std::nullopt});
    }
    bone_of_joint_.push_back(bone_of_node_[joint]);
  }
}

Status GltfSkin::add_curve(const GltfDocument& document, const gltf::NodeChannel& channel) {
  gltf::Bytes& bytes = document.state_->bytes;
  const Result<std::vector<float>> times = bytes.times(channel.input);
  if (!times) return times.error();
  const Result<std::vector<float>> values = bytes.floats(channel.output);
  if (!values) return values.error();
  GltfKeys keys{{times.value().begin(), times.value().end()}, {values.value().begin(), values.value().end()}};
  const std::size_t width = channel.path == Path::kRotation ? 4 : 3;
  curves_.push_back({bone_of_node_[channel.node], channel.path, channel.interpolation,
                     gltf::WeightCurve(std::move(keys), channel.interpolation, width)});
  return Success{};
}

Status GltfSkin::read_shares(const GltfDocument& document, std::size_t mesh, std::size_t primitive,
                             std::vector<std::size_t>& first, std::vector<JointShare>& shares) const {
  GltfDocument::State& state = *document.state_;
  const gltf::PrimitiveSource& source = state.model.sources[mesh][primitive];
  const std::size_t vertices = state.model.meshes[mesh].primitives[primitive].vertex_count;
  const std::string pointer = gltf::primitive_pointer(mesh, primitive) + "/attributes";
  if (source.influence_fault) return *source.influence_fault;
  const std::vector<gltf::InfluenceSource>& sets = source.influences;
  if (sets.empty())
    return invalid_input(state.bytes.place(pointer),
                         "the mesh has a skin, but its vertices have no joints (JOINTS_0); export the file again");
  // All sets of joints and weights may use the same accessor, so a small file could ask for much memory. The limit of
  // expansion is therefore checked.
  constexpr std::uint64_t kOfVertex = 4 * (2 * sizeof(float) + sizeof(JointShare));
  const std::uint64_t most = std::numeric_limits<std::uint64_t>::max() / kOfVertex / sets.size();
  if (Status status = state.bytes.expansion().check(
          vertices <= most ? kOfVertex * sets.size() * vertices : std::numeric_limits<std::uint64_t>::max(),
          state.bytes.place(pointer));
      !status)
    return status;
  std::vector<std::vector<float>> joints(sets.size()), weights(sets.size());
  // One compressed mesh may contain several sets of joints and weights. All sets in a compressed mesh are decoded
  // together.
  std::vector<gltf::AttributeSource> compressed;
  std::vector<std::pair<std::string, std::vector<float>*>> of_compressed;
  for (std::size_t n = 0; n < sets.size(); ++n) {
    for (const auto& [key, attribute, result] :
         {std::tuple("JOINTS_", sets[n].joints, &joints[n]), {"WEIGHTS_", sets[n].weights, &weights[n]}}) {
      if (attribute.draco) {
        compressed.push_back(attribute);
        of_compressed.emplace_back(key + std::to_string(n), result);
        continue;
      }
      Result<std::vector<float>> numbers = state.bytes.floats(attribute.accessor);
      if (!numbers) return numbers.error();
      *result = std::move(numbers).value();
    }
  }
  if (!compressed.empty()) {
    const Result<gltf::View> view = state.bytes.view(source.draco->view);
    if (!view) return view.error();
    const std::string extension =
        state.bytes.place(gltf::primitive_pointer(mesh, primitive) + "/extensions/KHR_draco_mesh_compression");
    Result<std::vector<std::vector<float>>> decoded = gltf::decode_draco_attributes(
        view.value().bytes, state.model, vertices, compressed, state.bytes.expansion(), extension,
        [&](std::size_t n) { return extension + "/attributes/" + of_compressed[n].first; });
    if (!decoded) return decoded.error();
    for (std::size_t n = 0; n < compressed.size(); ++n) *of_compressed[n].second = std::move(decoded.value()[n]);
  }
  for (std::size_t v = 0; v < vertices; ++v) {
    first.push_back(shares.size());
    double sum = 0;
    for (const std::vector<float>& of_set : weights)
      for (std::size_t i = 4 * v; i < 4 * v + 4; ++i) sum += static_cast<double>(of_set[i]);
    const bool is_any = sum > 0;
    for (std::size_t n = 0; n < sets.size(); ++n) {
      for (std::size_t i = 4 * v; i < 4 * v + 4; ++i) {
        const bool is_first = n == 0 && i == 4 * v;
        const double share = is_any ? static_cast<double>(weights[n][i]) / sum : is_first ? 1 : 0;
        if (share == 0) continue;
        const auto joint = static_cast<std::uint32_t>(joints[n][i]);
        if (joint >= joints_.size())
          return invalid_input(state.bytes.place(pointer + "/JOINTS_" + std::to_string(n)),
                               "vertex " + std::to_string(v) + " follows joint " + std::to_string(joint) +
                                   ", but the skin has only " + counted(joints_.size(), "joint", "joints") +
                                   "; export the file again");
        shares.push_back({joint, share});
      }
    }
  }
  return Success{};
}

std::vector<double> GltfSkin::key_times() const {
  std::vector<double> result;
  for (const Curve& moving : curves_)
    result.insert(result.end(), moving.curve.times().begin(), moving.curve.times().end());
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

std::array<double, 4> GltfSkin::rotation_at(const Curve& moving, double time, bool just_before) {
  const gltf::WeightCurve& curve = moving.curve;
  Quaternion rotation;
  const auto times = curve.times();
  const auto after = std::upper_bound(times.begin(), times.end(), time);
  if (moving.interpolation != GltfInterpolation::kLinear || after == times.begin() || after == times.end()) {
    curve.at(time, just_before, rotation);
    return as_rotation(rotation);
  }
  NodeTransform from, to;
  curve.at(*(after - 1), false, from.rotation);
  curve.at(*after, false, to.rotation);
  from.rotation = as_rotation(from.rotation);
  to.rotation = as_rotation(to.rotation);
  return interpolated(from, to, (time - *(after - 1)) / (*after - *(after - 1))).rotation;
}

std::vector<AffineTransform> GltfSkin::pose(double time, bool just_before) const {
  std::vector<gltf::Placement> placements;
  placements.reserve(bones_.size());
  for (const Bone& bone : bones_) placements.push_back(bone.placement);
  for (const Curve& moving : curves_) {
    auto& node = std::get<NodeTransform>(placements[moving.bone]);
    switch (moving.path) {
      case Path::kTranslation:
        node.translation = vector_at(moving.curve, time, just_before);
        break;
      case Path::kRotation:
        node.rotation = rotation_at(moving, time, just_before);
        break;
      case Path::kScale:
        node.scale = vector_at(moving.curve, time, just_before);
        break;
    }
  }
  std::vector<AffineTransform> in_world;
  in_world.reserve(bones_.size());
  for (std::size_t b = 0; b < bones_.size(); ++b) {
    const AffineTransform in_parent = gltf::transform_of(placements[b]);
    in_world.push_back(bones_[b].parent ? composed(in_world[*bones_[b].parent], in_parent) : in_parent);
  }
  std::vector<AffineTransform> result;
  result.reserve(joints_.size());
  for (std::size_t j = 0; j < joints_.size(); ++j)
    result.push_back(composed(in_world[bone_of_joint_[j]], inverse_binds_[j]));
  return result;
}

}  // namespace chronormal::inline internal
