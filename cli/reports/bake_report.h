/// The result of `bake` for people.
#ifndef CLI_REPORTS_BAKE_REPORT_H_
#define CLI_REPORTS_BAKE_REPORT_H_

#include <string>

#include "chronormal/workflow/json.h"

namespace chronormal::cli {

/// That the result is worse than the input, and by how much.
[[nodiscard]] std::string worse_text(const BeforeAndAfter& audit);

/// What was added, a line for each mesh.
[[nodiscard]] std::string bake_text(const GltfBake& bake, const BakeReport& report);
[[nodiscard]] std::string bake_text(const SequenceBake& bake, BakeEncoding encoding, const BakeReport& report);

/// What each form of each mesh would come to, of --encode smallest.
[[nodiscard]] std::string plan_text(const GltfBake& bake, const BakeReport& report);

}  // namespace chronormal::cli

#endif  // CLI_REPORTS_BAKE_REPORT_H_
