// chronormal, the program: reads the command line, runs one command, and maps what happened to an exit code.

#include <fmt/core.h>

#include <exception>
#include <new>
#include <string_view>

#include "cli/command.h"

namespace {

// The commands there are, for a first argument that is none of them; empty if it is one, or an option.
std::string commands_unless_known(const CLI::App& program, std::string_view first) {
  if (!first.empty() && first[0] == '-') return "";
  std::string names;
  for (const CLI::App* command : program.get_subcommands([](const CLI::App*) { return true; })) {
    if (command->get_name() == first) return "";
    names += (names.empty() ? "" : ", ") + command->get_name();
  }
  return names;
}

}  // namespace

int main(int argument_count, char** arguments) {
  using namespace chronormal::cli;
  constexpr int kExitFailed = 1, kExitUsage = 2;
  try {
    CLI::App program("Normals of triangle meshes that deform: exact at every instant.", "chronormal");
    program.get_formatter()->label("SUBCOMMAND", "COMMAND");
    program.get_formatter()->label("Subcommands", "Commands");
    program.set_version_flag("--version", "chronormal " CHRONORMAL_VERSION);
    program.require_subcommand(1);
    program.footer("chronormal COMMAND --help explains a command.");
    int exit_code = kExitDone;
    add_audit_command(program, exit_code);
    add_bake_command(program, exit_code);
    add_compare_command(program, exit_code);
    add_convert_command(program, exit_code);
    add_inspect_command(program, exit_code);
    add_sample_command(program, exit_code);
    // A word that is no command deserves a better answer than the parser's.
    const std::string_view first = argument_count > 1 ? arguments[1] : "";
    if (const std::string names = commands_unless_known(program, first); !names.empty()) {
      if (first.empty())
        fmt::print(stderr, "chronormal: name a command: {}\n", names);
      else
        fmt::print(stderr, "chronormal: there is no command '{}'; there are {}\n", first, names);
      fmt::print(stderr, "Try: chronormal --help\n");
      return kExitUsage;
    }
    try {
      program.parse(argument_count, arguments);
      return exit_code;
    } catch (const CLI::Success& request) {  // --help and --version
      return program.exit(request);
    } catch (const CLI::ParseError& error) {
      const auto parsed = program.get_subcommands();
      const std::string command = parsed.empty() ? "" : " " + parsed.front()->get_name();
      const std::string message =
          parsed.empty() ? fmt::format("there is no option '{}' before a command", first) : error.what();
      fmt::print(stderr, "chronormal{}: {}\nTry: chronormal{} --help\n", command, message, command);
      return kExitUsage;
    }
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "chronormal: out of memory\n");
  } catch (const std::exception& error) {
    fmt::print(stderr, "chronormal: internal error: {}\n", error.what());
  }
  return kExitFailed;
}
