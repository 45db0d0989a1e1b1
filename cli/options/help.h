/// What the program says about itself: help for a terminal, a manual page, and the completions of shells. All of it is
/// made of the tables of options, so that none can name an option that the program does not have.
#ifndef CLI_OPTIONS_HELP_H_
#define CLI_OPTIONS_HELP_H_

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/core/result.h"
#include "cli/options/options.h"

namespace chronormal::cli {

/// The help of the program and of one command, in lines of at most so many columns where words allow it.
[[nodiscard]] std::string help_of_program(const std::vector<Command>& commands, std::size_t columns);
[[nodiscard]] std::string help_of_command(const Command& command, std::size_t columns);

/// The manual page, for man(1).
[[nodiscard]] std::string manual_page(const std::vector<Command>& commands);

/// The completions of bash, zsh or fish, to be put where that shell looks for them. Errors: kUsage for another shell.
[[nodiscard]] Result<std::string> completions(const std::vector<Command>& commands, std::string_view shell);

/// The names of an option, as its spelling has them: "-o" and "--output". Empty for arguments without a name.
[[nodiscard]] std::vector<std::string> names_of(const Option& option);
/// Whether a value follows the option.
[[nodiscard]] bool takes_value(const Option& option);

}  // namespace chronormal::cli

#endif  // CLI_OPTIONS_HELP_H_
