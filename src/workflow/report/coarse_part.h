/// Makes a part of a report coarser. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_REPORT_COARSE_PART_H_
#define CHRONORMAL_WORKFLOW_REPORT_COARSE_PART_H_

#include <cstddef>

#include "workflow/report/report_model.h"

namespace chronormal::inline internal {

/// Reduces a part to about this many vertices: half of them around its worst places, with all triangles there, and half
/// for the other places, which become coarse. The worst places keep their neighbourhoods even if these need more
/// vertices. Numbers in the model are updated. The part must have no coarse triangles yet.
void make_coarse(ReportModel& model, std::size_t part, std::size_t most_vertices);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_REPORT_COARSE_PART_H_
