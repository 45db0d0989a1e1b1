// chronormal, the program: runs the command that the command line names, and maps what happened to an exit code.

#include <fmt/core.h>

#include <cstdio>
#include <exception>
#include <new>

#include "cli/command.h"

int main(int argument_count, char** arguments) {
  using namespace chronormal::cli;
  constexpr int kExitFailed = 1;
  try {
    return run_program(
        {audit_command(), bake_command(), compare_command(), convert_command(), inspect_command(), sample_command()},
        argument_count, arguments);
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "chronormal: out of memory\n");
  } catch (const std::exception& error) {
    fmt::print(stderr, "chronormal: internal error: {}\n", error.what());
  }
  return kExitFailed;
}
