/// Gives access to the template for pages of `report` that is built into the program.
#ifndef CLI_COMMANDS_BUILT_IN_PAGE_H_
#define CLI_COMMANDS_BUILT_IN_PAGE_H_

#include <string_view>

namespace chronormal::cli {

/// Returns the template: the contents of the file that the macro CHRONORMAL_REPORT_PAGE named when the program was
/// built. Returns an empty text if the macro was not defined.
[[nodiscard]] std::string_view built_in_page() noexcept;

}  // namespace chronormal::cli

#endif  // CLI_COMMANDS_BUILT_IN_PAGE_H_
