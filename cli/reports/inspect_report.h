/// The result of `inspect` in its two forms.
#ifndef CLI_REPORTS_INSPECT_REPORT_H_
#define CLI_REPORTS_INSPECT_REPORT_H_

#include <string>

#include "cli/reports/inspect_trouble.h"

namespace chronormal::cli {

/// Facts, tables of targets, primitives and tracks, and the trouble: two lines each. Long tables are cut.
[[nodiscard]] std::string inspect_text(const Inspected& input);

/// One JSON object with everything, as docs/cli.md has it.
[[nodiscard]] std::string inspect_json(const Inspected& input);

}  // namespace chronormal::cli

#endif  // CLI_REPORTS_INSPECT_REPORT_H_
