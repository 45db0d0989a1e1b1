/// Writes the texts of a bake: warnings for people, and a file that tells programs how to drive correction targets.
/// Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_BAKE_WRITE_MESSAGES_H_
#define CHRONORMAL_WORKFLOW_BAKE_WRITE_MESSAGES_H_

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "workflow/bake/deltas/plan.h"
#include "workflow/shading/gltf_shading.h"

namespace chronormal::inline internal {

/// Returns the name of a correction target, such as "chronormal w0*w1". The name is used in meshes whose targets have
/// names.
[[nodiscard]] std::string name_of_extra(const GltfExtraTarget& extra);

/// Returns the text of a file that tells programs how to drive the correction targets of all meshes (docs/formats.md).
[[nodiscard]] std::string drivers_file(const GltfDocument& document, const std::vector<BakedMesh>& meshes);

/// A warning about one mesh, as a sentence.
struct MeshWarning {
  std::string mesh, sentence;
};
/// Returns warnings as text, in the form "MESH: sentence". A sentence that applies to several meshes appears once, with
/// the names of all these meshes.
[[nodiscard]] std::vector<std::string> said_once(const std::vector<MeshWarning>& warnings);

/// Adds a warning if primitives of the mesh keep flat shading.
void warn_of_flat(const GltfMesh& mesh, const BakedMesh& baked, std::vector<MeshWarning>& warnings);
/// Adds a warning if float32 cannot hold the weights of a mesh's correction targets. `error` is the mesh's entry in
/// WrittenTracks::errors, in radians.
void warn_of_track(const GltfMesh& mesh, const BakedMesh& baked, double error, std::vector<MeshWarning>& warnings);
/// Adds a warning if no candidate for a mesh is within the tolerance and the limits.
void warn_of_choice(const GltfMesh& mesh, const BakeOptions& options, const BakedMesh& baked,
                    std::vector<MeshWarning>& warnings);
/// Adds all other warnings about a baked mesh: facts that the user may not expect.
void warn_of_baked(const GltfMesh& mesh, const GltfShading& shading, const MeshPlan& plan, const BakeOptions& options,
                   const BakedMesh& baked, std::vector<MeshWarning>& warnings);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_WRITE_MESSAGES_H_
