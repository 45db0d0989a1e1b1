/// Formats the figures of the paper for one face as a table (`compare --face`).
#ifndef CLI_REPORTS_FIGURE_REPORT_H_
#define CLI_REPORTS_FIGURE_REPORT_H_

#include <string>

#include "workflow/compare/face_figure.h"

namespace chronormal::cli {

/// Returns a table with a row for each scheme, then the matrix M of the paper, which moves the face from t = 0 to t =
/// 1, and then the frames of the schemes at both ends. `input` is the name of the input.
[[nodiscard]] std::string figure_table(const std::string& input, const FaceFigure& figure);

}  // namespace chronormal::cli

#endif  // CLI_REPORTS_FIGURE_REPORT_H_
