/// The weights that a file gives to one mesh. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_BAKE_MESH_WEIGHTS_H_
#define CHRONORMAL_WORKFLOW_BAKE_MESH_WEIGHTS_H_

#include <cstddef>
#include <optional>
#include <vector>

#include "chronormal/core/result.h"
#include "workflow/shading/gltf_shading.h"
#include "workflow/shading/mesh_skin.h"
#include "workflow/shading/rig_poses.h"
#include "workflow/shading/target_weights.h"
#include "workflow/viewers/played_track.h"

namespace chronormal::inline internal {

/// The name of a track in a file: the animation, and the first of its tracks with the same keys.
struct TrackName {
  std::size_t animation = 0, keys = 0;
  friend auto operator<=>(const TrackName&, const TrackName&) = default;
};

/// The skins by which nodes deform a mesh, except skins that only rotate and scale evenly (mesh_skins.h).
struct MeshSkins {
  /// For each track, the skins of all nodes that it drives; nullopt for nodes without such a skin. Empty if no skin was
  /// read.
  std::vector<std::vector<std::optional<MeshSkin>>> of_tracks;
  std::optional<MeshSkin> standing;  ///< of the first node that has a skin, as the file poses it

  [[nodiscard]] bool any() const;
  /// Returns the skin for poses that no animation plays, such as a single target at weight 1, or nullptr.
  [[nodiscard]] const MeshSkin* as_standing() const { return standing ? &*standing : nullptr; }
};

struct MeshWeights {
  std::vector<WeightTrack> tracks;  ///< of the animations; `use` refers to them
  std::vector<TrackName> names;     ///< of each track
  std::vector<TimeRange> ranges;    ///< of the animation of each track
  PoseList poses;                   ///< that stand still: of the mesh, its nodes, and the expressions of an avatar
  std::size_t stored_poses = 0;     ///< how many poses, the first ones, have weights of correction targets in the file
  WeightUse use;
  bool is_driven = false;       ///< an animation gives some moving target a weight
  std::optional<RigPoses> rig;  ///< the poses to fit to, if nothing drives the mesh and a bake tries correction targets
  MeshSkins skins = {};         ///< set by read_skins()
};

/// Reads the weights of a mesh. Tracks with the same keys, which drive the mesh through several nodes, count once.
/// Errors: see GltfDocument
[[nodiscard]] Result<MeshWeights> read_weights(const GltfDocument& document, const GltfShading& shading);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_MESH_WEIGHTS_H_
