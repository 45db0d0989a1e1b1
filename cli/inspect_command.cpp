#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <system_error>

#include "chronormal/io/file.h"
#include "chronormal/io/motion_files.h"
#include "cli/command.h"
#include "cli/inputs.h"
#include "cli/inspect_report.h"
#include "io/cache/motion_readers.h"
#include "io/mesh/mesh_readers.h"

namespace chronormal::cli {
namespace {

constexpr const char* kStdin = "<stdin>";  // as errors have it

struct Options {
  InputOptions input;
  CommonOptions common;
  bool json = false;
};

void take_motion(const Motion& motion, Inspected& result, Progress& progress) {
  result.inspection = inspect(motion, progress.callback("inspecting"));
  progress.clear();
  for (const Motion::Keyframe& keyframe : motion.keyframes) result.keyframe_names.push_back(keyframe.name);
  result.segments = motion.segments;
}

Result<Inspected> inspect_gltf(std::unique_ptr<FileBytes> file, const InputOptions& options, Progress& progress) {
  const std::string& path = options.files.front();
  const std::string name = path == "-" ? kStdin : path;
  std::optional<std::string> folder;
  if (path != "-") folder = std::filesystem::path(path).parent_path().string();
  auto opened = GltfDocument::read(file->bytes(), path == "-" ? name : short_name(path), folder,
                                   {.allow_external = options.allow_external});
  if (!opened) return opened.error();
  GltfDocument document = std::move(opened).value();
  auto inspection = inspect(document);
  if (!inspection) return inspection.error();
  const auto& primitives = inspection.value().primitives;
  const bool moves = std::any_of(primitives.begin(), primitives.end(), [](const auto& p) { return p.moving > 0; });
  Inspected result;
  result.name = name;
  std::vector<GltfPart> parts;
  double curve_error = 0;
  std::size_t split = 0;
  std::optional<std::size_t> animation;
  if (!primitives.empty() || !options.animation.empty()) {
    GltfMotionOptions motion_options;
    motion_options.animation = options.animation;
    motion_options.world = options.world;
    const bool is_mesh = !moves && options.animation.empty();
    auto read = is_mesh ? read_gltf_mesh(document, motion_options) : read_gltf_motion(document, motion_options);
    if (!read) return read.error();
    if (!options.animation.empty()) animation = document.find_animation(options.animation).value();
    const auto counted_split = count_split_normals(document, read.value());
    if (!counted_split) return counted_split.error();
    split = counted_split.value();
    take_motion(read.value().motion, result, progress);
    result.is_star = moves && options.animation.empty();
    parts = std::move(read.value().parts);
    curve_error = read.value().curve_error;
  }
  result.gltf = InspectedGltf{std::move(file),  std::move(document), std::move(inspection).value(),
                              std::move(parts), curve_error,         split,
                              animation};
  return result;
}

Result<Inspected> inspect_input(const InputOptions& options, Progress& progress) {
  if (const Status status = check_input(options); !status) return status.error();
  Inspected result;
  if (is_one_file(options)) {
    const std::string& path = options.files.front();
    auto opened = FileBytes::open(path);
    if (!opened) return opened.error();
    auto file = std::make_unique<FileBytes>(std::move(opened).value());
    if (is_gltf(path, file->bytes())) return inspect_gltf(std::move(file), options, progress);
    if (path == "-") {
      const auto motion = read_motion_or_mesh(file->bytes(), path, options.motion_options());
      if (!motion) return motion.error();
      result.name = kStdin;
      take_motion(motion.value(), result, progress);
      return result;
    }
  }
  const auto input = read_input_or_mesh(options, progress);
  if (!input) return input.error();
  result.name = input.value().name;
  take_motion(input.value().motion, result, progress);
  result.is_star = !options.base.empty();
  return result;
}

Result<int> run(const Options& options) {
  if (const Status output = check_output(options.common.output, options.common.force); !output) return output.error();
  Progress progress(options.common.quiet);
  const auto inspected = inspect_input(options.input, progress);
  if (!inspected) return inspected.error();
  const std::string text = options.json ? inspect_json(inspected.value()) : inspect_text(inspected.value());
  if (const Status written = write_output(options.common.output, text, options.common.force); !written)
    return written.error();
  return kExitDone;
}

}  // namespace

Command inspect_command() {
  auto options = std::make_shared<Options>();
  return {"inspect",
          "What is in a file, and what in it will trouble you",
          {options->input.table(), {{"--json", &options->json, "one JSON object"}}, options->common.table(false)},
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
