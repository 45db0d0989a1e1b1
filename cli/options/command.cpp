// Parses the options that commands share, and opens inputs for them.
#include "cli/options/command.h"

#include <algorithm>
#include <string_view>
#include <system_error>
#include <utility>

#include "chronormal/io/builtin_morphs.h"
#include "chronormal/io/output.h"
#include "cli/ranks/ranks.h"
#include "cli/terminal/format.h"
#include "cli/terminal/print.h"
#include "cli/terminal/text.h"
#include "core/charconv.h"

namespace chronormal::cli {
namespace {

// Wrong velocities give curves that look like any others, so that nothing but a comparison with positions finds them.
Status warn_of_velocities(const std::string& command, MotionStream& stream) {
  const Result<VelocityFit> found = velocity_fit(stream);
  if (!found) return found.error();
  const VelocityFit& fit = found.value();
  if (fit.is_plausible()) return Success{};
  const bool is_reversed = fit.direction < 0 && fit.length > 0;
  say(command,
      is_reversed
          ? std::string(
                "the velocities point against the way that vertices go from keyframe to keyframe: hermite paths "
                "swing back and forth with them. Are they reversed, or keyframes too far apart?")
          : formatted("at the velocities of the keyframes vertices would go {:.3g} times the way that they go from "
                      "keyframe to keyframe: velocities count per second of the times of the keyframes, which files "
                      "without times have one second apart (--fps)",
                      fit.length),
      Tone::kWarning);
  return Success{};
}

std::string morph_names() {
  std::string names;
  for (const BuiltinMorph& morph : builtin_morphs()) names.append(morph.name).append(", ");
  return formatted("a built-in morph in place of files: {}or {}, which is a set of targets", names,
                   builtin_blend_shapes().front().name);
}

}  // namespace

std::vector<Option> JudgeArguments::table(const std::string& of_hosts) {
  return {{"--weighting NAME", &weighting,
           "how faces count in the right normals: area, angle, uniform, area-angle, max\n"
           "(default: as in the base normals of the file, else area)"},
          {"--for VIEWER,...", &hosts,
           of_hosts + ": three, babylon,\n"
                      "playcanvas, godot, filament, bevy; after compression: gltfpack, quantize,\n"
                      "meshopt; or all"},
          {"--host NAME,...", &hosts_by_old_name, "the old name of --for, for this version alone"},
          {"--samples N",
           &samples,
           "how many moments of each segment are judged, its ends included (default 21; in\n"
           "animations of more than 10 key intervals, and of more than 10 targets, fewer)",
           {.check = check_whole(2, kMostAuditSamples)}}};
}

Status JudgeArguments::read(const char* command, std::optional<Weighting>& to_weighting,
                            std::vector<Host>& to_hosts) const {
  if (!weighting.empty()) {
    const Result<Weighting> found = make_weighting(weighting);
    if (!found) return misuse("--weighting", found.error().message);
    to_weighting = found.value();
  }
  if (!hosts_by_old_name.empty() && !hosts.empty())
    return misuse("--host", "it is the old name of --for: give one of them");
  if (!hosts_by_old_name.empty())
    say(command, "--host is called --for now; the old name goes with the next version", Tone::kWarning);
  const std::string& named = hosts.empty() ? hosts_by_old_name : hosts;
  if (!named.empty()) {
    Result<std::vector<Host>> found = find_hosts(named);
    if (!found) return misuse(hosts.empty() ? "--host" : "--for", found.error().message);
    to_hosts = std::move(found).value();
  }
  return Success{};
}

Option ShardArgument::option(const std::string& of_what) { return {"--shard I/N", &text, of_what}; }

Result<std::optional<Shard>> ShardArgument::read() const {
  if (!text) return std::optional<Shard>();
  const std::string_view words = *text;
  const std::size_t slash = words.find('/');
  std::size_t index = 0, count = 0;
  const auto is_number = [](std::string_view digits, std::size_t& value) {
    const auto [end, code] = from_chars(digits.data(), digits.data() + digits.size(), value);
    return code == std::errc{} && end == digits.data() + digits.size();
  };
  const bool is_share = slash != std::string_view::npos && is_number(words.substr(0, slash), index) &&
                        is_number(words.substr(slash + 1), count) && index >= 1 && index <= count;
  if (!is_share) return misuse("--shard", formatted("'{}': it must be 1/8, 2/8, ... for one of 8 shares", *text));
  return std::optional(Shard{index - 1, count});
}

std::vector<Part> gather_parts(const std::string& own) {
  std::vector<Part> parts;
  for (std::string& text : gather_texts(own))
    parts.push_back({formatted("what rank {} has found", parts.size()), std::move(text)});
  return parts;
}

Status check_ranks(const std::string& option) {
  if (const std::size_t copies = count_of_copies(); copies > 1 && option != "--shard")
    return misuse("mpirun",
                  formatted("{} copies of this program were started, which was built without MPI: each of them would "
                            "do all of the work. Build it with -DCHRONORMAL_MPI=ON, or give each copy its --shard",
                            copies));
  if (!has_ranks() || option.empty()) return Success{};
  return misuse(option, "mpirun divides one motion and adds up its shares: leave out one of the two");
}

std::vector<Option> PathArgument::table(const std::string& what) {
  return {{"--path NAME", &name,
           "how vertices move between the keyframes of a sequence: linear (default), straight;\n"
           "catmull-rom, on curves through them; hermite, with the velocities of the file;\n" +
               what}};
}

Result<PathKind> PathArgument::read() const {
  Result<PathKind> path = make_path(name);
  if (!path) return misuse("--path", path.error().message);
  return path;
}

Status check_path(const std::string& command, Input& input, PathKind path) {
  if (path == PathKind::kLinear) return Success{};
  if (input.document() != nullptr)
    return misuse("--path", "the weights of a glTF file say how its vertices move: paths are of sequences");
  const Result<MotionStream*> stream = input.stream();
  if (!stream) return stream.error();
  if (const Status status = chronormal::check_path(stream.value()->motion(), path); !status)
    return misuse("--path", status.error().message);
  return path == PathKind::kHermite ? warn_of_velocities(command, *stream.value()) : Success{};
}

void warn_if_sparse(const std::string& command, PathKind path, std::size_t keyframes, double bend) {
  if (path == PathKind::kCatmullRom && keyframes == 2)
    say(command, "two keyframes have no curve through them: vertices move straight between them, as on linear paths",
        Tone::kWarning);
  if (!(path != PathKind::kLinear && is_too_sparse(bend))) return;
  say(command,
      formatted(
          "the keyframes are too far apart for a curve through them: its paths bend by {:.2f} of their length, and "
          "above {:.2f} nothing tells what happened between",
          up_to_hundredths(bend), kTooSparse),
      Tone::kWarning);
}

std::size_t keyframe_count(const Audit& audit) noexcept {
  return audit.subjects.empty() ? 3 : audit.subjects.front().segments + 1;
}

std::string path_words(PathKind path, std::size_t keyframes, double bend) {
  std::string words = formatted("{} paths, which ", path_name(path));
  if (keyframes > 2) return words + formatted("bend by {:.2f} of their length", up_to_hundredths(bend));
  return words + (path == PathKind::kCatmullRom ? "are straight between two keyframes"
                                                : "follow from two keyframes and their velocities");
}

Status check_hosts(const std::vector<Host>& hosts, const Input& input) {
  if (input.document() != nullptr || hosts.empty()) return Success{};
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
       "refuse a file that can be read but for a part of it, which is passed over otherwise"}};
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
  return input;
}

void say_written(const CommonOptions& common, const std::string& what) {
  if (!common.quiet && !is_stream(common.output)) say_text(formatted("-> {}: {}\n", printable(common.output), what));
}

Error misuse(std::string place, std::string message) {
  return Error{ErrorCode::kUsage, std::move(place), std::move(message)};
}

}  // namespace chronormal::cli
