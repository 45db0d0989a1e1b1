// Parses the options that commands share, and opens inputs for them.
#include "cli/options/command.h"

#include <algorithm>
#include <string_view>
#include <system_error>
#include <utility>

#include "chronormal/io/input.h"
#include "chronormal/io/output.h"
#include "cli/ranks/ranks.h"
#include "cli/terminal/format.h"
#include "cli/terminal/print.h"
#include "cli/terminal/text.h"
#include "core/charconv.h"
#include "core/text.h"

namespace chronormal::cli {
namespace {

// Prints how curves were cut, and warns of velocities that do not fit: curves with wrong velocities look plausible, and
// only a comparison with positions reveals them.
void say_of_curves(const std::string& command, const CutPath& cut, std::size_t faces, bool is_quiet) {
  const auto warn = [&](const std::string& message) { say(command, message, Tone::kWarning); };
  if (!is_quiet)
    say_text(
        formatted("{} paths: {} cut into {}, whose normals are within {} degrees; coordinates are rounded by {:.1g}\n",
                  path_name(cut.path.kind), counted(cut.segments, "segment", "segments"),
                  counted(cut.pieces, "straight piece", "straight pieces"), cut.path.tolerance, cut.rounding));
  if (cut.beyond > 0)
    warn(formatted(
        "{} of {} faces in segments are further off: they all but vanish between two keyframes, or would take "
        "more pieces than --max-expansion allows",
        grouped(cut.beyond), grouped(faces * cut.segments)));
  if (cut.path.kind == PathKind::kCatmullRom && cut.segments == 1)
    warn("two keyframes have no curve through them: vertices move straight between them, as on linear paths");
  if (is_too_sparse(cut.bend))
    warn(
        formatted("the keyframes are too far apart for a curve through them: its paths bend by {:.2f} of their length, "
                  "and above {:.2f} nothing tells what happened between",
                  up_to_hundredths(cut.bend), kTooSparse));
  const VelocityFit& fit = cut.velocities;
  if (fit.is_plausible()) return;
  const bool is_reversed = fit.direction < 0 && fit.length > 0;
  warn(is_reversed
           ? std::string(
                 "the velocities point against the way that vertices go from keyframe to keyframe: hermite paths "
                 "swing back and forth with them. Are they reversed, or keyframes too far apart?")
           : formatted("at the velocities of the keyframes vertices would go {:.3g} times the way that they go from "
                       "keyframe to keyframe: velocities count per second of the times of the keyframes, which files "
                       "without times have one second apart (--fps)",
                       fit.length));
}

std::string morph_names() {
  std::string names;
  for (const BuiltinMorph& morph : builtin_morphs()) names.append(morph.name).append(", ");
  return formatted("a built-in morph in place of files: {}or {}, which is a set of targets", names,
                   builtin_blend_shapes().front().name);
}

}  // namespace

std::vector<Option> JudgeArguments::table(const std::string& of_viewers) {
  return {{"--weighting NAME", &weighting,
           "how faces count in the right normals: area, angle, uniform, area-angle, max,\n"
           "inverse-edges, inverse-roots (default: as in the base normals of the file, else area)"},
          {"--for VIEWER,...", &viewers,
           of_viewers + ": three, babylon,\n"
                        "playcanvas, godot, filament, bevy; after compression: gltfpack, quantize,\n"
                        "meshopt; or all"},
          {"--host NAME,...", &viewers_by_old_name, "the old name of --for, for this version alone"},
          {"--samples N",
           &samples,
           "how many moments of each segment are judged, its ends included (default 21; in\n"
           "animations of more than 10 key intervals, and of more than 10 targets, fewer)",
           {.check = check_whole(2, kMostAuditSamples)}}};
}

Status JudgeArguments::read(const char* command, std::optional<Weighting>& to_weighting,
                            std::vector<Viewer>& to_viewers) const {
  if (!weighting.empty()) {
    const Result<Weighting> found = make_weighting(weighting);
    if (!found) return misuse("--weighting", found.error().message);
    to_weighting = found.value();
  }
  if (!viewers_by_old_name.empty() && !viewers.empty())
    return misuse("--host", "it is the old name of --for: give one of them");
  if (!viewers_by_old_name.empty())
    say(command, "--host is called --for now; the old name goes with the next version", Tone::kWarning);
  const std::string& named = viewers.empty() ? viewers_by_old_name : viewers;
  if (!named.empty()) {
    Result<std::vector<Viewer>> found = find_viewers(named);
    if (!found) return misuse(viewers.empty() ? "--host" : "--for", found.error().message);
    to_viewers = std::move(found).value();
  }
  return Success{};
}

Status check_viewers(const std::vector<Viewer>& viewers, const Input& input) {
  if (input.document() != nullptr || viewers.empty()) return Success{};
  return misuse("--for", "viewers are known for what they make of glTF files; this input is none");
}

std::string short_name(std::string path) {
  while (path.size() > 1 && path.back() == '/') path.pop_back();
  const std::size_t slash = path.find_last_of('/');
  return slash == std::string::npos || slash + 1 == path.size() ? path : path.substr(slash + 1);
}

std::vector<Option> CommonOptions::table(bool output_required) {
  return {{"-o,--output OUT",
           &output,
           output_required ? "where to write" : "where to write (default: standard output)",
           {.required = output_required}},
          {"--force", &force, "overwrite OUT if it exists"},
          {"-q,--quiet", &quiet, "show no progress bar"}};
}

std::string check_path_name(const std::string& text) {
  const Result<Path> path = make_path(text);
  return path ? "" : path.error().message;
}

std::vector<Option> input_table(InputOptions& input, const std::vector<RefusedOption>& refused) {
  std::vector<Option> table = {
      {"INPUT", &input.files,
       "one motion: .obj or .ply keyframes in order, a quoted pattern of their names, or\n"
       "their folder (sorted by number, and at times that the numbers give); a mesh and a .pc2, .mdd, .npy or Maya "
       "cache;\n"
       "or one .gltf, .glb, .vrm, .npz or .md2 file; - stands for one file on standard input"},
      {"--base FILE",
       &input.base,
       "the mesh of which every INPUT is a morph target: .obj or .ply meshes,\n"
       ".target or .target.gz of MakeHuman, folders of them",
       {.check = check_given("it must name a file")}},
      {"--animation NAME",
       &input.animation,
       "the animation of a glTF file that moves the mesh, by name or number; without it\n"
       "each morph target is a motion of its own, from weight 0 to 1",
       {.check = check_given("it must be a name or an index")}},
      {"--world", &input.world, "place the vertices of a glTF file where its nodes put them"},
      {"--allow-external", &input.allow_external, "allow a glTF file to name files outside its folder"},
      {"--max-expansion N",
       &input.max_expansion,
       "let what is read ask for N times its size in memory and output (default 100;\n"
       "32 MiB are always allowed)",
       {.check = check_whole(0)}},
      {"--sample NAME", &input.samples, morph_names()},
      {"--fps N", &input.frames_per_second, "how many keyframes a second has, in formats without times (default 1)"},
      {"--from K",
       &input.from,
       "the first keyframe of a sequence that counts, from 0 (default 0)",
       {.check = check_whole(0)}},
      {"--to K",
       &input.to,
       "the last keyframe of a sequence that counts (default: the last there is)",
       {.check = check_whole(0)}},
      {"--every N", &input.every, "take every Nth keyframe of a sequence (default 1)", {.check = check_whole(1)}},
      {"--loop", &input.loop, "let the first of these keyframes follow the last one again, as in a loop"},
      {"--strict", &input.strict,
       "refuse a file that can be read but for a part of it, which is passed over otherwise"},
      {"--path NAME",
       &input.path,
       "how vertices move between the keyframes of a sequence: linear (default), straight;\n"
       "catmull-rom, on curves through them; hermite, with the velocities of the file. Curves\n"
       "are cut into straight pieces whose normals are within 0.01 degrees of the curve's, or\n"
       "DEG of NAME:DEG, and a segment into --max-expansion of them at most",
       {.check = check_path_name}}};
  for (const RefusedOption& option : refused)
    std::erase_if(table,
                  [&](const Option& one) { return one.spelling.substr(0, one.spelling.find(' ')) == option.name; });
  return table;
}

std::vector<Option> ElementArguments::table() {
  const auto marked = [this](const char* name) { return usual == name ? formatted("{} (default)", name) : name; };
  return {{"--elements KIND", &asked,
           formatted("which normals: {}, {}, {}", marked("faces"), marked("vertices"), marked("corners"))},
          {"--crease DEG", &crease_angle,
           "with --elements corners: make edges hard whose faces differ by more than this angle\n"
           "in the first keyframe (default 180: none)"},
          {"--no-weld", &no_weld, "keep vertices apart that are at one point in all keyframes"}};
}

Result<ElementOptions> ElementArguments::options() const {
  const auto found = make_element_kind(kind());
  if (!found) return misuse("--elements", found.error().message);
  if (!(crease_angle >= 0 && crease_angle <= 180))
    return misuse("--crease", "it must be an angle from 0 to 180 degrees");
  if (crease_angle != 180 && found.value() != ElementKind::kCorners)
    return misuse("--crease", "only corners can have hard edges: add --elements corners");
  if (no_weld && found.value() == ElementKind::kFaces)
    return misuse("--no-weld", "faces are not welded: it goes with vertices or corners");
  return ElementOptions{found.value(), !no_weld, crease_angle};
}

Result<Input> open_input(const char* command, InputOptions options, Progress& progress) {
  if (has_ranks() && std::find(options.files.begin(), options.files.end(), "-") != options.files.end())
    return misuse("-", "only one rank of MPI has the standard input: name a file");
  options.progress = watching_ranks(progress.callback("reading"));
  Result<Input> input = chronormal::open_input(options);
  progress.clear();
  if (!input) return input;
  constexpr std::size_t kMostSaid = 8;
  const std::vector<std::string> notes = input.value().notes();
  for (std::size_t i = 0; i < std::min(notes.size(), kMostSaid); ++i) say(command, notes[i], Tone::kWarning);
  if (notes.size() > kMostSaid)
    say(command, formatted("and {} more of this kind", notes.size() - kMostSaid), Tone::kWarning);
  if (!options.is_curved()) return input;
  const Result<MotionStream*> pieces = input.value().stream();
  if (!pieces) return pieces.error();
  say_of_curves(command, input.value().cut_path(), pieces.value()->motion().topology.face_count(), progress.is_quiet());
  return input;
}

void say_written(const CommonOptions& common, const std::string& what) {
  if (!common.quiet && !is_stream(common.output)) say_text(formatted("-> {}: {}\n", printable(common.output), what));
}

Error misuse(std::string place, std::string message) {
  return Error{ErrorCode::kUsage, std::move(place), std::move(message)};
}

}  // namespace chronormal::cli
