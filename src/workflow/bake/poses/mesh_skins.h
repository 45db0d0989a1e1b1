/// The skins by which the nodes of a file deform one mesh, as far as they matter to the choice of a bake. Private to
/// workflow.
///
/// If a blended matrix turns and scales evenly, errors are the same on both sides of it. So a skin that does no more
/// than that to any vertex in question is left out, and changes neither results nor choices.
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

/// Returns the times at which a track or the joints of a skin have a key while the track is played, ascending, each
/// once.
[[nodiscard]] std::vector<double> keys_of_both(const WeightTrack& track, const MeshSkin& skin);

/// Reads into weights.skins what the skins of all nodes of a mesh do to some of its vertices. A skin that cannot be
/// read is left out: audit says why.
void read_skins(const GltfDocument& document, const GltfShading& shading, std::span<const std::uint32_t> vertices,
                MeshWeights& weights);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_MESH_SKINS_H_
