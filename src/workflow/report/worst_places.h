/// Finds the worst places of all parts of a report. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_REPORT_WORST_PLACES_H_
#define CHRONORMAL_WORKFLOW_REPORT_WORST_PLACES_H_

#include <vector>

#include "workflow/report/report_model.h"

namespace chronormal::inline internal {

/// Finds at most kMostWorstPlaces places, and returns the largest error first. Goes through all vertices from the
/// largest error down, and skips vertices within kPlaceDistance of an earlier place. Parts and vertices have their
/// numbers before thinning.
[[nodiscard]] std::vector<ReportPlace> find_worst_places(const std::vector<ModelPart>& parts);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_REPORT_WORST_PLACES_H_
