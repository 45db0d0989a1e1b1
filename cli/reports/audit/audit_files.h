/// The result of `audit` of several files: a row for each.
#ifndef CLI_REPORTS_AUDIT_FILES_H_
#define CLI_REPORTS_AUDIT_FILES_H_

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "chronormal/core/result.h"
#include "cli/reports/audit/audit_report.h"
#include "workflow/json/audit_json.h"

namespace chronormal::cli {

/// What is kept of one file: no more than its row and its JSON, since a folder may have thousands.
struct AuditedFile {
  explicit AuditedFile(const Audited& audited);
  AuditedFile(std::string file, const Error& why);

  std::string name;
  std::optional<MotionError> error;  ///< nothing where it could not be judged
  std::size_t faults = 0;            ///< lines of faults that the report of this file alone has
  std::string verdict;               ///< a word or two
  Json json;                         ///< of audit_object(), or "input" and "error"
};

/// The table, with the worst of all files before it.
[[nodiscard]] std::string audit_files_text(const std::vector<AuditedFile>& files);

/// One JSON object: "files" has one for each, and "passed" says whether all of them did.
[[nodiscard]] std::string audit_files_json(std::vector<AuditedFile> files, const AuditLimits& limits);

}  // namespace chronormal::cli

#endif  // CLI_REPORTS_AUDIT_FILES_H_
