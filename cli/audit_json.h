/// The result of an audit as JSON, as docs/cli.md has it: of one input, and of several.
#ifndef CLI_AUDIT_JSON_H_
#define CLI_AUDIT_JSON_H_

#include <string>

#include "cli/json.h"
#include "cli/reports/audit_report.h"

namespace chronormal::cli {

/// All that was found in one input; without the fields that every command begins with.
[[nodiscard]] Json audit_object(const Audited& input);

/// The object of the command for one input.
[[nodiscard]] std::string audit_json(const Audited& input);

}  // namespace chronormal::cli

#endif  // CLI_AUDIT_JSON_H_
