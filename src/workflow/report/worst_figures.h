/// Makes the figures of the paper (compare/face_figure.h) for the faces around the worst places of a report. Private to
/// workflow.
#ifndef CHRONORMAL_WORKFLOW_REPORT_WORST_FIGURES_H_
#define CHRONORMAL_WORKFLOW_REPORT_WORST_FIGURES_H_

#include <array>
#include <cstddef>
#include <string_view>

#include "workflow/json/object.h"
#include "workflow/report/report_model.h"

namespace chronormal::inline internal {

/// The largest number of figures that are stored in a page, and the number of samples of each figure. Only a page with
/// the program (as WebAssembly) inside can show other figures. Eight figures take about 40 kB of the page.
inline constexpr std::size_t kMostFigures = 8, kFigureSamples = 21;
inline constexpr std::array<std::string_view, 7> kFigureSchemes = {
    "linear", "quadratic", "cubic", "slerp", "decasteljau:4", "quaternion:matrix", "quaternion:optimal"};

/// Returns an array of figures, in the order of the worst places. A figure shows one of the faces around a worst place:
/// the face for which the scheme `linear` has the largest error. Leaves out a face that an earlier figure shows. The
/// face moves as in the segment of the place. In a glTF file, the face moves from the base to the moment of the place,
/// or to weight 1 if the place is given by a weight.
[[nodiscard]] Json worst_figures(const ReportModel& model);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_REPORT_WORST_FIGURES_H_
