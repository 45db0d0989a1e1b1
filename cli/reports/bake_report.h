/// Formats the result of `bake` for people.
#ifndef CLI_REPORTS_BAKE_REPORT_H_
#define CLI_REPORTS_BAKE_REPORT_H_

#include <string>

#include "workflow/json/json.h"

namespace chronormal::cli {

/// Returns a text that says in which respects the result is worse than the input, and in which it is better, with
/// figures. If of_animations is true, some deltas are fitted to the animations and are meaningless for a target alone.
[[nodiscard]] std::string worse_text(const BeforeAndAfter& audit, bool of_animations);
/// Returns true if some deltas of a result are fitted to the animations.
[[nodiscard]] bool any_of_animations(const GltfBake& bake);

/// Return the report on a bake: the errors before and after, and what was added. For a glTF file, the report has a
/// table with a line for each mesh.
[[nodiscard]] std::string bake_text(const GltfBake& bake, const BakeReport& report);
[[nodiscard]] std::string bake_text(const SequenceBake& bake, BakeEncoding encoding, const BakeReport& report);

/// Returns tables with the targets, bytes and errors of every candidate that the bake has compared for each mesh.
[[nodiscard]] std::string plan_text(const GltfBake& bake, const BakeReport& report);

}  // namespace chronormal::cli

#endif  // CLI_REPORTS_BAKE_REPORT_H_
