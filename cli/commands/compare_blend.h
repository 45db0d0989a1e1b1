/// Implements the option --blend of `compare`.
#ifndef CLI_COMMANDS_COMPARE_BLEND_H_
#define CLI_COMMANDS_COMPARE_BLEND_H_

#include <cstddef>
#include <optional>
#include <vector>

#include "cli/options/command.h"
#include "cli/reports/blend_report.h"

namespace chronormal::cli {

struct BlendArguments {
  std::optional<std::size_t> rows;  ///< number of poses; set by --blend
  std::optional<std::size_t> active;
  std::size_t seed = 1;

  [[nodiscard]] std::vector<Option> table();
};

/// Reads the input, and compares the normals of blended targets with exact normals. For a glTF file, compares the
/// stored normals and deltas. If the user chooses elements, computes their normals from the geometry instead. Errors:
/// kUsage for options that exclude each other; those of reading and of compare_blends().
[[nodiscard]] Result<NamedBlendComparison> compare_blend_input(const InputOptions& input,
                                                               const ElementArguments& elements,
                                                               const BlendArguments& arguments, Progress& progress);

}  // namespace chronormal::cli

#endif  // CLI_COMMANDS_COMPARE_BLEND_H_
