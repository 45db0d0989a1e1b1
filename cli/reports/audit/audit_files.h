/// Formats the result of `audit` for several files, as a table with a row for each file.
#ifndef CLI_REPORTS_AUDIT_AUDIT_FILES_H_
#define CLI_REPORTS_AUDIT_AUDIT_FILES_H_

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "chronormal/core/result.h"
#include "cli/reports/audit/audit_report.h"
#include "workflow/json/audit_json.h"

namespace chronormal::cli {

/// The data that are kept for one file: only its row and its JSON, since a folder may have thousands of files.
struct AuditedFile {
  explicit AuditedFile(const Audited& audited);
  AuditedFile(std::string file, const Error& why);

  std::string name;
  std::optional<MotionError> error;  ///< empty if the file could not be judged
  std::size_t faults = 0;            ///< number of fault lines in the report of this file alone
  std::string verdict;               ///< the last column of the row
  Json json;                         ///< result of audit_object(), or the members "input" and "error"
};

/// Returns a summary of all files, and a table with a row for each, in the given order.
[[nodiscard]] std::string audit_files_text(const std::vector<AuditedFile>& files);

/// Returns one JSON object: "files" has an entry for each file, and "passed" says whether all files passed.
[[nodiscard]] std::string audit_files_json(std::vector<AuditedFile> files, const AuditLimits& limits);

}  // namespace chronormal::cli

#endif  // CLI_REPORTS_AUDIT_AUDIT_FILES_H_
