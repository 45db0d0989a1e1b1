/// What to do about a file that was audited: what a command would get for this very file, and nothing that was done
/// already or cannot help.
#ifndef CLI_REPORTS_AUDIT_ADVICE_H_
#define CLI_REPORTS_AUDIT_ADVICE_H_

#include <string>

#include "cli/reports/audit/audit_report.h"

namespace chronormal::cli {

/// The last line of the report, with an empty one before it; nothing where nothing was judged.
[[nodiscard]] std::string advice(const Audited& input);

/// A few words for a table: "right", "within 2", "bake it", ...
[[nodiscard]] std::string verdict(const Audited& input);

}  // namespace chronormal::cli

#endif  // CLI_REPORTS_AUDIT_ADVICE_H_
