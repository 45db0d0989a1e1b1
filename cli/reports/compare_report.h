/// Formats the result of `compare` as a table, as CSV and as LaTeX.
#ifndef CLI_REPORTS_COMPARE_REPORT_H_
#define CLI_REPORTS_COMPARE_REPORT_H_

#include <string>
#include <vector>

#include "workflow/json/json.h"

namespace chronormal::cli {

/// The columns that a table has besides the names and errors of schemes.
struct TableColumns {
  bool times = true;  ///< false to get the same table in every run
  bool operations = false;
};

/// Returns one aligned table with a line for each scheme.
[[nodiscard]] std::string compare_table(const NamedComparison& input, TableColumns columns);

/// Returns a table like Table 1 of the paper. It has a row for each scheme. For each input, it shows the sum of the
/// scheme's errors and the ratio of this sum to the sum of the scheme `linear`.
[[nodiscard]] std::string compare_tables_side_by_side(const std::vector<NamedComparison>& inputs);

/// Returns Tables 1 and 2 of the paper as LaTeX, for inputs that were compared by the same schemes. The first has the
/// sums of the errors, and their ratios to the sum of the scheme `linear`. The second has the numbers of operations of
/// an evaluation, at random times and in sequence. The tables need no LaTeX package; in names, characters outside of
/// ASCII become question marks.
[[nodiscard]] std::string compare_latex(const std::vector<NamedComparison>& inputs);

/// Returns CSV: a header line, and a line for each input and scheme. Names with commas, quotes or line ends are quoted
/// (RFC 4180).
[[nodiscard]] std::string compare_csv(const std::vector<NamedComparison>& inputs, bool with_times);

/// Returns a field of a CSV line, in quotes if necessary.
[[nodiscard]] std::string csv_field(const std::string& text);

}  // namespace chronormal::cli

#endif  // CLI_REPORTS_COMPARE_REPORT_H_
