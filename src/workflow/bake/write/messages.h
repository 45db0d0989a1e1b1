/// What a bake tells people and viewers: warnings, and what has to drive its extra targets. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_BAKE_WRITE_MESSAGES_H_
#define CHRONORMAL_WORKFLOW_BAKE_WRITE_MESSAGES_H_

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "workflow/bake/deltas/plan.h"
#include "workflow/shading/gltf_shading.h"

namespace chronormal::inline internal {

/// The name of an extra target in a mesh whose targets have names: "chronormal w0*w1".
[[nodiscard]] std::string name_of_extra(const GltfExtraTarget& extra);

/// What drives the extra targets of all meshes, as the text of a file (docs/formats.md).
[[nodiscard]] std::string drivers_file(const GltfDocument& document, const std::vector<BakedMesh>& meshes);

/// A sentence about a mesh.
struct MeshWarning {
  std::string mesh, sentence;
};
/// The same as text, "MESH: sentence"; what holds for several meshes is said once, of all of them.
[[nodiscard]] std::vector<std::string> said_once(const std::vector<MeshWarning>& warnings);

/// Adds a sentence for primitives that stay flat, if there are any.
void warn_of_flat(const GltfMesh& mesh, const BakedMesh& baked, std::vector<MeshWarning>& warnings);
/// Adds a sentence where float32 cannot hold what drives the extra targets of a mesh; error is that of its tracks.
void warn_of_track(const GltfMesh& mesh, const BakedMesh& baked, double error, std::vector<MeshWarning>& warnings);
/// Adds a sentence where no candidate for a mesh is within the tolerance and the limits.
void warn_of_choice(const GltfMesh& mesh, const BakeOptions& options, const BakedMesh& baked,
                    std::vector<MeshWarning>& warnings);
/// Adds a sentence for everything else that was baked otherwise than somebody might think.
void warn_of_baked(const GltfMesh& mesh, const GltfShading& shading, const MeshPlan& plan, const BakeOptions& options,
                   const BakedMesh& baked, std::vector<MeshWarning>& warnings);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_WRITE_MESSAGES_H_
