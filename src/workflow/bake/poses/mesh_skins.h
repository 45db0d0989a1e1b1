/// The skins by which the nodes of a file deform one mesh, if they matter to the choice of a bake. Private to workflow.
///
/// A skin matters if it changes errors. A rotation with an even scale leaves the angle between two normals as it is, so
/// a skin that does no more to any of the vertices is left out.
#ifndef CHRONORMAL_WORKFLOW_BAKE_MESH_SKINS_H_
#define CHRONORMAL_WORKFLOW_BAKE_MESH_SKINS_H_

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "chronormal/io/gltf_document.h"
#include "workflow/bake/poses/mesh_weights.h"
#include "workflow/shading/gltf_shading.h"
#include "workflow/shading/mesh_skin.h"

namespace chronormal::inline internal {

/// Returns the times of all keys of a track, and of the keys of a skin's joints while the track is played: ascending,
/// each once.
[[nodiscard]] std::vector<double> keys_of_both(const WeightTrack& track, const MeshSkin& skin);

/// Reads the skins of all nodes of a mesh into weights.skins, for the given vertices. A skin that cannot be read is
/// left out; an audit reports why.
void read_skins(const GltfDocument& document, const GltfShading& shading, std::span<const std::uint32_t> vertices,
                MeshWeights& weights);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_MESH_SKINS_H_
