/// What `audit` found, in words: a line for each mesh and cause.
#ifndef CLI_REPORTS_AUDIT_FINDINGS_H_
#define CLI_REPORTS_AUDIT_FINDINGS_H_

#include <cstddef>
#include <string>

#include "cli/reports/audit/audit_report.h"

namespace chronormal::cli {

/// How many lines of faults there are, shown or not.
[[nodiscard]] std::size_t count_fault_lines(const Audit& audit);

/// The lines with their title, faults the worst first, or nothing where there are none. Long lists are cut.
[[nodiscard]] std::string fault_lines(const Audited& input);
[[nodiscard]] std::string note_lines(const Audited& input);

}  // namespace chronormal::cli

#endif  // CLI_REPORTS_AUDIT_FINDINGS_H_
