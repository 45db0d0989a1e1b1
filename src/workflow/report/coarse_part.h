/// Makes a part (a mesh) of a report coarser. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_REPORT_COARSE_PART_H_
#define CHRONORMAL_WORKFLOW_REPORT_COARSE_PART_H_

#include <cstddef>

#include "workflow/report/report_model.h"

namespace chronormal::inline internal {

/// Reduces a part of a report to about most_vertices vertices. Half of these vertices lie around its worst places,
/// where all triangles stay. The other half is for all other places, where triangles become larger. The elements of the
/// worst places are kept even if they need more vertices. Renumbers vertices and elements, also those of the worst
/// places in the model. The part must have no coarse triangles yet.
void make_coarse(ReportModel& model, std::size_t part, std::size_t most_vertices);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_REPORT_COARSE_PART_H_
