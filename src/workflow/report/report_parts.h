/// The parts of a report, as an input has them: one for each mesh of a glTF file that was judged, or one for another
/// motion. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_REPORT_REPORT_PARTS_H_
#define CHRONORMAL_WORKFLOW_REPORT_REPORT_PARTS_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/io/gltf_document.h"
#include "chronormal/io/input.h"
#include "chronormal/motion/motion.h"
#include "chronormal/workflow/compare.h"
#include "chronormal/workflow/viewers.h"
#include "workflow/report/report_model.h"
#include "workflow/report/watched_motions.h"

namespace chronormal::inline internal {

/// A mesh of a glTF file, with what `viewers` keep of its normals; right is what the author would see, or sums by a
/// weighting where one is asked for. Errors: of GltfDocument
[[nodiscard]] Result<ModelPart> gltf_part(const GltfDocument& document, std::size_t mesh,
                                          std::optional<Weighting> asked, std::span<const Viewer> viewers,
                                          WatchedPart watched);

/// The vertices of a motion in a report: a vertex of the file stands there once for each normal that it shows.
struct MotionVertices {
  std::vector<std::uint32_t> labels;             ///< their vertices in the file, ascending
  std::vector<std::uint32_t> elements, corners;  ///< of each; corners: one that shows it
  std::vector<std::uint32_t> of_corner;          ///< which of them each corner of the motion shows
  std::size_t element_count = 0;
};

/// Finds them. Errors: of NormalGroups
[[nodiscard]] Result<MotionVertices> motion_vertices(const Motion& motion, const StoredNormals& normals);

/// A motion that is no glTF file, with what a comparison of schemes on it found, with keep_samples at the samples of
/// the audit.
[[nodiscard]] ModelPart motion_part(const Motion& motion, const StoredNormals& normals, const MotionVertices& vertices,
                                    const Comparison& comparison, WatchedPart watched);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_REPORT_REPORT_PARTS_H_
