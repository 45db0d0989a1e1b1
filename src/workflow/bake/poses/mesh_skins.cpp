// Reads skins, and leaves out skins that do not matter. A skin is examined at all times at which its joints or the
// weights have a key, and half-way between these times. Joints that rotate against each other squash a mesh most at
// their keys or half-way between keys.
#include "workflow/bake/poses/mesh_skins.h"

#include <algorithm>
#include <cstddef>
#include <set>
#include <utility>

namespace chronormal::inline internal {
namespace {

// kLookedAtPairs is the largest number of samples at which a skin is examined. A sample is a vertex at one time.
// kFewestInstants is the smallest number of times at which a skin is examined.
constexpr std::size_t kLookedAtPairs = 10000000, kFewestInstants = 64;

// Returns true if a skin deforms these vertices by more than a rotation and an even scale at some time at which a track
// is played.
bool is_uneven(MeshSkin skin, const WeightTrack& track, std::span<const std::uint32_t> vertices) {
  std::vector<double> times;
  const std::vector<double> keys = keys_of_both(track, skin);
  for (std::size_t k = 0; k < keys.size(); ++k) {
    if (k > 0) times.push_back((keys[k - 1] + keys[k]) / 2);
    times.push_back(keys[k]);
  }
  const std::size_t most = std::max(kFewestInstants, kLookedAtPairs / std::max<std::size_t>(1, vertices.size()));
  const std::size_t count = std::min(most, times.size());
  for (std::size_t n = 0; n < count; ++n) {
    const bool may_have_moved = skin.pose(times[n * times.size() / count], false);
    if ((n == 0 || may_have_moved) && !skin.is_even(vertices)) return true;
  }
  return false;
}

}  // namespace

std::vector<double> keys_of_both(const WeightTrack& track, const MeshSkin& skin) {
  std::vector<double> result = track.keys.times;
  for (const double time : skin.key_times())
    if (track.keys.times.front() < time && time < track.keys.times.back()) result.push_back(time);
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

void read_skins(const GltfDocument& document, const GltfShading& shading, std::span<const std::uint32_t> vertices,
                MeshWeights& weights) {
  const std::vector<GltfNode>& nodes = document.nodes();
  std::optional<MeshSkin> any;  // a skin that was read; further skins reuse its joints and shares
  const auto read = [&](std::size_t node, std::optional<std::size_t> animation) -> std::optional<MeshSkin> {
    Result<MeshSkin> skin = MeshSkin::read(document, shading, node, animation, any ? &*any : nullptr);
    if (!skin) return std::nullopt;
    if (!any) any = skin.value();
    return std::move(skin).value();
  };
  for (std::size_t t = 0; t < weights.tracks.size(); ++t) {
    const auto& [animation, keys] = weights.names[t];
    std::vector<std::optional<MeshSkin>>& skins = weights.skins.of_tracks.emplace_back();
    std::set<std::optional<std::uint32_t>> known;
    bool is_any_even = false;
    for (const GltfTrack& track : document.animations()[animation].tracks) {
      const GltfNode& node = nodes[track.node];
      if (node.mesh != shading.mesh || track.same_keys_as != keys) continue;
      std::optional<MeshSkin> skin;
      if (node.has_skin) {
        if (!known.insert(node.skin).second) continue;
        skin = read(track.node, animation);
        if (skin && !is_uneven(*skin, weights.tracks[t], vertices)) skin.reset();
      }
      if (skin)
        skins.push_back(std::move(skin));
      else
        is_any_even = true;
    }
    if (is_any_even) skins.emplace_back();
  }
  // Takes the skin with which an audit judges single targets: the skin of the first node that has a skin and this mesh.
  const auto first = std::find_if(nodes.begin(), nodes.end(),
                                  [&](const GltfNode& node) { return node.has_skin && node.mesh == shading.mesh; });
  if (first == nodes.end()) return;
  std::optional<MeshSkin> skin = read(static_cast<std::size_t>(first - nodes.begin()), std::nullopt);
  if (skin && !skin->is_even(vertices)) weights.skins.standing = std::move(skin);
}

}  // namespace chronormal::inline internal
