// Defines the command `convert`, which writes a motion in another format.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
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
#include "io/input/formats.h"
#include "io/input/write_motion.h"
#include "io/system/names.h"

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

// Returns a warning if files without times lose the times of a motion, or an empty text if they lose nothing: a reader
// places the keyframes 1 s apart.
std::string loss_of_times(const Motion& motion) {
  const std::vector<Motion::Keyframe>& keys = motion.keyframes;
  if (motion.kind == MotionKind::kTargets || keys.size() < 2) return "";
  if (motion.segments.size() + 1 != keys.size())
    return "these files hold no times, so that the motion glides where it should jump; write .npz to keep the jumps";
  constexpr double kSameStep = 1e-3, kSameRate = 1e-6;
  const double first = keys.front().time, step = (keys.back().time - first) / static_cast<double>(keys.size() - 1);
  for (std::size_t k = 0; k < keys.size(); ++k)
    if (!(std::fabs(keys[k].time - first - static_cast<double>(k) * step) <= kSameStep * step))
      return "these files hold no times, so that the keyframes are read 1 s apart; write .npz to keep their times";
  if (std::fabs(step - 1) <= kSameRate) return "";
  // A rate such as 24 per second is printed instead of 23.9999998, which comes from times in float32.
  const double rounded = std::round(1000 / step) / 1000, rate = 1 / step;
  return formatted("these files hold no times; read them with --fps {}, or write .npz to keep the times",
                   std::fabs(rounded * step - 1) <= kSameRate ? rounded : rate);
}

// Warns of everything that the input has and the format of the output cannot store.
void warn_of_losses(const ConvertArguments& options, const Motion& motion) {
  const std::string& output = options.common.output;
  const auto warn = [](const std::string& message) { say("convert", message, Tone::kWarning); };
  const bool is_float = output.ends_with(".pc2") || output.ends_with(".mdd");
  if (is_float && motion.origin != std::array<double, 3>{})
    warn(
        "the mesh is far from the origin, so that positions lose digits in this format (float32); write .npz or .ply "
        "to keep all digits");
  const Format* const format = find_format(output);
  if (format == nullptr || format->holds == Holds::kGltf) return;
  if (format->write_mesh != nullptr)
    if (const std::string loss = loss_of_times(motion); !loss.empty()) warn(loss);
  if (format->name != "npz" && !motion.keyframes.front().velocities.empty())
    warn("this format holds no velocities, but the input has some; write .npz to keep them");
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
  warn_of_losses(options, motion.value()->motion());
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
