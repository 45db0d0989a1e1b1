/// The result of `bake` in its two forms.
#ifndef CLI_BAKE_REPORT_H_
#define CLI_BAKE_REPORT_H_

#include <cstddef>
#include <optional>
#include <string>

#include "chronormal/workflow/bake.h"

namespace chronormal::cli {

/// The worst errors of a file before and after, in degrees.
struct BeforeAndAfter {
  double before = 0, after = 0;
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
