/// The result of `compare` in its three forms.
#ifndef CLI_REPORTS_COMPARE_REPORT_H_
#define CLI_REPORTS_COMPARE_REPORT_H_

#include <string>
#include <vector>

#include "chronormal/io/target_names.h"
#include "chronormal/workflow/compare.h"

namespace chronormal::cli {

struct NamedComparison {
  std::string name;
  Comparison comparison;
  TargetNames targets = {};  ///< of a set of targets
};

/// One aligned table with a line per scheme. Without times it is the same on every run.
[[nodiscard]] std::string compare_table(const NamedComparison& input, bool with_times);

/// The paper's table: a line per scheme, and per input the sum and its ratio to linear.
[[nodiscard]] std::string compare_tables_side_by_side(const std::vector<NamedComparison>& inputs);

/// One JSON object, as docs/cli.md has it. `several` nests the inputs, even if there is only one.
[[nodiscard]] std::string compare_json(const std::vector<NamedComparison>& inputs, bool several, bool with_times);

/// A header line, and a line per input and scheme. Names with commas, quotes or line ends are quoted (RFC 4180).
[[nodiscard]] std::string compare_csv(const std::vector<NamedComparison>& inputs, bool with_times);

/// "vertex", "corner" or "face".
[[nodiscard]] std::string one_element(ElementKind kind);

/// A field of a CSV line, in quotes where it has to be.
[[nodiscard]] std::string csv_field(const std::string& text);

}  // namespace chronormal::cli

#endif  // CLI_REPORTS_COMPARE_REPORT_H_
