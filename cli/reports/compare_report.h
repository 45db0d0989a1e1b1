/// The result of `compare` as a table and as CSV.
#ifndef CLI_REPORTS_COMPARE_REPORT_H_
#define CLI_REPORTS_COMPARE_REPORT_H_

#include <string>
#include <vector>

#include "workflow/json/json.h"

namespace chronormal::cli {

/// Columns that a table may have beside the errors.
struct TableColumns {
  bool times = true;  ///< without them it is the same on every run
  bool operations = false;
};

/// One aligned table with a line per scheme.
[[nodiscard]] std::string compare_table(const NamedComparison& input, TableColumns columns);

/// The paper's table: a line per scheme, and per input the sum and its ratio to linear.
[[nodiscard]] std::string compare_tables_side_by_side(const std::vector<NamedComparison>& inputs);

/// Both tables of the paper as LaTeX, for inputs that were compared by the same schemes: the sums with their ratios to
/// linear, and the operations at random and in sequence. It needs no package, and every name is ASCII: other characters
/// are question marks.
[[nodiscard]] std::string compare_latex(const std::vector<NamedComparison>& inputs);

/// A header line, and a line per input and scheme. Names with commas, quotes or line ends are quoted (RFC 4180).
[[nodiscard]] std::string compare_csv(const std::vector<NamedComparison>& inputs, bool with_times);

/// A field of a CSV line, in quotes where it has to be.
[[nodiscard]] std::string csv_field(const std::string& text);

}  // namespace chronormal::cli

#endif  // CLI_REPORTS_COMPARE_REPORT_H_
