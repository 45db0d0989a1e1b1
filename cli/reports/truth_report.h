/// Formats the result of `compare --truth` as a table and as CSV.
#ifndef CLI_REPORTS_TRUTH_REPORT_H_
#define CLI_REPORTS_TRUTH_REPORT_H_

#include <string>

#include "workflow/json/json.h"

namespace chronormal::cli {

/// Returns one aligned table with a line for each path and scheme, followed by sentences that explain the figures.
[[nodiscard]] std::string truth_table(const NamedTruthComparison& input);

/// Returns CSV: a header line, and a line for each path and scheme.
[[nodiscard]] std::string truth_csv(const NamedTruthComparison& input);

}  // namespace chronormal::cli

#endif  // CLI_REPORTS_TRUTH_REPORT_H_
