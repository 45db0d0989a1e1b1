/// What a person should know of a baked mesh, in sentences. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_BAKE_WARNINGS_H_
#define CHRONORMAL_WORKFLOW_BAKE_WARNINGS_H_

#include <string>
#include <vector>

#include "workflow/bake/plan.h"
#include "workflow/shading/gltf_shading.h"

namespace chronormal {

/// Adds a sentence for primitives that stay flat, if there are any.
void warn_of_flat(const GltfMesh& mesh, const BakedMesh& baked, std::vector<std::string>& warnings);

/// Adds a sentence for everything else that was baked otherwise than somebody might think.
void warn_of_baked(const GltfMesh& mesh, const GltfShading& shading, const MeshPlan& plan, const BakeOptions& options,
                   const BakedMesh& baked, std::vector<std::string>& warnings);

}  // namespace chronormal

#endif  // CHRONORMAL_WORKFLOW_BAKE_WARNINGS_H_
