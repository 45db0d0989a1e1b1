/// Leaves out data of a report that would make the report too large. Private to workflow.
///
///     keyframes   Some segments are left out, evenly over the motion. Worst places keep the keyframes of their
///                 segments and of the neighbouring segments.
///     samples     In glTF files, samples are left out, evenly over each motion. Worst places keep their samples.
///     triangles   Triangles far from the worst places become fewer, by quadrics (Garland and Heckbert 1997, as in
///                 meshoptimizer), and are not judged. Triangles around the worst places stay, as long as half of the
///                 vertices suffice.
///
/// An element is judged only if all data on which its true normal depends are left: its faces and polygons with all of
/// their vertices, and its edges. For this reason the normals of a worst place do not change.
#ifndef CHRONORMAL_WORKFLOW_REPORT_THINNING_H_
#define CHRONORMAL_WORKFLOW_REPORT_THINNING_H_

#include <cstddef>

#include "workflow/report/report_model.h"

namespace chronormal::inline internal {

/// Returns the size, in bytes, of all arrays of a report together.
[[nodiscard]] std::size_t bytes_of(const ReportModel& model);

/// Leaves out data of a model until its arrays have about most_bytes bytes, or until only required data are left. Lists
/// in model.thinned what was left out. May be called once for a model.
void thin_out(ReportModel& model, std::size_t most_bytes);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_REPORT_THINNING_H_
