// The command `convert` writes a motion in another format.
#include <memory>
#include <utility>

#include "chronormal/io/input.h"
#include "chronormal/io/output.h"
#include "cli/options/command.h"
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
      "The extension of OUT chooses the format: .npz, .pc2 or .mdd for one file; .obj or .ply (binary) for a\n"
      "file per keyframe, where %d in the name stands for the number, %03d for 000, 001, ...\n"
      "Targets over a base become morph targets of a .glb.\n"
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
         "\nExit codes: 0 done, 1 failed, 2 usage, 3 input invalid";
}

Result<int> run(const ConvertArguments& options) {
  Progress progress(options.common.quiet);
  InputOptions wanted = options.input;
  wanted.allow_mesh = true;
  wanted.stream = true;
  wanted.velocities = options.common.output.ends_with(".npz");  // the only output format with velocities
  Result<Input> input = open_input("convert", std::move(wanted), progress);
  if (!input) return input.error();
  const Result<MotionStream*> motion = input.value().stream();
  if (!motion) return motion.error();
  const std::string& output = options.common.output;
  const bool is_float = output.ends_with(".pc2") || output.ends_with(".mdd");
  if (is_float && motion.value()->motion().origin != std::array<double, 3>{})
    say("convert", "the positions are far from the origin, and this format keeps them as float32, which loses digits",
        Tone::kWarning);
  const Status written = write_motion(*motion.value(), options.common.output, options.common.force,
                                      input.value().expansion(), !options.no_weld);
  if (!written) return written.error();
  const Motion& of_input = motion.value()->motion();
  say_written(options.common, formatted("{} of {}", counted(of_input.keyframes.size(), "keyframe", "keyframes"),
                                        counted(of_input.topology.vertex_count(), "vertex", "vertices")));
  return kExitDone;
}

}  // namespace

Command convert_command() {
  auto options = std::make_shared<ConvertArguments>();
  return {"convert",
          "Write a motion, or a built-in morph, in another format",
          {input_table(options->input),
           {{"--no-weld", &options->no_weld,
             "targets: keep vertices apart in the normals that are at one point throughout"}},
           options->common.table(true)},
          convert_footer(),
          [options] { return run(*options); }};
}

}  // namespace chronormal::cli
