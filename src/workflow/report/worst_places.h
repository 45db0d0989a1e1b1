/// Finds the worst places of all parts of a report. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_REPORT_WORST_PLACES_H_
#define CHRONORMAL_WORKFLOW_REPORT_WORST_PLACES_H_

#include <vector>

#include "workflow/report/report_model.h"

namespace chronormal::inline internal {

/// Finds at most kMostWorstPlaces worst places, and returns them in descending order of their errors. Goes through all
/// vertices from the largest error down, and skips vertices within kPlaceDistance of an earlier place. Indices of parts
/// and vertices are those before thinning.
[[nodiscard]] std::vector<ReportPlace> find_worst_places(const std::vector<ModelPart>& parts);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_REPORT_WORST_PLACES_H_
