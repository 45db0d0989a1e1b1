/// Leaves parts of a report out that would make it too large. Private to workflow.
///
///     keyframes   of segments evenly over the motion; those of the worst places stay, with the segments beside them
///     samples     of glTF files evenly over each motion; those of the worst places stay
///     triangles   around the worst places all stay, as far as half of the vertices go; the others become fewer, by
///                 quadrics (Garland and Heckbert 1997, as meshoptimizer has them), and are not judged
///
/// An element is judged where all that its right normal is made of is there: its faces and its polygons with all of their
/// vertices, and its edges. So what the normals of a worst place depend on is as it was.
#ifndef CHRONORMAL_WORKFLOW_REPORT_THINNING_H_
#define CHRONORMAL_WORKFLOW_REPORT_THINNING_H_

#include <cstddef>

#include "workflow/report/report_model.h"

namespace chronormal::inline internal {

/// The bytes of all arrays.
[[nodiscard]] std::size_t bytes_of(const ReportModel& model);

/// Thins a model out until its arrays have about so many bytes, as far as what stays allows; says in model.thinned what
/// was left out. A model may be thinned out once.
void thin_out(ReportModel& model, std::size_t most_bytes);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_REPORT_THINNING_H_
