/// Formats the result of `compare --blend` as a table and as CSV.
#ifndef CLI_REPORTS_BLEND_REPORT_H_
#define CLI_REPORTS_BLEND_REPORT_H_

#include <string>

#include "workflow/json/json.h"

namespace chronormal::cli {

/// Returns a table for each mesh, with a line for each number of active targets and kind of deltas.
[[nodiscard]] std::string blend_table(const NamedBlendComparison& input);

/// Returns a header line, and a line for each mesh, number of active targets and kind of deltas.
[[nodiscard]] std::string blend_csv(const NamedBlendComparison& input);

}  // namespace chronormal::cli

#endif  // CLI_REPORTS_BLEND_REPORT_H_
