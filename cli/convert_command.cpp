#include <optional>

#include "chronormal/io/file.h"
#include "chronormal/io/motion_files.h"
#include "chronormal/io/motion_readers.h"
#include "chronormal/io/readers.h"
#include "chronormal/io/sequence.h"
#include "cli/command.h"

namespace chronormal::cli {
namespace {

struct Options {
  InputOptions input;
  CommonOptions common;
};

// A single mesh, which is no motion but can be written all the same; nothing where the inputs are not one file.
Result<std::optional<Motion>> read_single_mesh(const InputOptions& options) {
  if (options.files.empty() || !options.samples.empty()) return std::optional<Motion>();
  const auto frames = find_frames(options.files);
  if (!frames) return frames.error();
  if (frames.value().size() != 1) return std::optional<Motion>();
  const std::string& path = frames.value().front();
  if (find_motion_reader(path) != nullptr) return std::optional<Motion>();
  const auto file = FileBytes::open(path);
  if (!file) return file.error();
  auto mesh = read_mesh(file.value().bytes(), path == "-" ? "<stdin>" : path);
  if (!mesh) return mesh.error();
  MeshFrame frame = std::move(mesh).value();
  return std::optional<Motion>(Motion{std::move(frame.topology), {{std::move(frame.positions), 0, path}}, {}});
}

int run(const Options& options) {
  const auto single = read_single_mesh(options.input);
  if (!single) return report("convert", single.error());
  if (single.value()) {
    const Status written = write_sequence(*single.value(), options.common.output, options.common.force);
    return written ? kExitDone : report("convert", written.error());
  }

  Progress progress(options.common.quiet);
  const auto input = read_input(options.input, progress);
  if (!input) return report("convert", input.error());
  if (const Status written = write_motion(input.value().motion, options.common.output, options.common.force); !written)
    return report("convert", written.error());
  return kExitDone;
}

}  // namespace

void add_convert_command(CLI::App& program, int& exit_code) {
  CLI::App* command = program.add_subcommand("convert", "Write a motion, or a built-in morph, in another format");
  command->group("Commands");
  auto options = std::make_shared<Options>();
  options->input.add_to(*command);
  options->common.add_to(*command, true);
  command->footer(
      "The extension of OUT chooses the format: .npz, .pc2 or .mdd for one file; .obj or .ply (binary) for a\n"
      "file per keyframe, where %d in the name stands for the number, %03d for 000, 001, ...\n"
      "\nExamples:\n"
      "  chronormal convert --sample twist -o twist_%d.obj\n"
      "  chronormal convert scans/ -o frame_%03d.ply\n"
      "  chronormal convert body.obj walk.pc2 -o walk.npz\n"
      "\nExit codes: 0 done, 1 failed, 2 usage, 3 input invalid");
  command->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace chronormal::cli
