/// The result of `bake` for people.
#ifndef CLI_REPORTS_BAKE_REPORT_H_
#define CLI_REPORTS_BAKE_REPORT_H_

#include <string>

#include "chronormal/workflow/json.h"

namespace chronormal::cli {

/// That the result is worse than the input, and by how much.
[[nodiscard]] std::string worse_text(const BeforeAndAfter& audit);

/// Says what the bake added: the table has a line for each mesh.
[[nodiscard]] std::string bake_text(const GltfBake& bake, const BakeReport& report);
[[nodiscard]] std::string bake_text(const SequenceBake& bake, BakeEncoding encoding, const BakeReport& report);

/// Lists the targets, bytes and errors that each form of each mesh would have, as the choice among them compares them.
[[nodiscard]] std::string plan_text(const GltfBake& bake, const BakeReport& report);

}  // namespace chronormal::cli

#endif  // CLI_REPORTS_BAKE_REPORT_H_
