/// The result of `compare --truth` as a table and as CSV.
#ifndef CLI_REPORTS_TRUTH_REPORT_H_
#define CLI_REPORTS_TRUTH_REPORT_H_

#include <string>

#include "workflow/json/json.h"

namespace chronormal::cli {

/// One aligned table with a line per path and scheme, and below it what a reader should make of it.
[[nodiscard]] std::string truth_table(const NamedTruthComparison& input);

/// A header line, and a line per path and scheme.
[[nodiscard]] std::string truth_csv(const NamedTruthComparison& input);

}  // namespace chronormal::cli

#endif  // CLI_REPORTS_TRUTH_REPORT_H_
