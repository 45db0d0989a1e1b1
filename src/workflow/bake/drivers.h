/// What has to drive the extra targets of a bake, for hosts and for people. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_BAKE_DRIVERS_H_
#define CHRONORMAL_WORKFLOW_BAKE_DRIVERS_H_

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "chronormal/workflow/bake.h"

namespace chronormal {

/// The name of an extra target in a mesh whose targets have names: "chronormal w0*w1".
[[nodiscard]] std::string name_of_extra(const GltfExtraTarget& extra);

/// What a host must compute for the extra targets of a mesh.
[[nodiscard]] nlohmann::ordered_json drivers_of(const GltfMesh& mesh, const BakedMesh& baked);
/// The same of several meshes as the text of a file; empty for none.
[[nodiscard]] std::string drivers_file(const std::vector<nlohmann::ordered_json>& of_meshes);

}  // namespace chronormal

#endif  // CHRONORMAL_WORKFLOW_BAKE_DRIVERS_H_
