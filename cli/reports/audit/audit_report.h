/// Formats the result of `audit` of one input for people.
#ifndef CLI_REPORTS_AUDIT_AUDIT_REPORT_H_
#define CLI_REPORTS_AUDIT_AUDIT_REPORT_H_

#include <optional>
#include <string>

#include "chronormal/io/input.h"
#include "chronormal/workflow/audit.h"

namespace chronormal::cli {

/// An opened input, its audit, and the limits for the errors of the audit.
struct Audited {
  Input opened;
  Audit audit;
  AuditLimits limits;
  std::string bake;  ///< the inputs as words of a command line; empty if bake cannot read them

  [[nodiscard]] const std::string& name() const noexcept { return opened.name(); }
  /// Returns the document of a glTF file, or nullptr for other inputs.
  [[nodiscard]] const GltfDocument* document() const noexcept { return opened.document(); }
  [[nodiscard]] bool passed(const ViewerAudit& viewer) const { return limits.allow(viewer); }
  /// Returns true if the errors are within the limits in every viewer that the user named, or by the rule of the audit
  /// if the user named no viewer. A file in which nothing moves is within all limits.
  [[nodiscard]] bool passed() const { return limits.allow(audit); }
};

/// Returns the whole report: the verdict, tables of the motions and of the errors, the findings, and a recommendation.
/// Long tables are cut off.
[[nodiscard]] std::string audit_text(const Audited& input);

/// Names the place of the largest error: "vertex 17 of Head, primitive 1, target 0 (smile) at weight 0.55".
[[nodiscard]] std::string worst_label(const Audited& input);

/// Names the place of the largest error in one viewer.
[[nodiscard]] std::string worst_label(const Audited& input, const ViewerAudit& viewer);

/// Names the place of the first sample whose normal is zero, infinite or NaN, so that a viewer cannot light it.
[[nodiscard]] std::string unlit_label(const Audited& input);

/// Names the place of the largest error among the samples whose true normal nearly vanishes.
[[nodiscard]] std::string faint_label(const Audited& input);

/// Names the place of the first sample of a vertex at which the normals of the faces around cancel.
[[nodiscard]] std::string cancelled_label(const Audited& input);

}  // namespace chronormal::cli

#endif  // CLI_REPORTS_AUDIT_AUDIT_REPORT_H_
