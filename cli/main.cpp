// Starts the program chronormal: runs the command that the command line names, and turns its result into an exit code.

#include <exception>
#include <new>

#include "cli/options/command.h"
#include "cli/terminal/print.h"
#include "cli/terminal/process.h"
#include "io/system/names.h"

int main(int argument_count, char** arguments) {
  using namespace chronormal::cli;
  using chronormal::arguments_of_program;
  constexpr int kExitFailed = 1;
  prepare_process();
  try {
    return run_program({audit_command(), bake_command(), compare_command(), convert_command(), inspect_command(),
                        merge_command(), query_command(), report_command(), sample_command()},
                       arguments_of_program(argument_count, arguments));
  } catch (const std::bad_alloc&) {
    say_ending("out of memory; close other programs, or choose a smaller part of the input");
  } catch (const std::exception& error) {
    say("", std::string("internal error: ").append(error.what()), Tone::kError);
  }
  return kExitFailed;
}
