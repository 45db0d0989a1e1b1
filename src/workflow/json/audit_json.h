/// Makes JSON from the result of an audit, for one input or for several. Private to workflow and the program.
#ifndef CHRONORMAL_WORKFLOW_JSON_AUDIT_JSON_H_
#define CHRONORMAL_WORKFLOW_JSON_AUDIT_JSON_H_

#include <optional>
#include <string>

#include "chronormal/workflow/audit.h"
#include "workflow/json/object.h"

namespace chronormal::inline internal {

/// The version of the JSON of audits. 2: `viewers` for `hosts`; torn edges.
inline constexpr int kAuditSchema = 2;

/// Returns all findings about one input, without the fields that every command begins with.
[[nodiscard]] Json audit_object(const std::string& input, const Audit& audit, const AuditLimits& limits);

/// Returns the text of audit_json() in one line.
[[nodiscard]] std::string audit_line(const std::string& input, const Audit& audit, const AuditLimits& limits);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_JSON_AUDIT_JSON_H_
