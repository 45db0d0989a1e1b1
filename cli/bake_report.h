/// The result of `bake` in its two forms.
#ifndef CLI_BAKE_REPORT_H_
#define CLI_BAKE_REPORT_H_

#include <cstddef>
#include <optional>
#include <string>

#include "chronormal/workflow/audit.h"
#include "chronormal/workflow/bake.h"

namespace chronormal::cli {

/// The audit of the input, and the audit of the file that bake made of it.
struct BeforeAndAfter {
  Audit before, after;

  [[nodiscard]] bool is_worse() const noexcept { return chronormal::is_worse(after.error, before.error); }
};

struct BakeReport {
  std::string input, output;
  std::optional<std::string> drivers_file;
  std::optional<BeforeAndAfter> audit;
};

/// That the result is worse than the input, and by how much.
[[nodiscard]] std::string worse_text(const BeforeAndAfter& audit);

/// What was added, a line for each mesh.
[[nodiscard]] std::string bake_text(const GltfBake& bake, const BakeReport& report);
[[nodiscard]] std::string bake_text(const SequenceBake& bake, BakeEncoding encoding, const BakeReport& report);

/// What each form of each mesh would come to, of --encode smallest.
[[nodiscard]] std::string plan_text(const GltfBake& bake, const BakeReport& report);
[[nodiscard]] std::string plan_json(const GltfBake& bake, const BakeReport& report);

/// One JSON object with everything, as docs/cli.md has it.
[[nodiscard]] std::string bake_json(const GltfBake& bake, const BakeReport& report);
[[nodiscard]] std::string bake_json(const SequenceBake& bake, BakeEncoding encoding, const BakeReport& report);

}  // namespace chronormal::cli

#endif  // CLI_BAKE_REPORT_H_
