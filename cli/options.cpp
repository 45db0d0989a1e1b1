// Hands the tables of options to the parser, and what the parser has to say to the user.

#include "cli/options.h"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <sstream>
#include <string_view>
#include <utility>

#include "cli/print.h"
#include "cli/table.h"
#include "cli/version.h"

namespace chronormal::cli {
namespace {

constexpr int kExitDone = 0, kExitUsage = 2;

CLI::Option* add_target(CLI::App& command, const std::string& names, bool* target, const std::string& help) {
  return command.add_flag(names, *target, help);
}

// The parser would take an empty text for none.
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
  if (rules.check) added->check(rules.check, "");
}

void add_command(const Command& command, CLI::App& program) {
  CLI::App* const added = program.add_subcommand(command.name, command.summary);
  added->group("Commands");
  added->footer(command.footer);
  for (const std::vector<Option>& table : command.tables)
    for (const Option& option : table) add_option(option, *added);
}

void say_where_help_is(std::string_view command) {
  say_raw(fmt::format("Try: chronormal{}{} --help\n", command.empty() ? "" : " ", command));
}

// Says the error, and returns its exit code.
int report(const std::string& command, const Error& error) {
  say(command, error.text());
  if (error.code == ErrorCode::kUsage) say_where_help_is(command);
  return static_cast<int>(error.code);
}

// A word that is no command deserves a better answer than the parser's.
bool is_known(const std::vector<Command>& commands, std::string_view first) {
  if (first.starts_with('-')) return true;
  std::string names;
  for (const Command& command : commands) {
    if (command.name == first) return true;
    names += (names.empty() ? "" : ", ") + command.name;
  }
  if (first.empty())
    say("", "name a command: " + names);
  else
    say("", fmt::format("there is no command '{}'; there are {}", first, names));
  say_where_help_is("");
  return false;
}

}  // namespace

Check check_whole(std::size_t least, std::size_t most) {
  const std::string range = most == static_cast<std::size_t>(-1)
                                ? fmt::format("of {} or more", grouped(least))
                                : fmt::format("from {} to {}", grouped(least), grouped(most));
  return [least, most, message = "it must be a whole number " + range](const std::string& value) {
    std::size_t number = 0;
    const char* const last = value.data() + value.size();
    const auto [end, code] = std::from_chars(value.data(), last, number);
    return code == std::errc{} && end == last && number >= least && number <= most ? "" : message;
  };
}

Check check_given(std::string message) {
  return [message = std::move(message)](const std::string& value) { return value.empty() ? message : ""; };
}

int run_program(const std::vector<Command>& commands, int argument_count, char** arguments) {
  CLI::App program("Normals of triangle meshes that deform: exact at every instant.", "chronormal");
  program.get_formatter()->label("SUBCOMMAND", "COMMAND");
  program.get_formatter()->label("Subcommands", "Commands");
  program.set_version_flag("--version", fmt::format("chronormal {}", kVersion));
  program.require_subcommand(1);
  program.footer("chronormal COMMAND --help explains a command.");
  for (const Command& command : commands) add_command(command, program);

  const std::string_view first = argument_count > 1 ? arguments[1] : "";
  if (!is_known(commands, first)) return kExitUsage;
  try {
    program.parse(argument_count, arguments);
  } catch (const CLI::Success& request) {  // --help and --version
    std::ostringstream text;
    (void)program.exit(request, text, text);
    const Status printed = print(text.str());
    return printed ? kExitDone : report("", printed.error());
  } catch (const CLI::ParseError& error) {
    const auto parsed = program.get_subcommands();
    const std::string name = parsed.empty() ? "" : parsed.front()->get_name();
    say(name, parsed.empty() ? fmt::format("there is no option '{}' before a command", first) : error.what());
    say_where_help_is(name);
    return kExitUsage;
  }
  const auto chosen = std::find_if(commands.begin(), commands.end(),
                                   [&](const Command& command) { return program.got_subcommand(command.name); });
  const Result<int> result = chosen->run();
  return result ? result.value() : report(chosen->name, result.error());
}

}  // namespace chronormal::cli
