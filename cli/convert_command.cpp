#include "chronormal/io/sequence.h"
#include "cli/command.h"

namespace chronormal::cli {
namespace {

struct Options {
  InputOptions input;
  CommonOptions common;
};

int run(const Options& options) {
  Progress progress(options.common.quiet);
  const auto input = read_input(options.input, progress);
  if (!input) return report("convert", input.error());
  if (const Status written = write_sequence(input.value().motion, options.common.output, options.common.force);
      !written)
    return report("convert", written.error());
  return kExitDone;
}

}  // namespace

void add_convert_command(CLI::App& program, int& exit_code) {
  CLI::App* command =
      program.add_subcommand("convert", "Write the keyframes of a motion, or of a built-in morph, as mesh files");
  command->group("Commands");
  auto options = std::make_shared<Options>();
  options->input.add_to(*command);
  options->common.add_to(*command, true);
  command->footer(
      "OUT is a file per keyframe: %d in its name stands for the number, %03d for 000, 001, ...\n"
      "The extension chooses the format: .obj, or .ply (binary).\n"
      "\nExamples:\n"
      "  chronormal convert --sample twist -o twist_%d.obj\n"
      "  chronormal convert scans/ -o frame_%03d.ply\n"
      "\nExit codes: 0 done, 1 failed, 2 usage, 3 input invalid");
  command->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace chronormal::cli
