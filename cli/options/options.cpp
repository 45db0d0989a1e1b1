// Passes the tables of options to the parser of command lines, and the messages of the parser to the user.

#include "cli/options/options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <set>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <utility>

#include "cli/options/help.h"
#include "cli/ranks/ranks.h"
#include "cli/terminal/format.h"
#include "cli/terminal/print.h"
#include "cli/terminal/process.h"
#include "cli/terminal/screen.h"
#include "cli/terminal/table.h"
#include "cli/terminal/text.h"
#include "cli/terminal/version.h"
#include "core/charconv.h"
#include "core/nearest.h"
#include "io/input/formats.h"
#include "io/system/names.h"

namespace chronormal::cli {
namespace {

constexpr int kExitDone = 0, kExitUsage = 2;

CLI::Option* add_target(CLI::App& command, const std::string& names, bool* target, const std::string& help) {
  return command.add_flag(names, *target, help);
}

// Adds an option whose text may be empty. A function sets the text, since the parser itself would treat an empty text
// as a missing one.
CLI::Option* add_target(CLI::App& command, const std::string& names, std::optional<std::string>* target,
                        const std::string& help) {
  return command.add_option_function<std::string>(
      names, [target](const std::string& value) { *target = value; }, help);
}

CLI::Option* add_target(CLI::App& command, const std::string& names, std::vector<std::string>* target,
                        const std::string& help) {
  CLI::Option* const option = command.add_option(names, *target, help);
  return names.front() == '-' ? option->take_all()->allow_extra_args(false) : option;
}

template <class T>
CLI::Option* add_target(CLI::App& command, const std::string& names, T* target, const std::string& help) {
  return command.add_option(names, *target, help);
}

// Describes the fault in the value of an option that takes a number. Returns an empty text if there is no fault. The
// parser would treat an empty value as a missing option, and accept "nan" as a number.
template <class T>
std::string fault_of_number(const T*, const std::string& value) {
  constexpr bool is_text = std::is_same_v<T, bool> || std::is_same_v<T, std::string> ||
                           std::is_same_v<T, std::optional<std::string>> || std::is_same_v<T, std::vector<std::string>>;
  if constexpr (is_text) return "";
  double number = 0;
  const bool is_number = CLI::detail::lexical_cast(value, number) && std::isfinite(number);
  return is_number ? "" : formatted("'{}' is not a number; give a number such as 0.5", printable(value));
}

void add_option(const Option& option, CLI::App& command) {
  const std::size_t blank = option.spelling.find(' ');
  const std::string names = option.spelling.substr(0, blank);
  CLI::Option* const added =
      std::visit([&](auto* target) { return add_target(command, names, target, option.help); }, option.target);
  if (!std::holds_alternative<bool*>(option.target))
    added->type_name(blank == std::string::npos ? "" : option.spelling.substr(blank + 1));
  const Option::Rules& rules = option.rules;
  added->required(rules.required);
  if (!rules.needs.empty()) added->needs(command.get_option(rules.needs));
  if (!rules.excludes.empty()) added->excludes(command.get_option(rules.excludes));
  // The check that the table has for the option runs first, because its message says more than "'x' is not a number".
  added->check(
      [target = option.target, check = rules.check](const std::string& value) {
        std::string wrong = check ? check(value) : "";
        if (!wrong.empty()) return wrong;
        return std::visit([&](const auto* of_type) { return fault_of_number(of_type, value); }, target);
      },
      "");
}

void add_command(const Command& command, CLI::App& program) {
  CLI::App* const added = program.add_subcommand(command.name, command.summary);
  for (const std::vector<Option>& table : command.tables)
    for (const Option& option : table) add_option(option, *added);
}

void say_where_help_is(std::string_view command) {
  say_raw(formatted("Try: chronormal{}{} --help\n", command.empty() ? "" : " ", command));
}

int report(const std::string& command, const Error& error) {
  say(command, error.text(), Tone::kError);
  if (error.code == ErrorCode::kUsage) say_where_help_is(command);
  return static_cast<int>(error.code);
}

int print_or_report(const std::string& text) {
  const Status printed = print(text);
  return printed ? kExitDone : report("", printed.error());
}

// Returns "; did you mean NAME?" with the name that is most similar to the word, or an empty text if no name is
// similar.
std::string suggestion(std::string_view word, const std::vector<std::string>& names) {
  const std::string nearest = nearest_name(word, names);
  return nearest.empty() ? "" : formatted("; did you mean {}?", nearest);
}

// Checks the name of the command. Returns false after printing an error. The parser would check the name too, but its
// message is not helpful.
bool is_known(const std::vector<Command>& commands, std::string_view first) {
  if (first.starts_with('-')) return true;
  std::vector<std::string> names;
  std::string list;
  for (const Command& command : commands) {
    if (command.name == first) return true;
    names.push_back(command.name);
    list += (list.empty() ? "" : ", ") + command.name;
  }
  const auto is_file = [first] {
    std::error_code error;
    return find_format(first) != nullptr || std::filesystem::exists(path_of(std::string(first)), error);
  };
  if (first.empty())
    say("", "the command is missing; choose one of " + list, Tone::kError);
  else if (const std::string nearest = suggestion(first, names); !nearest.empty())
    say("", formatted("there is no command '{}'{} Choose one of {}", first, nearest, list), Tone::kError);
  else if (is_file())
    say("",
        formatted("the command is missing before '{0}'; write 'chronormal audit {0}', or choose another of {1}", first,
                  list),
        Tone::kError);
  else
    say("", formatted("there is no command '{}'; choose one of {}", first, list), Tone::kError);
  say_where_help_is("");
  return false;
}

bool is_in(const std::vector<std::string>& list, std::string_view name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

std::vector<std::string> names_of_options(const Command& command, bool only_with_value = false) {
  std::vector<std::string> names;
  for (const std::vector<Option>& table : command.tables) {
    for (const Option& option : table) {
      if (only_with_value && !takes_value(option)) continue;
      const std::vector<std::string> own = names_of(option);
      names.insert(names.end(), own.begin(), own.end());
    }
  }
  return names;
}

// Returns the error for an option in the place of the command.
Error misplaced_option(std::string_view option, const std::vector<Command>& commands,
                       std::span<char* const> arguments) {
  const auto names_one = [&](std::string_view word) {
    return std::any_of(commands.begin(), commands.end(), [&](const Command& command) { return command.name == word; });
  };
  if (std::any_of(arguments.begin(), arguments.end(), names_one))
    return Error{ErrorCode::kUsage, "",
                 formatted("option '{}' stands before the command; put the option after the command", option)};
  const bool belongs_to_one = std::any_of(commands.begin(), commands.end(), [&](const Command& command) {
    return is_in(names_of_options(command), option.substr(0, option.find('=')));
  });
  if (belongs_to_one)
    return Error{ErrorCode::kUsage, "",
                 formatted("the command is missing before option '{0}'; write chronormal COMMAND {0}", option)};
  const std::vector<std::string> own = {"--help", "--help-all", "--version", "--manual-page", "--completions"};
  return Error{
      ErrorCode::kUsage, "",
      formatted("there is no option '{}'{}", option, option == "-v" ? "; did you mean -V?" : suggestion(option, own))};
}

// Returns advice on an unknown option. The advice is the reason that the command gives for refusing the option, or else
// the commands that have the option, or else the most similar option of this command.
std::string advice_on(std::string_view name, const Command& command, const std::vector<Command>& commands) {
  for (const RefusedOption& refused : command.refused)
    if (refused.name == name) return " here; " + refused.reason;
  std::string others;
  for (const Command& other : commands)
    if (is_in(names_of_options(other), name)) others += (others.empty() ? "" : ", ") + other.name;
  if (!others.empty()) return " here; this option belongs to " + others;
  std::vector<std::string> own = names_of_options(command);
  own.emplace_back("--help");
  return suggestion(name, own);
}

// Returns the option of a command that has the name, or nullptr.
const Option* find_option(const Command& command, std::string_view name) {
  for (const std::vector<Option>& table : command.tables)
    for (const Option& option : table)
      if (is_in(names_of(option), name)) return &option;
  return nullptr;
}

// Finds the first option that is unknown, or that is given again although it takes only one value. (The parser would
// first report a required option that is missing.) If an option takes a value, the next word is its value, whatever the
// word looks like.
std::optional<Error> find_misused_option(const Command& command, const std::vector<Command>& commands,
                                         std::span<char* const> arguments) {
  std::set<const Option*> given;
  std::vector<std::string> names = names_of_options(command);
  const std::vector<std::string> with_value = names_of_options(command, true);
  names.insert(names.end(), {"-h", "--help", "--help-all"});
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string_view word = arguments[i];
    if (word == "--") break;
    if (word.size() < 2 || word.front() != '-') continue;
    const bool is_long = word.starts_with("--");
    const std::string_view name = is_long ? word.substr(0, word.find('=')) : word.substr(0, 2);
    if (!is_in(names, name))
      return Error{ErrorCode::kUsage, "",
                   formatted("there is no option '{}'{}", name, advice_on(name, command, commands))};
    const Option* const option = find_option(command, name);
    const bool takes_one = option != nullptr && is_in(with_value, name) &&
                           !std::holds_alternative<std::vector<std::string>*>(option->target);
    if (takes_one && !given.insert(option).second)
      return Error{ErrorCode::kUsage, std::string(name),
                   option->spelling.ends_with(",...")
                       ? formatted("this option is given twice; give it once, with a comma between the values, as in "
                                   "{} A,B",
                                   name)
                       : "this option is given twice; give it once"};
    if (name == word && is_in(with_value, name)) ++i;
  }
  return std::nullopt;
}

// Parses the command line and runs the command. `running` gets the name of the command. When the function returns, all
// messages of the parser have been printed.
Result<int> understand_and_run(const std::vector<Command>& commands, std::span<char*> arguments, std::string& running) {
  CLI::App program("", "chronormal");
  const std::string version = formatted("chronormal {}{}\n", kVersion, has_mpi() ? " with MPI" : "");
  program.set_version_flag("-V,--version", version);
  program.set_help_all_flag("--help-all");
  program.require_subcommand(1);
  for (const Command& command : commands) add_command(command, program);

  const std::string_view first = arguments.size() > 1 ? arguments[1] : "",
                         second = arguments.size() > 2 ? arguments[2] : "";
  if (first == "--manual-page") return print_or_report(manual_page(commands));
  if (first == "--completions") {
    const Result<std::string> text = completions(commands, second);
    return text ? print_or_report(text.value()) : report("", text.error());
  }
  const std::string_view asked = first == "help" && !second.empty() ? second : first;
  if (asked == "help" || (first == "help" && second.starts_with('-')))
    return print_or_report(help_of_program(commands, columns_of_output()));
  if (!is_known(commands, asked)) return kExitUsage;
  constexpr std::string_view kOwn[] = {"-h", "--help", "--help-all", "-V", "--version"};
  if (first.starts_with('-') && std::find(std::begin(kOwn), std::end(kOwn), first) == std::end(kOwn))
    return report("", misplaced_option(first, commands, arguments.subspan(2)));
  const auto command_of = [&](std::string_view name) {
    return std::find_if(commands.begin(), commands.end(), [&](const Command& command) { return command.name == name; });
  };
  if (first == "help") return print_or_report(help_of_command(*command_of(asked), false, columns_of_output()));
  if (const auto named = command_of(first); named != commands.end()) {
    if (const auto misused = find_misused_option(*named, commands, arguments.subspan(2)))
      return report(named->name, *misused);
  }
  const auto print_help = [&](bool all) {
    const auto parsed = program.get_subcommands();
    return print_or_report(parsed.empty()
                               ? help_of_program(commands, columns_of_output())
                               : help_of_command(*command_of(parsed.front()->get_name()), all, columns_of_output()));
  };
  try {
    program.parse(static_cast<int>(arguments.size()), arguments.data());
  } catch (const CLI::CallForVersion&) {
    return print_or_report(version);
  } catch (const CLI::CallForAllHelp&) {
    return print_help(true);
  } catch (const CLI::Success&) {  // thrown for --help
    return print_help(false);
  } catch (const CLI::RequiredError&) {  // only an output is ever required, because is_known() has found the command
    const auto parsed = program.get_subcommands();
    return report(parsed.empty() ? "" : parsed.front()->get_name(),
                  Error{ErrorCode::kUsage, "", "the output is missing; name it with -o OUT"});
  } catch (const CLI::ParseError& error) {
    const auto parsed = program.get_subcommands();
    const std::string name = parsed.empty() ? "" : parsed.front()->get_name();
    say(name, error.what(), Tone::kError);
    say_where_help_is(name);
    return kExitUsage;
  }
  const auto chosen = std::find_if(commands.begin(), commands.end(),
                                   [&](const Command& command) { return program.got_subcommand(command.name); });
  running = chosen->name;
  if (has_ranks() && !chosen->shares)
    return Error{ErrorCode::kUsage, "mpirun",
                 "only compare, audit and sample can run on several MPI processes; run this command without mpirun"};
  return chosen->run();
}

}  // namespace

Check check_whole(std::size_t least, std::size_t most) {
  const std::string range = most == static_cast<std::size_t>(-1)
                                ? formatted("of at least {}", grouped(least))
                                : formatted("from {} to {}", grouped(least), grouped(most));
  return [least, most, message = "the value must be a whole number " + range](const std::string& value) {
    std::size_t number = 0;
    const char* const last = value.data() + value.size();
    const auto [end, code] = from_chars(value.data(), last, number);
    return code == std::errc{} && end == last && number >= least && number <= most ? "" : message;
  };
}

Check check_given(std::string message) {
  return [message = std::move(message)](const std::string& value) { return value.empty() ? message : ""; };
}

int run_program(const std::vector<Command>& commands, std::span<char*> arguments) {
  // The name of the command for error messages. It is empty until the command is known.
  std::string name;
  start_ranks([&name](const Error& error) { return report(name, error); });
  return end_ranks(understand_and_run(commands, arguments, name));
}

}  // namespace chronormal::cli
