#include "cli/reports/audit/audit_files.h"

#include <algorithm>
#include <utility>

#include "cli/reports/audit/audit_advice.h"
#include "cli/reports/audit/audit_findings.h"
#include "cli/reports/audit/audit_words.h"
#include "cli/terminal/format.h"
#include "cli/terminal/table.h"
#include "cli/terminal/text.h"

namespace chronormal::cli {
namespace {

std::string headline(const std::vector<AuditedFile>& files) {
  std::size_t judged = 0;
  const AuditedFile* worst = nullptr;
  for (const AuditedFile& file : files) {
    if (!file.error || file.error->judged == 0) continue;
    ++judged;
    if (worst == nullptr || file.error->worst > worst->error->worst) worst = &file;
  }
  std::string text = counted(files.size(), "file", "files");
  if (judged < files.size()) text += formatted(", {} judged", judged);
  if (worst != nullptr)
    text += formatted("; the worst error is {} degrees, in {}", judged_degrees(worst->error->worst),
                      printable(worst->name));
  return text + '\n';
}

}  // namespace

AuditedFile::AuditedFile(const Audited& audited)
    : name(audited.name()),
      error(audited.audit.error),
      faults(count_fault_lines(audited.audit)),
      verdict(cli::verdict(audited)),
      json(audit_object(audited.name(), audited.audit, audited.limits)) {}

AuditedFile::AuditedFile(std::string file, const Error& why)
    : name(std::move(file)), verdict("not judged"), json({{"input", {{"name", name}}}, {"error", why.text()}}) {}

std::string audit_files_text(const std::vector<AuditedFile>& files) {
  Table table;
  table.add_column("file", "", Table::Align::kLeft);
  for (const char* const title : {"worst", "99 %", "average"}) table.add_column(title, "degrees", Table::Align::kRight);
  table.add_column("faults", "", Table::Align::kRight);
  table.add_column("verdict", "", Table::Align::kLeft);
  for (const AuditedFile& file : files) {
    std::vector<std::string> cells = {printable(file.name)};
    if (!file.error || file.error->judged == 0)
      cells.insert(cells.end(), {"-", "-", "-", "-"});
    else
      cells.insert(cells.end(), {judged_degrees(file.error->worst), degrees(file.error->percentile(0.99)),
                                 degrees(file.error->mean()), grouped(file.faults)});
    cells.push_back(file.verdict);
    table.add_row(std::move(cells));
  }
  return headline(files) + '\n' + table.text() +
         "\nTo see where a file is wrong, and what to do, run chronormal audit FILE.\n";
}

std::string audit_files_json(std::vector<AuditedFile> files, const AuditLimits& limits) {
  Json json = json_of_command("audit", kAuditSchema);
  json["tolerance_degrees"] = or_null(limits.degrees);
  json["tolerance_torn_edges"] = or_null(limits.torn_edges);
  const bool passed = std::all_of(files.begin(), files.end(), [](const AuditedFile& file) {
    return file.json.contains("passed") && file.json["passed"] == true;
  });
  const bool any_judged = std::any_of(files.begin(), files.end(), [](const AuditedFile& file) {
    return file.error && file.error->judged + file.error->faint > 0;
  });
  json["passed"] = limits.any() ? Json(passed && any_judged) : Json();
  json["files"] = Json::array();
  for (AuditedFile& file : files) json["files"].push_back(std::move(file.json));
  return json_text(json);
}

}  // namespace chronormal::cli
