/// The options of a command as a table, and the function that parses a command line by these tables.
///
/// The parser is a large template library, which only options.cpp includes.
#ifndef CLI_OPTIONS_OPTIONS_H_
#define CLI_OPTIONS_OPTIONS_H_

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "chronormal/core/result.h"

namespace chronormal::cli {

/// A check of an option's value as text. It returns the problem, or an empty text if the value is valid.
using Check = std::function<std::string(const std::string& value)>;

/// One row of the table: an option, or the arguments without a name.
struct Option {
  /// Points to the variable for the value, whose type determines the syntax: a bool is a flag, a list gets a value each
  /// time that the option is given, and an optional remembers whether the option was given.
  using Target = std::variant<bool*, std::string*, std::optional<std::string>*, std::vector<std::string>*, double*,
                              std::optional<double>*, std::size_t*, std::optional<std::size_t>*>;

  struct Rules {
    bool required = false;
    std::string needs = {}, excludes = {};  ///< an earlier option in the table: "--blend"
    Check check = {};
    bool rare = false;  ///< few need it: only --help-all has it
  };

  std::string spelling;  ///< the spelling in the help: "-o,--output OUT", "--force", "INPUT"
  Target target;
  std::string help;  ///< a line for --help, and after it sentences for --help-all
  Rules rules = {};
};

/// An option that other commands have but this one refuses, with the reason or an alternative.
struct RefusedOption {
  std::string name, reason;
};

/// A command of the program. Its options are in several tables in order; the first table chooses the input, and help
/// prints it last.
struct Command {
  std::string name, summary;
  std::vector<std::vector<Option>> tables;
  std::string footer;
  std::function<Result<int>()> run;  ///< returns the exit code; called after the options have got their values
  std::vector<RefusedOption> refused = {};
  bool shares = false;  ///< tells whether several ranks divide the task (cli/ranks/ranks.h)
};

/// Returns a check that the value is an integer in a range, written only in digits.
[[nodiscard]] Check check_whole(std::size_t least, std::size_t most = static_cast<std::size_t>(-1));

/// Returns a check that the value is not empty; `message` is reported for an empty value.
[[nodiscard]] Check check_given(std::string message);

/// Parses the command line and runs the command that it names, or prints help (--help, --help-all), the version,
/// --manual-page or --completions SHELL (cli/options/help.h). Errors go to stderr as "chronormal COMMAND: place:
/// message". Returns the exit code.
[[nodiscard]] int run_program(const std::vector<Command>& commands, std::span<char*> arguments);

}  // namespace chronormal::cli

#endif  // CLI_OPTIONS_OPTIONS_H_
