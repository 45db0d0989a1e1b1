/// The mark that a bake leaves in extras.chronormal (docs/formats.md): written and read here. Private to io and
/// workflow.
#ifndef CHRONORMAL_IO_GLTF_MODEL_GLTF_BAKE_MARK_H_
#define CHRONORMAL_IO_GLTF_MODEL_GLTF_BAKE_MARK_H_

#include <nlohmann/json.hpp>
#include <string>

#include "chronormal/io/gltf_document.h"

namespace chronormal::inline internal::gltf {

/// Sets mesh.mark where there is one, or mesh.mark_fault where there is one that makes no sense. Extras are anyone's:
/// they never make a file unreadable. pointer is that of the mesh, name that of the file; mesh has its target_count.
void read_bake_mark(const nlohmann::json& document, const std::string& pointer, const std::string& name,
                    GltfMesh& mesh);

/// A mark as it is written, by version 2.
[[nodiscard]] nlohmann::ordered_json bake_mark_json(const GltfBakeMark& mark);

}  // namespace chronormal::inline internal::gltf

#endif  // CHRONORMAL_IO_GLTF_MODEL_GLTF_BAKE_MARK_H_
