/// The options of a command as a table, and the program that reads them from a command line.
///
/// The parser behind it is a large template library: options.cpp alone includes it.
#ifndef CLI_OPTIONS_OPTIONS_H_
#define CLI_OPTIONS_OPTIONS_H_

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "chronormal/core/result.h"

namespace chronormal::cli {

/// From the value of an option, as it was written, to what is wrong with it; an empty text where nothing is.
using Check = std::function<std::string(const std::string& value)>;

/// A line of the table: one option, or the arguments that have no name.
struct Option {
  /// Where the value goes. Its type says what is understood: a bool is a flag, a list takes one value each time that
  /// the option is given, and what is optional knows whether the option was given.
  using Target = std::variant<bool*, std::string*, std::optional<std::string>*, std::vector<std::string>*, double*,
                              std::optional<double>*, std::size_t*, std::optional<std::size_t>*>;

  struct Rules {
    bool required = false;
    std::string needs = {}, excludes = {};  ///< an option further up in the table: "--blend"
    Check check = {};
  };

  std::string spelling;  ///< as the help has it: "-o,--output OUT", "--force", "INPUT"
  Target target;
  std::string help;
  Rules rules = {};
};

/// An option that other commands have and this one has not, with the reason, or with what to do instead.
struct RefusedOption {
  std::string name, reason;
};

/// A command of the program. Its tables of options come one after the other; the first chooses what is read, and help
/// shows it last.
struct Command {
  std::string name, summary;
  std::vector<std::vector<Option>> tables;
  std::string footer;
  std::function<Result<int>()> run;  ///< returns the exit code; the targets of the options have their values by then
  std::vector<RefusedOption> refused = {};
  bool shares = false;  ///< whether several ranks divide the task (cli/ranks/ranks.h)
};

/// A check that the value is a whole number in a range, in digits alone.
[[nodiscard]] Check check_whole(std::size_t least, std::size_t most = static_cast<std::size_t>(-1));

/// A check that there is a value, with the message otherwise.
[[nodiscard]] Check check_given(std::string message);

/// Reads the command line and runs the command that it names, or prints help, the version, --manual-page or
/// --completions SHELL (cli/options/help.h). An error goes to stderr
/// as "chronormal COMMAND: place: message". Returns the exit code.
[[nodiscard]] int run_program(const std::vector<Command>& commands, int argument_count, char** arguments);

}  // namespace chronormal::cli

#endif  // CLI_OPTIONS_OPTIONS_H_
