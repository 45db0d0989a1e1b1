/// Formats the figures of the paper for one face as a table (`compare --face`).
#ifndef CLI_REPORTS_FIGURE_REPORT_H_
#define CLI_REPORTS_FIGURE_REPORT_H_

#include <string>

#include "workflow/compare/face_figure.h"

namespace chronormal::cli {

/// Returns a line for each scheme, and below the lines the matrix of the paper and the frames at both ends. `input` is
/// the name of the input.
[[nodiscard]] std::string figure_table(const std::string& input, const FaceFigure& figure);

}  // namespace chronormal::cli

#endif  // CLI_REPORTS_FIGURE_REPORT_H_
