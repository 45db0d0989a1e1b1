/// The result of `compare` as a table and as CSV.
#ifndef CLI_REPORTS_COMPARE_REPORT_H_
#define CLI_REPORTS_COMPARE_REPORT_H_

#include <string>
#include <vector>

#include "chronormal/workflow/json.h"

namespace chronormal::cli {

/// One aligned table with a line per scheme. Without times it is the same on every run.
[[nodiscard]] std::string compare_table(const NamedComparison& input, bool with_times);

/// The paper's table: a line per scheme, and per input the sum and its ratio to linear.
[[nodiscard]] std::string compare_tables_side_by_side(const std::vector<NamedComparison>& inputs);

/// A header line, and a line per input and scheme. Names with commas, quotes or line ends are quoted (RFC 4180).
[[nodiscard]] std::string compare_csv(const std::vector<NamedComparison>& inputs, bool with_times);

/// A field of a CSV line, in quotes where it has to be.
[[nodiscard]] std::string csv_field(const std::string& text);

}  // namespace chronormal::cli

#endif  // CLI_REPORTS_COMPARE_REPORT_H_
