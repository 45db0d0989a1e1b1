/// The result of `bake` in its two forms.
#ifndef CLI_BAKE_REPORT_H_
#define CLI_BAKE_REPORT_H_

#include <cstddef>
#include <optional>
#include <string>

#include "chronormal/workflow/audit.h"
#include "chronormal/workflow/bake.h"

namespace chronormal::cli {

/// The errors of what is shown before and after, by audit.
struct BeforeAndAfter {
  MotionError before, after;
};

struct BakeReport {
  std::string input, output;
  std::optional<std::string> drivers_file;
  std::optional<BeforeAndAfter> audit;
};

/// What was added, a line for each mesh.
[[nodiscard]] std::string bake_text(const GltfBake& bake, const BakeReport& report);
[[nodiscard]] std::string bake_text(const SequenceBake& bake, BakeEncoding encoding, const BakeReport& report);

/// One JSON object with everything, as docs/cli.md has it.
[[nodiscard]] std::string bake_json(const GltfBake& bake, const BakeReport& report);
[[nodiscard]] std::string bake_json(const SequenceBake& bake, BakeEncoding encoding, const BakeReport& report);

}  // namespace chronormal::cli

#endif  // CLI_BAKE_REPORT_H_
