#include <memory>
#include <utility>

#include "chronormal/io/output.h"
#include "cli/options/command.h"
#include "cli/reports/inspect_report.h"
#include "cli/terminal/print.h"

namespace chronormal::cli {
namespace {

struct Options {
  InputOptions input;
  CommonOptions common;
  bool json = false;
};

// The motion or the mesh, which both are keyframes.
Status inspect_motion(Input& input, Inspected& result, Progress& progress) {
  const Result<const Motion*> read = input.motion();
  if (!read) return read.error();
  const Motion& motion = *read.value();
  result.inspection = inspect(motion, progress.callback("inspecting"));
  progress.clear();
  for (const Motion::Keyframe& keyframe : motion.keyframes) result.keyframe_names.push_back(keyframe.name);
  result.segments = motion.segments;
  result.kind = motion.kind;
  return Success{};
}

// What a glTF file holds beside, and what moves in it.
Status inspect_document(Input& input, const std::string& animation, Inspected& result, Progress& progress) {
  const GltfDocument& document = *input.document();
  Result<GltfInspection> inspection = inspect(document);
  if (!inspection) return inspection.error();
  InspectedGltf gltf;
  gltf.document = &document;
  gltf.inspection = std::move(inspection).value();
  if (!gltf.inspection.primitives.empty() || !animation.empty()) {
    if (Status status = inspect_motion(input, result, progress); !status) return status;
    if (!animation.empty()) gltf.animation = document.find_animation(animation).value();
    const Result<std::size_t> split = count_split_normals(document, *input.motion().value(), input.parts());
    if (!split) return split.error();
    gltf.split = split.value();
    gltf.parts = input.parts();
    gltf.curve_error = input.curve_error();
  }
  result.gltf = std::move(gltf);
  return Success{};
}

Result<Inspected> inspect_input(const InputOptions& options, Progress& progress) {
  InputOptions wanted = options;
  wanted.allow_mesh = true;
  Result<Input> input = open_input(std::move(wanted), progress);
  if (!input) return input.error();
  Inspected result{std::move(input).value(), {}, {}, {}, {}, {}};
  const Status status = result.opened.document() != nullptr
                            ? inspect_document(result.opened, options.animation, result, progress)
                            : inspect_motion(result.opened, result, progress);
  if (!status) return status.error();
  return result;
}

Result<int> run(const Options& options) {
  if (const Status output = check_output(options.common.output, options.common.force); !output) return output.error();
  Progress progress(options.common.quiet);
  const auto inspected = inspect_input(options.input, progress);
  if (!inspected) return inspected.error();
  const std::string text = options.json ? inspect_json(inspected.value()) : inspect_text(inspected.value());
  if (const Status written = print_to(options.common.output, text, options.common.force); !written)
    return written.error();
  return kExitDone;
}

}  // namespace

Command inspect_command() {
  auto options = std::make_shared<Options>();
  return {"inspect",
          "List what a file contains and what may cause wrong normals",
          {input_table(options->input),
           {{"--json", &options->json, "print one JSON object, for programs"}},
           options->common.table(false)},
          "A motion, or a single mesh. Trouble is what normals suffer from: faces without area at keyframes and on\n"
          "the way, faces that turn far, edges of more than two faces, doubled vertices, normals that do not follow.\n"
          "It does not change the exit code.\n"
          "\nExamples:\n"
          "  chronormal inspect head.glb\n"
          "  chronormal inspect walk/ --json\n"
          "  chronormal inspect --base face.obj targets/\n"
          "\nExit codes: 0 done, 1 failed, 2 usage, 3 input invalid",
          [options] { return run(*options); }};
}

}  // namespace chronormal::cli
