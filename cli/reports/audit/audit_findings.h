/// Describes the findings of `audit`: one line for each mesh and cause.
#ifndef CLI_REPORTS_AUDIT_AUDIT_FINDINGS_H_
#define CLI_REPORTS_AUDIT_AUDIT_FINDINGS_H_

#include <cstddef>
#include <string>

#include "cli/reports/audit/audit_report.h"

namespace chronormal::cli {

/// Returns the number of lines of faults, including lines that the report cuts off.
[[nodiscard]] std::size_t count_fault_lines(const Audit& audit);

/// Return the lines of faults (the worst first) or of notes below a title, or an empty text if there are none. Long
/// lists are cut off.
[[nodiscard]] std::string fault_lines(const Audited& input);
[[nodiscard]] std::string note_lines(const Audited& input);

}  // namespace chronormal::cli

#endif  // CLI_REPORTS_AUDIT_AUDIT_FINDINGS_H_
