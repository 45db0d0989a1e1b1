/// Formats the result of `inspect` for people.
#ifndef CLI_REPORTS_INSPECT_REPORT_H_
#define CLI_REPORTS_INSPECT_REPORT_H_

#include <string>

#include "chronormal/workflow/inspect.h"

namespace chronormal::cli {

/// Returns the whole report: facts about the input, tables of targets, primitives and tracks, and two lines for each
/// problem. Long tables are cut off.
[[nodiscard]] std::string inspect_text(const Inspected& input);

}  // namespace chronormal::cli

#endif  // CLI_REPORTS_INSPECT_REPORT_H_
