/// The weights that a file gives to one mesh. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_BAKE_POSES_MESH_WEIGHTS_H_
#define CHRONORMAL_WORKFLOW_BAKE_POSES_MESH_WEIGHTS_H_

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

/// The name of a track in a file: the index of its animation, and the index of the first track in this animation with
/// the same keys.
struct TrackName {
  std::size_t animation = 0, keys = 0;
  friend auto operator<=>(const TrackName&, const TrackName&) = default;
};

/// The skins by which nodes deform a mesh. Skins that only rotate and scale evenly are left out (mesh_skins.h).
struct MeshSkins {
  /// For each track, the skins of all nodes that the track drives. An entry is nullopt if its node has no skin that
  /// matters. The list is empty if no skin was read.
  std::vector<std::vector<std::optional<MeshSkin>>> of_tracks;
  std::optional<MeshSkin> standing;  ///< the skin of the first node that has one, as the file poses it

  [[nodiscard]] bool any() const;
  /// Returns the skin for poses that no animation plays, such as a single target at weight 1. Returns nullptr if there
  /// is no skin for these poses.
  [[nodiscard]] const MeshSkin* as_standing() const { return standing ? &*standing : nullptr; }
};

struct MeshWeights {
  std::vector<WeightTrack> tracks;  ///< the tracks of the animations; `use` refers to them
  std::vector<TrackName> names;     ///< the name of each track
  std::vector<TimeRange> ranges;    ///< the time range of each track's animation
  PoseList poses;                ///< poses that stand still: of the mesh, its nodes, and the expressions of an avatar
  std::size_t stored_poses = 0;  ///< the number of poses of the mesh and its nodes; those of expressions follow them
  WeightUse use;
  bool is_driven = false;  ///< true if an animation gives some moving target a weight
  /// The poses to which correction targets are fitted if no animation drives the mesh. Set only if a bake tries
  /// correction targets.
  std::optional<RigPoses> rig;
  MeshSkins skins = {};  ///< read_skins() sets these skins
};

/// Reads the weights that the animations of a file give to a mesh. Tracks with the same keys drive the mesh through
/// several nodes, and count as one track. Errors: those of reading tracks from the document.
[[nodiscard]] Result<MeshWeights> read_weights(const GltfDocument& document, const GltfShading& shading);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_POSES_MESH_WEIGHTS_H_
