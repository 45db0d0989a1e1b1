/// The parts of a report, as an input has them: one for each mesh of a glTF file that was judged, or one for another motion.
/// Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_REPORT_REPORT_PARTS_H_
#define CHRONORMAL_WORKFLOW_REPORT_REPORT_PARTS_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/io/gltf_document.h"
#include "chronormal/workflow/hosts.h"
#include "workflow/report/report_model.h"
#include "workflow/report/watched_motions.h"

namespace chronormal::inline internal {

/// A mesh of a glTF file, with what `hosts` keep of its normals. Errors: of GltfDocument
[[nodiscard]] Result<ModelPart> gltf_part(const GltfDocument& document, std::size_t mesh, std::span<const Host> hosts,
                                          WatchedPart watched);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_REPORT_REPORT_PARTS_H_
