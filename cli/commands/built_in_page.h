/// Gives access to the page of reports that is built into the program.
#ifndef CLI_COMMANDS_BUILT_IN_PAGE_H_
#define CLI_COMMANDS_BUILT_IN_PAGE_H_

#include <string_view>

namespace chronormal::cli {

/// Returns the page that CHRONORMAL_REPORT_PAGE named when the program was built, or an empty text if it named none.
[[nodiscard]] std::string_view built_in_page() noexcept;

}  // namespace chronormal::cli

#endif  // CLI_COMMANDS_BUILT_IN_PAGE_H_
