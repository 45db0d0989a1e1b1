/// Describes the options of a command as a table, and parses a command line by such tables.
///
/// The parser is a large template library, so only options.cpp includes it.
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

/// A check of an option's value, given as text. The function returns a description of the fault, or an empty text if
/// the value is valid.
using Check = std::function<std::string(const std::string& value)>;

/// One row of a command's table of options: an option, or the arguments that are not options.
struct Option {
  /// A pointer to the variable that gets the value. Its type determines the syntax: a bool is a flag, a list gets a
  /// value each time that the option is given, and an optional remembers if the option was given.
  using Target = std::variant<bool*, std::string*, std::optional<std::string>*, std::vector<std::string>*, double*,
                              std::optional<double>*, std::size_t*, std::optional<std::size_t>*>;

  struct Rules {
    bool required = false;
    std::string needs = {}, excludes = {};  ///< names of options earlier in the table, such as "--blend"
    Check check = {};
    /// True for an option that few users need; only --help-all shows it.
    bool rare = false;
  };

  std::string spelling;  ///< as in the help: "-o,--output OUT", "--force", "INPUT"
  Target target;
  std::string help;  ///< one line for --help, followed by sentences for --help-all
  Rules rules = {};
};

/// An option that other commands have and this command refuses. The reason may name an alternative.
struct RefusedOption {
  std::string name, reason;
};

/// A command of the program, whose options are in several tables. The options of the first table choose the input; the
/// help lists them last.
struct Command {
  std::string name, summary;
  std::vector<std::vector<Option>> tables;
  std::string footer;
  /// runs the command and returns the exit code; the options have their values before the call
  std::function<Result<int>()> run;
  std::vector<RefusedOption> refused = {};
  bool shares = false;  ///< true if several ranks divide the task (cli/ranks/ranks.h)
};

/// Returns a check that accepts only whole numbers from `least` to `most`, written only in digits.
[[nodiscard]] Check check_whole(std::size_t least, std::size_t most = static_cast<std::size_t>(-1));

/// Returns a check that accepts any value except an empty one, for which it reports `message`.
[[nodiscard]] Check check_given(std::string message);

/// Parses the command line and runs the command that it names. Instead of a command, --help, --help-all, --version,
/// --manual-page and --completions SHELL print their text (cli/options/help.h). Errors go to stderr as "chronormal
/// COMMAND: place: message". Returns the exit code.
[[nodiscard]] int run_program(const std::vector<Command>& commands, std::span<char*> arguments);

}  // namespace chronormal::cli

#endif  // CLI_OPTIONS_OPTIONS_H_
