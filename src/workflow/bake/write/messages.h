/// Texts that a bake writes: warnings for people, and a file that tells programs how to drive correction targets.
/// Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_BAKE_WRITE_MESSAGES_H_
#define CHRONORMAL_WORKFLOW_BAKE_WRITE_MESSAGES_H_

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "workflow/bake/deltas/plan.h"
#include "workflow/shading/gltf_shading.h"

namespace chronormal::inline internal {

/// Returns the name of a correction target in a mesh whose targets have names: "chronormal w0*w1".
[[nodiscard]] std::string name_of_extra(const GltfExtraTarget& extra);

/// Writes how to drive the correction targets of all meshes, as the text of a file (docs/formats.md).
[[nodiscard]] std::string drivers_file(const GltfDocument& document, const std::vector<BakedMesh>& meshes);

/// A warning about one mesh.
struct MeshWarning {
  std::string mesh, sentence;
};
/// Returns warnings as text, "MESH: sentence". A sentence that applies to several meshes appears once, with all their
/// names.
[[nodiscard]] std::vector<std::string> said_once(const std::vector<MeshWarning>& warnings);

/// Adds a sentence for primitives that stay flat, if there are any.
void warn_of_flat(const GltfMesh& mesh, const BakedMesh& baked, std::vector<MeshWarning>& warnings);
/// Adds a sentence if float32 cannot hold the weights of a mesh's correction targets. `error` is the error of its
/// tracks.
void warn_of_track(const GltfMesh& mesh, const BakedMesh& baked, double error, std::vector<MeshWarning>& warnings);
/// Adds a sentence if no candidate for a mesh is within the tolerance and the limits.
void warn_of_choice(const GltfMesh& mesh, const BakeOptions& options, const BakedMesh& baked,
                    std::vector<MeshWarning>& warnings);
/// Adds a sentence for everything else that was baked in an unexpected way.
void warn_of_baked(const GltfMesh& mesh, const GltfShading& shading, const MeshPlan& plan, const BakeOptions& options,
                   const BakedMesh& baked, std::vector<MeshWarning>& warnings);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_WRITE_MESSAGES_H_
