// Defines the command `inspect`: its options, and how it lists what a file contains.
#include <memory>
#include <utility>

#include "chronormal/io/output.h"
#include "cli/options/command.h"
#include "cli/options/outputs.h"
#include "cli/reports/inspect_report.h"
#include "cli/terminal/print.h"
#include "workflow/json/json.h"

namespace chronormal::cli {
namespace {

struct InspectArguments {
  InputOptions input;
  CommonOptions common;
  bool json = false;
};

Result<Inspected> open_and_inspect(const InputOptions& options, Progress& progress) {
  InputOptions wanted = options;
  wanted.allow_mesh = true;
  wanted.stream = true;
  // Stored normals and groups are read too, since their faults affect audits and must be listed.
  wanted.shading = KeepShading::kFirst;
  Result<Input> input = open_input("inspect", std::move(wanted), progress);
  if (!input) return input.error();
  Result<Inspected> result =
      inspect_input(std::move(input).value(), options.animation, progress.callback("inspecting"));
  progress.clear();
  return result;
}

Result<int> run(const InspectArguments& options) {
  if (const Status output = check_output(options.common.output, options.common.force); !output) return output.error();
  const Status distinct = check_distinct({{"OUT", options.common.output}}, input_files(options.input));
  if (!distinct) return distinct.error();
  Progress progress(options.common.quiet);
  const auto inspected = open_and_inspect(options.input, progress);
  if (!inspected) return inspected.error();
  const std::string text = options.json ? inspect_json(inspected.value()) : inspect_text(inspected.value());
  if (const Status written = print_to(options.common.output, text, options.common.force); !written)
    return written.error();
  return kExitDone;
}

}  // namespace

Command inspect_command() {
  auto options = std::make_shared<InspectArguments>();
  return {"inspect",
          "List what a file contains and what may cause wrong normals",
          {input_table(options->input),
           {{"--json", &options->json, "print the result as JSON, for programs"}},
           options->common.table(false)},
          "INPUT is a motion or a single mesh. inspect lists what makes normals go wrong, such as faces without area, "
          "faces\nthat turn far, edges of more than two faces, vertices at the same point, and normals that do not "
          "follow a target.\nThese findings do not change the exit code.\n"
          "\nExamples:\n"
          "  chronormal inspect head.glb\n"
          "  chronormal inspect walk/ --json\n"
          "  chronormal inspect --base face.obj targets/\n"
          "\nExit codes: 0 done, 1 failed, 2 wrong usage, 3 invalid input",
          [options] { return run(*options); }};
}

}  // namespace chronormal::cli
