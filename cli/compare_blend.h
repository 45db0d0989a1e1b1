/// The option --blend of `compare`.
#ifndef CLI_COMPARE_BLEND_H_
#define CLI_COMPARE_BLEND_H_

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>

#include "cli/blend_report.h"
#include "cli/command.h"

namespace chronormal::cli {

struct BlendArguments {
  std::optional<std::size_t> rows;  ///< given: --blend
  std::optional<std::size_t> active;
  std::uint64_t seed = 1;

  /// Adds --blend, --active and --seed.
  void add_to(CLI::App& command);
};

/// Reads the input and compares. elements_given: --elements was, so that those of a glTF file are by its geometry.
/// Errors: kUsage for what does not go together; those of reading and of compare_blends().
[[nodiscard]] Result<NamedBlendComparison> compare_blend_input(const InputOptions& input,
                                                               const ElementArguments& elements, bool elements_given,
                                                               const BlendArguments& arguments, Progress& progress);

}  // namespace chronormal::cli

#endif  // CLI_COMPARE_BLEND_H_
