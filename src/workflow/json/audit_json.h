/// The result of an audit as a JSON object, for one input and for several. Private to workflow and the program.
#ifndef CHRONORMAL_WORKFLOW_JSON_AUDIT_JSON_H_
#define CHRONORMAL_WORKFLOW_JSON_AUDIT_JSON_H_

#include <optional>
#include <string>

#include "chronormal/workflow/audit.h"
#include "workflow/json/object.h"

namespace chronormal::inline internal {

/// All that was found in one input; without the fields that every command begins with.
[[nodiscard]] Json audit_object(const std::string& input, const Audit& audit, std::optional<double> tolerance);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_JSON_AUDIT_JSON_H_
