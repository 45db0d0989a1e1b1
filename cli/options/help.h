/// Makes the help for a terminal, a manual page, and completions for shells. All are made from the tables of options,
/// so that they match the program.
#ifndef CLI_OPTIONS_HELP_H_
#define CLI_OPTIONS_HELP_H_

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/core/result.h"
#include "cli/options/options.h"

namespace chronormal::cli {

/// Return the help of the program and of one command, with lines of at most `columns` characters if the lengths of
/// words allow it. If `all` is false, the help of a command has one line for each option that is not rare.
[[nodiscard]] std::string help_of_program(const std::vector<Command>& commands, std::size_t columns);
[[nodiscard]] std::string help_of_command(const Command& command, bool all, std::size_t columns);

/// Returns the manual page of the program, for man(1).
[[nodiscard]] std::string manual_page(const std::vector<Command>& commands);

/// Returns the completions for bash, zsh or fish, as a file to be installed where that shell looks for completions.
/// Errors: kUsage for another shell.
[[nodiscard]] Result<std::string> completions(const std::vector<Command>& commands, std::string_view shell);

/// Returns the names in the spelling of an option: "-o" and "--output". Returns no names for arguments that are not
/// options.
[[nodiscard]] std::vector<std::string> names_of(const Option& option);
/// Returns true if a value follows the option.
[[nodiscard]] bool takes_value(const Option& option);

}  // namespace chronormal::cli

#endif  // CLI_OPTIONS_HELP_H_
