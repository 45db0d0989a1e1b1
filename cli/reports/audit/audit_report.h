/// The result of `audit` of one input, for people.
#ifndef CLI_REPORTS_AUDIT_REPORT_H_
#define CLI_REPORTS_AUDIT_REPORT_H_

#include <optional>
#include <string>

#include "chronormal/io/input.h"
#include "chronormal/workflow/audit.h"

namespace chronormal::cli {

/// One input and what was found in it.
struct Audited {
  Input opened;
  Audit audit;
  AuditLimits limits;
  std::string bake;  ///< the inputs as words of a command line; empty: bake takes none such

  [[nodiscard]] const std::string& name() const noexcept { return opened.name(); }
  /// The glTF file, or nullptr.
  [[nodiscard]] const GltfDocument* document() const noexcept { return opened.document(); }
  [[nodiscard]] bool passed(const ViewerAudit& viewer) const { return limits.allow(viewer); }
  /// Returns whether the limits are kept: in every viewer that was named, or by the rule where none was. A file in
  /// which nothing moves keeps them.
  [[nodiscard]] bool passed() const { return limits.allow(audit); }
};

/// The verdict first, tables of the motions and of the errors, what was found, and what to do. Long tables are cut.
[[nodiscard]] std::string audit_text(const Audited& input);

/// "vertex 17 of Head, primitive 1, target 0 (smile) at weight 0.55": where the worst error of all is.
[[nodiscard]] std::string worst_label(const Audited& input);

/// Names the place where the worst error of one viewer is.
[[nodiscard]] std::string worst_label(const Audited& input, const ViewerAudit& viewer);

/// The same for the first pair that cannot be lit.
[[nodiscard]] std::string unlit_label(const Audited& input);

/// The same for the worst pair of those whose right normal all but vanishes.
[[nodiscard]] std::string faint_label(const Audited& input);

/// Names the first pair around which the normals of faces cancel, likewise.
[[nodiscard]] std::string cancelled_label(const Audited& input);

}  // namespace chronormal::cli

#endif  // CLI_REPORTS_AUDIT_REPORT_H_
