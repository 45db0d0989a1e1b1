/// The worst places of all parts of a report. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_REPORT_WORST_PLACES_H_
#define CHRONORMAL_WORKFLOW_REPORT_WORST_PLACES_H_

#include <vector>

#include "workflow/report/report_model.h"

namespace chronormal::inline internal {

/// At most kMostWorstPlaces of them, worst first: the vertices by what they are off at the most, without those that are
/// within kPlaceDistance of one before. Part and vertex as the model counts before it is thinned.
[[nodiscard]] std::vector<ReportPlace> find_worst_places(const std::vector<ModelPart>& parts);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_REPORT_WORST_PLACES_H_
