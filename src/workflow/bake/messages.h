/// What a bake tells people and hosts: warnings, and what has to drive its extra targets. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_BAKE_MESSAGES_H_
#define CHRONORMAL_WORKFLOW_BAKE_MESSAGES_H_

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "workflow/bake/plan.h"
#include "workflow/shading/gltf_shading.h"

namespace chronormal::inline internal {

/// The name of an extra target in a mesh whose targets have names: "chronormal w0*w1".
[[nodiscard]] std::string name_of_extra(const GltfExtraTarget& extra);

/// What a host must compute for the extra targets of a mesh.
[[nodiscard]] nlohmann::ordered_json drivers_of(const GltfMesh& mesh, const BakedMesh& baked);
/// The same of several meshes as the text of a file; empty for none.
[[nodiscard]] std::string drivers_file(const std::vector<nlohmann::ordered_json>& of_meshes);

/// A sentence about a mesh.
struct MeshWarning {
  std::string mesh, sentence;
};
/// The same as text, "MESH: sentence"; what holds for several meshes is said once, of all of them.
[[nodiscard]] std::vector<std::string> said_once(const std::vector<MeshWarning>& warnings);

/// Adds a sentence for primitives that stay flat, if there are any.
void warn_of_flat(const GltfMesh& mesh, const BakedMesh& baked, std::vector<MeshWarning>& warnings);
/// Adds a sentence for everything else that was baked otherwise than somebody might think.
void warn_of_baked(const GltfMesh& mesh, const GltfShading& shading, const MeshPlan& plan, const BakeOptions& options,
                   const BakedMesh& baked, std::vector<MeshWarning>& warnings);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_MESSAGES_H_
