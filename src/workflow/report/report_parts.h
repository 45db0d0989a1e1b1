/// Builds the parts of a report from an input. There is a part for each judged mesh of a glTF file, or one part for any
/// other motion. Private to workflow.
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

/// Builds the part of a glTF mesh, with its normals as `viewers` store them. The true normals are sums by the weighting
/// `asked`. If no weighting is asked for, the true normals follow the normals of the author. Errors: those of reading
/// the document.
[[nodiscard]] Result<ModelPart> gltf_part(const GltfDocument& document, std::size_t mesh,
                                          std::optional<Weighting> asked, std::span<const Viewer> viewers,
                                          WatchedPart watched);

/// The vertices that a report has for a motion. If a vertex of the file shows several normals, the report has a vertex
/// for each of these normals.
struct MotionVertices {
  std::vector<std::uint32_t> labels;     ///< the vertex of the file for each vertex, in ascending order
  std::vector<std::uint32_t> elements;   ///< for each vertex, its element
  std::vector<std::uint32_t> corners;    ///< for each vertex, one corner of the motion that uses it
  std::vector<std::uint32_t> of_corner;  ///< for each corner of the motion, its vertex in the report
  std::size_t element_count = 0;
};

/// Finds the vertices that a report has for a motion. Errors: those of NormalGroups.
[[nodiscard]] Result<MotionVertices> motion_vertices(const Motion& motion, const StoredNormals& normals);

/// Builds the part of a motion that is not a glTF file. `comparison` has the errors of schemes in this motion. The
/// comparison must have been made with keep_samples, at the samples of the audit.
[[nodiscard]] ModelPart motion_part(const Motion& motion, const StoredNormals& normals, const MotionVertices& vertices,
                                    const Comparison& comparison, WatchedPart watched);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_REPORT_REPORT_PARTS_H_
