/// The result of `compare --blend` in its three forms.
#ifndef CLI_REPORTS_BLEND_REPORT_H_
#define CLI_REPORTS_BLEND_REPORT_H_

#include <string>

#include "chronormal/workflow/compare.h"

namespace chronormal::cli {

struct NamedBlendComparison {
  std::string name;
  std::string animation;  ///< as it was asked for; empty: random weights
  BlendComparison comparison;
};

/// A table for each mesh, with a line for each number of active targets and kind of deltas.
[[nodiscard]] std::string blend_table(const NamedBlendComparison& input);

/// One JSON object, as docs/cli.md has it.
[[nodiscard]] std::string blend_json(const NamedBlendComparison& input);

/// A header line, and a line per mesh, number of active targets and kind of deltas.
[[nodiscard]] std::string blend_csv(const NamedBlendComparison& input);

}  // namespace chronormal::cli

#endif  // CLI_REPORTS_BLEND_REPORT_H_
