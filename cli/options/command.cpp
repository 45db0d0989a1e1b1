// Parses the options that commands share, and opens inputs for them.
#include "cli/options/command.h"

#include <algorithm>
#include <optional>
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
#include "io/system/names.h"

namespace chronormal::cli {
namespace {

// Prints how finely curves were cut into straight pieces. Warns if velocities do not fit the positions, since curves
// with wrong velocities look plausible, and nothing else reveals the mistake.
void say_of_curves(const std::string& command, const CutPath& cut, std::size_t faces, bool is_quiet) {
  const auto warn = [&](const std::string& message) { say(command, message, Tone::kWarning); };
  if (!is_quiet)
    say_text(formatted(
        "{} paths: {} cut into {}, whose normals are within {} of the normals of the curves; rounding moves "
        "coordinates by up to {:.1g}{}\n",
        cut.skins ? "skinned" : path_name(cut.path.kind), counted(cut.segments, "segment", "segments"),
        counted(cut.pieces, "straight piece", "straight pieces"), with_degrees(formatted("{}", cut.path.tolerance)),
        cut.rounding, cut.skins ? ", in the scene's world" : ""));
  if (cut.beyond > 0)
    warn(
        formatted("in {} of {} (a case is one face in one segment), normals may differ by more than {} from the "
                  "normals of the curve: the face almost vanishes between two keyframes, or needs more straight pieces "
                  "than --max-expansion allows",
                  grouped(cut.beyond), counted(faces * cut.segments, "case", "cases"),
                  with_degrees(formatted("{}", cut.path.tolerance))));
  if (cut.path.kind == PathKind::kCatmullRom && cut.segments == 1)
    warn(
        "there are only two keyframes, so vertices move straight between them, as with --path linear; give more "
        "keyframes for curved paths");
  if (is_too_sparse(cut.bend))
    warn(
        formatted("the keyframes are too far apart for curves through them, which bend by {:.2f} of their length (at "
                  "most {:.2f} is reliable); give more keyframes",
                  up_to_hundredths(cut.bend), kTooSparse));
  const VelocityFit& fit = cut.velocities;
  if (fit.is_plausible()) return;
  const bool is_reversed = fit.direction < 0 && fit.length > 0;
  warn(is_reversed
           ? std::string("the velocities point against the motion of the vertices, so that hermite paths swing back "
                         "and forth; check whether the velocities are reversed, or give more keyframes")
           : formatted("the velocities do not fit the motion, since vertices would go {:.3g} times as far as they do; "
                       "velocities are per second, so check --fps, without which keyframes are one second apart",
                       fit.length));
}

std::string morph_names() {
  std::string names;
  for (const BuiltinMorph& morph : builtin_morphs()) names.append(morph.name).append(", ");
  return formatted("use a built-in morph instead of files\nNAME is {}or {}, which is a set of targets", names,
                   builtin_blend_shapes().front().name);
}

}  // namespace

Check check_viewers_given() { return check_given("the list of viewers is empty; name a viewer such as three, or all"); }

std::vector<Option> JudgeArguments::table(const std::string& of_viewers) {
  return {{"--weighting NAME",
           &weighting,
           "choose how much each face counts in the true normals\nNAME is area, angle, uniform, area-angle, max, "
           "inverse-edges or inverse-roots. The default is the weighting that the base normals of the file follow, or "
           "area if they follow none",
           {.rare = true}},
          {"--for VIEWER,...",
           &viewers,
           of_viewers + ", such as three,godot\nViewers are three, babylon, playcanvas, godot, filament and bevy. "
                        "Compressors, whose files a viewer then renders, are gltfpack, quantize and meshopt. The word "
                        "all stands for all viewers and compressors. The default is none",
           {.check = check_viewers_given()}},
          {"--host NAME,...",
           &viewers_by_old_name,
           "do the same as --for, whose old name this is\nUse --for, since the next version will not know --host",
           {.check = check_viewers_given(), .rare = true}},
          {"--samples N",
           &samples,
           "judge N moments of each segment\nBoth ends of the segment are included. The default is 21, and fewer in "
           "animations of more than 10 key intervals or 10 targets",
           {.check = check_whole(2, kMostAuditSamples), .rare = true}}};
}

Status JudgeArguments::read(const char* command, std::optional<Weighting>& to_weighting,
                            std::vector<Viewer>& to_viewers) const {
  if (!weighting.empty()) {
    const Result<Weighting> found = make_weighting(weighting);
    if (!found) return misuse("--weighting", found.error().message);
    to_weighting = found.value();
  }
  if (!viewers_by_old_name.empty() && !viewers.empty())
    return misuse("--host", "--host is the old name of --for; leave --host out");
  if (!viewers_by_old_name.empty())
    say(command, "--host is now called --for; use --for, since the next version will not know --host", Tone::kWarning);
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
  return misuse("--for",
                "viewers can only be chosen for a glTF file, and this input has another format; leave --for out");
}

std::string short_name(std::string path) {
  while (path.size() > 1 && is_separator(path.back())) path.pop_back();
  const std::size_t begin = begin_of_name(path);
  return begin == path.size() ? path : path.substr(begin);
}

std::vector<Option> CommonOptions::table(bool output_required) {
  return {{"-o,--output OUT",
           &output,
           output_required ? "the file to write" : "the file to write (default: standard output)",
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
       "a glTF file, keyframes or their folder, or a mesh and its cache\nKeyframes are .obj or .ply files in order, a "
       "quoted pattern of their names, or their folder, sorted by number. A cache is a .pc2, .mdd, .npy or Maya cache. "
       "Other motions in one file are .npz and .md2. The name - stands for one file on standard input"},
      {"--base FILE",
       &input.base,
       "use this mesh as the base, of which every INPUT is a morph target\nThe inputs are .obj or .ply meshes, .target "
       "or .target.gz files of MakeHuman, or folders of them",
       {.check = check_given("the name of the file is empty; give the name of the mesh that is the base")}},
      {"--animation NAME",
       &input.animation,
       "use this animation of a glTF file, by name or number\nWithout this option, each morph target is a motion of "
       "its own, from weight 0 to 1",
       {.check = check_given("the name of the animation is empty; give a name or a number")}},
      {"--world",
       &input.world,
       "place the meshes of a glTF file where its nodes put them\nBy default, each mesh stays in its own space",
       {.rare = true}},
      {"--allow-external",
       &input.allow_external,
       "allow a glTF file to use files outside of its folder",
       {.rare = true}},
      {"--max-expansion N",
       &input.max_expansion,
       "allow memory and output of N times the size of the input\nThe default is 100, and 32 MiB are always allowed. "
       "The limit keeps a small, hostile file from taking all memory",
       {.check = check_whole(0), .rare = true}},
      {"--sample NAME", &input.samples, morph_names()},
      {"--fps N", &input.frames_per_second,
       "set the keyframes per second, for formats without times\nThe default is 1"},
      {"--from K",
       &input.from,
       "begin a sequence with keyframe K, counted from 0\nThe default is 0",
       {.check = check_whole(0)}},
      {"--to K",
       &input.to,
       "end a sequence with keyframe K, counted from 0\nThe default is the last keyframe of the input",
       {.check = check_whole(0)}},
      {"--every N",
       &input.every,
       "use only every Nth keyframe of a sequence\nThe default is 1, for every keyframe",
       {.check = check_whole(1), .rare = true}},
      {"--loop", &input.loop, "let the first keyframe follow the last keyframe, as in a loop", {.rare = true}},
      {"--strict",
       &input.strict,
       "refuse a file if a part of the file would be ignored\nWithout this option, a warning says what was ignored",
       {.rare = true}},
      {"--path NAME",
       &input.path,
       "choose how vertices move between the keyframes of a sequence\nlinear (default) is straight, catmull-rom goes "
       "on curves through the keyframes, and hermite uses the velocities of the file. Curves are cut into straight "
       "pieces "
       "whose normals are within 0.01 degrees of the curve, or DEG with NAME:DEG, and at most --max-expansion pieces "
       "for each segment",
       {.check = check_path_name, .rare = true}}};
  for (const RefusedOption& option : refused)
    std::erase_if(table,
                  [&](const Option& one) { return one.spelling.substr(0, one.spelling.find(' ')) == option.name; });
  return table;
}

std::vector<Option> ElementArguments::table() {
  const auto marked = [this](const char* name) { return usual == name ? formatted("{} (default)", name) : name; };
  return {{"--elements KIND", &asked,
           formatted("use the normals of {}, {} or {}", marked("faces"), marked("vertices"), marked("corners"))},
          {"--crease DEG", &crease_angle,
           "treat edges sharper than DEG degrees as hard\nNeeds --elements corners. The angle is between two "
           "faces in the first keyframe. The default is 180, which makes no edge hard"},
          {"--no-weld", &no_weld, "do not merge vertices that are at the same point at all times", {.rare = true}}};
}

Result<ElementOptions> ElementArguments::options() const {
  const auto found = make_element_kind(kind());
  if (!found) return misuse("--elements", found.error().message);
  if (!(crease_angle >= 0 && crease_angle <= 180))
    return misuse("--crease", "the angle of hard edges must be from 0 to 180 degrees");
  if (crease_angle != 180 && found.value() != ElementKind::kCorners)
    return misuse("--crease", "only corners can have hard edges; add --elements corners");
  if (no_weld && found.value() == ElementKind::kFaces)
    return misuse("--no-weld",
                  "normals of faces do not depend on merged vertices; leave --no-weld out, or add --elements vertices");
  return ElementOptions{found.value(), !no_weld, crease_angle};
}

Result<Input> open_input(const char* command, InputOptions options, Progress& progress) {
  if (has_ranks() && std::find(options.files.begin(), options.files.end(), "-") != options.files.end())
    return misuse("-", "several MPI processes cannot share the standard input; name a file");
  options.progress = watching_ranks(progress.callback("reading"));
  Result<Input> input = chronormal::open_input(options);
  progress.clear();
  if (!input) return input;
  // Curved and skinned motions are read here, before the notes are printed, because reading them may add notes.
  std::optional<Error> fault;
  std::size_t faces = 0;
  if (options.is_curved() || (options.skins && input.value().document() != nullptr)) {
    const Result<MotionStream*> pieces = input.value().stream();
    if (pieces)
      faces = pieces.value()->motion().topology.face_count();
    else
      fault = pieces.error();
  }
  constexpr std::size_t kMostSaid = 8;
  const std::vector<std::string> notes = input.value().notes();
  for (std::size_t i = 0; i < std::min(notes.size(), kMostSaid); ++i) say(command, notes[i], Tone::kWarning);
  if (notes.size() > kMostSaid)
    say(command,
        counted(notes.size() - kMostSaid, "more note was", "more notes were") +
            " left out; chronormal inspect lists all notes",
        Tone::kWarning);
  if (fault) return *fault;
  if (options.is_curved() || input.value().cut_path().skins)
    say_of_curves(command, input.value().cut_path(), faces, progress.is_quiet());
  return input;
}

void say_written(const CommonOptions& common, const std::string& what) {
  if (!common.quiet && !is_stream(common.output)) say_text(formatted("-> {}: {}\n", printable(common.output), what));
}

Error misuse(std::string place, std::string message) {
  return Error{ErrorCode::kUsage, std::move(place), std::move(message)};
}

}  // namespace chronormal::cli
