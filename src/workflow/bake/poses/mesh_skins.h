/// Finds the skins that matter when a bake chooses deltas. Each skin belongs to a node of the file that has the mesh.
/// Private to workflow.
///
/// A skin matters if it changes errors. A rotation with an even scale keeps the angle between two normals. A skin that
/// only rotates all vertices and scales them evenly is left out.
#ifndef CHRONORMAL_WORKFLOW_BAKE_POSES_MESH_SKINS_H_
#define CHRONORMAL_WORKFLOW_BAKE_POSES_MESH_SKINS_H_

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "chronormal/io/gltf_document.h"
#include "workflow/bake/poses/mesh_weights.h"
#include "workflow/shading/gltf_shading.h"
#include "workflow/shading/mesh_skin.h"

namespace chronormal::inline internal {

/// Returns the times of all keys of a track, and of all keys of a skin's joints while the track is played. The times
/// are in seconds and in ascending order, without repetitions.
[[nodiscard]] std::vector<double> keys_of_both(const WeightTrack& track, const MeshSkin& skin);

/// Reads the skins of all nodes of a mesh into weights.skins, as far as they deform the given vertices. Leaves out a
/// skin that cannot be read, because an audit reports the reason.
void read_skins(const GltfDocument& document, const GltfShading& shading, std::span<const std::uint32_t> vertices,
                MeshWeights& weights);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_POSES_MESH_SKINS_H_
