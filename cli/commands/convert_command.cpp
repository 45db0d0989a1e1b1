// Defines the command `convert`, which writes a motion in another format.
#include <memory>
#include <utility>
#include <vector>

#include "chronormal/io/input.h"
#include "chronormal/io/output.h"
#include "cli/options/command.h"
#include "cli/options/outputs.h"
#include "cli/terminal/format.h"
#include "cli/terminal/print.h"
#include "core/text.h"
#include "io/bytes/expansion.h"
#include "io/input/write_motion.h"

namespace chronormal::cli {
namespace {

struct ConvertArguments {
  InputOptions input;
  CommonOptions common;
  bool no_weld = false;
};

std::string convert_footer() {
  std::string text =
      "The name of OUT chooses the format: .npz, .pc2 or .mdd is one file; .obj or .ply (binary) is a file for "
      "each\nkeyframe, with %d in the name for its number, or %03d for 000, 001, ... Targets over a base become morph "
      "targets\nof a .glb.\n"
      "\nBuilt-in morphs:\n";
  for (const auto& morphs : {builtin_morphs(), builtin_blend_shapes()})
    for (const BuiltinMorph& morph : morphs) text += formatted("  {:<9} {}\n", morph.name, morph.summary);
  return text +
         "\nExamples:\n"
         "  chronormal convert --sample twist -o twist_%d.obj\n"
         "  chronormal convert scans/ -o frame_%03d.ply\n"
         "  chronormal convert body.obj walk.pc2 -o walk.npz\n"
         "  chronormal convert face.glb --animation Smile -o smile.npz\n"
         "  chronormal convert --base face.obj targets/ -o face.glb\n"
         "\nExit codes: 0 done, 1 failed, 2 wrong usage, 3 invalid input";
}

Result<int> run(const ConvertArguments& options) {
  Progress progress(options.common.quiet);
  InputOptions wanted = options.input;
  wanted.allow_mesh = true;
  wanted.stream = true;
  // Only .npz files can store velocities.
  wanted.velocities = options.common.output.ends_with(".npz");
  Result<Input> input = open_input("convert", std::move(wanted), progress);
  if (!input) return input.error();
  const Result<MotionStream*> motion = input.value().stream();
  if (!motion) return motion.error();
  const std::string& output = options.common.output;
  std::vector<NamedFile> outputs = {{"OUT", output}};
  if (const auto names = numbered_names(output, motion.value()->motion().keyframes.size()))
    for (const std::string& name : names.value())
      if (name != output) outputs.push_back({"OUT", name});
  if (const Status distinct = check_distinct(outputs, input_files(options.input)); !distinct) return distinct.error();
  const bool is_float = output.ends_with(".pc2") || output.ends_with(".mdd");
  if (is_float && motion.value()->motion().origin != std::array<double, 3>{})
    say("convert",
        "the mesh is far from the origin, so that positions lose digits in this format (float32); write .npz or .ply "
        "to keep all digits",
        Tone::kWarning);
  const Status written = write_motion(*motion.value(), options.common.output, options.common.force,
                                      input.value().expansion(), !options.no_weld);
  if (!written) return written.error();
  const Motion& of_input = motion.value()->motion();
  const std::size_t keyframes = of_input.keyframes.size();
  const bool has_targets = of_input.kind == MotionKind::kTargets && keyframes > 1;
  say_written(options.common, formatted("{} of {}",
                                        has_targets ? "a base and " + counted(keyframes - 1, "target", "targets")
                                                    : counted(keyframes, "keyframe", "keyframes"),
                                        counted(of_input.topology.vertex_count(), "vertex", "vertices")));
  return kExitDone;
}

}  // namespace

Command convert_command() {
  auto options = std::make_shared<ConvertArguments>();
  return {"convert",
          "Write a motion, or a built-in morph, in another format",
          {input_table(options->input),
           {{"--no-weld",
             &options->no_weld,
             "do not merge vertices that are at the same point at all times\nThis only affects the normals of targets "
             "in a .glb",
             {.rare = true}}},
           options->common.table(true)},
          convert_footer(),
          [options] { return run(*options); }};
}

}  // namespace chronormal::cli
