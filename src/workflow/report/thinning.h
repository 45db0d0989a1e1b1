/// Leaves out parts of a report that would make it too large. Private to workflow.
///
///     keyframes   of segments, evenly over the motion; worst places keep their keyframes, and the segments beside them
///     samples     of glTF files, evenly over each motion; worst places keep their samples
///     triangles   far from the worst places become fewer, by quadrics (Garland and Heckbert 1997, as in
///                 meshoptimizer), and are not judged; those around the worst places stay, as long as half of the
///                 vertices suffice
///
/// An element is judged if all parts that its true normal depends on are left: its faces and polygons with all of their
/// vertices, and its edges. So the normals of a worst place do not change.
#ifndef CHRONORMAL_WORKFLOW_REPORT_THINNING_H_
#define CHRONORMAL_WORKFLOW_REPORT_THINNING_H_

#include <cstddef>

#include "workflow/report/report_model.h"

namespace chronormal::inline internal {

/// Returns the size of all arrays in bytes.
[[nodiscard]] std::size_t bytes_of(const ReportModel& model);

/// Thins out a model until its arrays have about this many bytes, if the required parts allow it, and lists in
/// model.thinned what was left out. A model may be thinned out once.
void thin_out(ReportModel& model, std::size_t most_bytes);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_REPORT_THINNING_H_
