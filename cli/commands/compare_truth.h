/// Implements the option --truth of `compare`.
#ifndef CLI_COMMANDS_COMPARE_TRUTH_H_
#define CLI_COMMANDS_COMPARE_TRUTH_H_

#include <cstddef>
#include <optional>
#include <vector>

#include "cli/options/command.h"
#include "workflow/json/json.h"

namespace chronormal::cli {

struct TruthArguments {
  std::optional<std::size_t> every;  ///< set by --truth

  [[nodiscard]] std::vector<Option> table();
};

/// Reads the input, leaves some keyframes out, and compares interpolated normals with the normals at the keyframes that
/// were left out. Errors: those of reading and of compare_with_truth().
[[nodiscard]] Result<NamedTruthComparison> compare_input_with_truth(const InputOptions& input,
                                                                    const ElementArguments& elements,
                                                                    const TruthArguments& arguments,
                                                                    std::vector<std::string> schemes,
                                                                    Progress& progress);

}  // namespace chronormal::cli

#endif  // CLI_COMMANDS_COMPARE_TRUTH_H_
