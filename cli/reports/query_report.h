/// Formats the answer of `query` for people.
#ifndef CLI_REPORTS_QUERY_REPORT_H_
#define CLI_REPORTS_QUERY_REPORT_H_

#include <string>

#include "chronormal/workflow/query.h"

namespace chronormal::cli {

/// Returns the facts of an answer, one line each, and the first rows of every table of the answer. `input` is the name
/// of the input file.
[[nodiscard]] std::string query_text(const std::string& input, const QueryAnswer& answer);

}  // namespace chronormal::cli

#endif  // CLI_REPORTS_QUERY_REPORT_H_
