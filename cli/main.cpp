// chronormal, the program: reads the command line, runs one command, and maps what happened to an exit code.

#include <fmt/core.h>

#include <exception>
#include <new>

#include "cli/command.h"

int main(int argument_count, char** arguments) {
  using namespace chronormal::cli;
  constexpr int kExitFailed = 1, kExitUsage = 2;
  try {
    CLI::App program("Normals of triangle meshes that deform: exact at every instant.", "chronormal");
    program.set_version_flag("--version", "chronormal " CHRONORMAL_VERSION);
    program.require_subcommand(1);
    program.footer("chronormal COMMAND --help explains a command.");
    int exit_code = kExitDone;
    add_compare_command(program, exit_code);
    add_convert_command(program, exit_code);
    try {
      program.parse(argument_count, arguments);
      return exit_code;
    } catch (const CLI::Success& request) {  // --help and --version
      return program.exit(request);
    } catch (const CLI::ParseError& error) {
      fmt::print(stderr, "chronormal: {}\nTry: chronormal --help\n", error.what());
      return kExitUsage;
    }
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "chronormal: out of memory\n");
  } catch (const std::exception& error) {
    fmt::print(stderr, "chronormal: internal error: {}\n", error.what());
  }
  return kExitFailed;
}
