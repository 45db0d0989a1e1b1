#include "workflow/bake/poses/mesh_weights.h"

#include <algorithm>
#include <set>
#include <utility>

namespace chronormal::inline internal {

bool MeshSkins::any() const {
  return standing || std::any_of(of_tracks.begin(), of_tracks.end(), [](const auto& skins) {
           return std::any_of(skins.begin(), skins.end(), [](const auto& skin) { return skin.has_value(); });
         });
}

Result<MeshWeights> read_weights(const GltfDocument& document, const GltfShading& shading) {
  const std::size_t mesh = shading.mesh, targets = document.meshes()[mesh].target_count;
  MeshWeights weights{{}, {}, {}, {}, 0, WeightUse(targets), false, {}};
  for (std::size_t a = 0; a < document.animations().size(); ++a) {
    std::set<std::size_t> seen;
    const std::vector<GltfTrack>& tracks = document.animations()[a].tracks;
    for (std::size_t t = 0; t < tracks.size(); ++t) {
      if (document.nodes()[tracks[t].node].mesh != mesh || !seen.insert(tracks[t].same_keys_as).second) continue;
      Result<GltfKeys> keys = document.keys(a, t);
      if (!keys) return keys.error();
      const Result<TimeRange> range = weight_time_range(document, a);
      if (!range) return range.error();
      weights.tracks.push_back({tracks[t].interpolation, std::move(keys).value(), targets});
      weights.names.push_back({a, tracks[t].same_keys_as});
      weights.ranges.push_back(range.value());
    }
  }
  for (const WeightTrack& track : weights.tracks) weights.use.add_track(track);
  for (std::size_t i = 0; i < targets; ++i)
    weights.is_driven |= !shading.set.targets[i].vertices.empty() && weights.use.together(i, i);
  weights.poses.push_back(document.meshes()[mesh].weights);
  for (const GltfNode& node : document.nodes())
    if (node.mesh == mesh && !node.weights.empty()) weights.poses.push_back(node.weights);
  weights.stored_poses = weights.poses.size();
  for (const GltfExpression& expression : document.meshes()[mesh].expressions)
    weights.poses.push_back(expression.weights);
  for (const std::vector<double>& pose : weights.poses) weights.use.add_pose(pose);
  return weights;
}

}  // namespace chronormal::inline internal
