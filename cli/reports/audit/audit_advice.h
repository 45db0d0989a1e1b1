/// Recommends a remedy for an audited file, as a command for this very file if possible. Never recommends a command
/// that was already run or that cannot help.
#ifndef CLI_REPORTS_AUDIT_AUDIT_ADVICE_H_
#define CLI_REPORTS_AUDIT_AUDIT_ADVICE_H_

#include <string>

#include "cli/reports/audit/audit_report.h"

namespace chronormal::cli {

/// Returns the recommendation, which is the last line of the report, after an empty line. Returns an empty text if
/// nothing was judged.
[[nodiscard]] std::string advice(const Audited& input);

/// Returns the verdict on a file in a few words for a table: "right", "within the limits", "wrong, bake it", ...
[[nodiscard]] std::string verdict(const Audited& input);

}  // namespace chronormal::cli

#endif  // CLI_REPORTS_AUDIT_AUDIT_ADVICE_H_
