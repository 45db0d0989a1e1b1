/// Reads and writes the mark that a bake leaves in extras.chronormal (docs/formats.md). Private to io and workflow.
#ifndef CHRONORMAL_IO_GLTF_MODEL_GLTF_BAKE_MARK_H_
#define CHRONORMAL_IO_GLTF_MODEL_GLTF_BAKE_MARK_H_

#include <nlohmann/json.hpp>
#include <string>

#include "chronormal/io/gltf_document.h"

namespace chronormal::inline internal::gltf {

/// Sets mesh.mark if there is a mark, or mesh.mark_fault if the mark makes no sense. Anyone may write extras, so a
/// wrong mark never makes a file unreadable. `pointer` is the JSON pointer of the mesh, and `name` the name of the
/// file. mesh.target_count must be set before the call.
void read_bake_mark(const nlohmann::json& document, const std::string& pointer, const std::string& name,
                    GltfMesh& mesh);

/// Returns the mark of a bake as JSON, in version 2 of the mark.
[[nodiscard]] nlohmann::ordered_json bake_mark_json(const GltfBakeMark& mark);

}  // namespace chronormal::inline internal::gltf

#endif  // CHRONORMAL_IO_GLTF_MODEL_GLTF_BAKE_MARK_H_
