/// Formats the result of `report` for people.
#ifndef CLI_REPORTS_REPORT_REPORT_H_
#define CLI_REPORTS_REPORT_REPORT_H_

#include <cstddef>
#include <string>

#include "workflow/report/report.h"

namespace chronormal::cli {

/// Returns the text that the command prints. It names the written file and its size, and has a table of the parts, the
/// worst places, and sentences about what was left out.
[[nodiscard]] std::string report_text(const Report& report, const std::string& output, std::size_t bytes);

}  // namespace chronormal::cli

#endif  // CLI_REPORTS_REPORT_REPORT_H_
