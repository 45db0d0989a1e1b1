/// Makes JSON from the result of an audit, for one input or for several. Private to workflow and the program.
#ifndef CHRONORMAL_WORKFLOW_JSON_AUDIT_JSON_H_
#define CHRONORMAL_WORKFLOW_JSON_AUDIT_JSON_H_

#include <optional>
#include <string>

#include "chronormal/workflow/audit.h"
#include "workflow/json/object.h"

namespace chronormal::inline internal {

/// The version of the JSON of audits. Version 2 renamed `hosts` to `viewers`, and added torn edges.
inline constexpr int kAuditSchema = 2;

/// Returns an object with the results of an audit of one input. Leaves out the fields with which the JSON of every
/// command begins (json_of_command()).
[[nodiscard]] Json audit_object(const std::string& input, const Audit& audit, const AuditLimits& limits);

/// Returns the JSON text of an audit as one line, for the container of a report.
[[nodiscard]] std::string audit_line(const std::string& input, const Audit& audit, const AuditLimits& limits);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_JSON_AUDIT_JSON_H_
