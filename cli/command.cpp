#include "cli/command.h"

#include <fmt/core.h>

#include "chronormal/io/builtin_morphs.h"
#include "io/input/targets.h"
#include "io/mesh/make_human_target.h"

namespace chronormal::cli {
namespace {

std::string morph_list() {
  std::string list = "a built-in morph (compare --each takes several):";
  for (const BuiltinMorph& morph : builtin_morphs()) list += fmt::format("\n  {:<9} {}", morph.name, morph.summary);
  for (const BuiltinMorph& morph : builtin_blend_shapes())
    list += fmt::format("\n  {:<9} {}", morph.name, morph.summary);
  return list;
}

}  // namespace

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
          {"-q,--quiet", &quiet, "no progress bar"}};
}

std::vector<Option> InputOptions::table() {
  return {{"INPUT", &files,
           "one motion: .obj or .ply keyframes in order, a quoted pattern, a folder\n"
           "(sorted by number); a mesh and a .pc2, .mdd, .npy or Maya cache; one\n"
           ".gltf, .glb, .npz or .md2; - is one file on stdin"},
          {"--base FILE",
           &base,
           "the mesh of which every INPUT is a morph target: .obj or .ply meshes,\n"
           ".target or .target.gz of MakeHuman, folders of them",
           {.check = check_given("it must name a file")}},
          {"--animation NAME",
           &animation,
           "an animation of a glTF file, by name or index; without it\n"
           "every morph target is a segment",
           {.check = check_given("it must be a name or an index")}},
          {"--world", &world, "vertices of a glTF file are where its nodes put them"},
          {"--allow-external", &allow_external, "a glTF file may name files outside its folder"},
          {"--sample NAME", &samples, morph_list()},
          {"--fps N", &frames_per_second, "frames per second of the keyframes (default 1)"}};
}

std::vector<Option> ElementArguments::table() {
  const auto marked = [this](const char* name) { return usual == name ? fmt::format("{} (default)", name) : name; };
  return {{"--elements KIND", &asked,
           fmt::format("which normals: {}, {}, {}", marked("faces"), marked("vertices"), marked("corners"))},
          {"--crease DEG", &crease_angle,
           "corners: edges between faces that differ by more than this\n"
           "in the first keyframe are hard (default 180: none)"},
          {"--no-weld", &no_weld, "vertices at one point in all keyframes stay apart"}};
}

Result<ElementOptions> ElementArguments::options() const {
  const auto found = make_element_kind(kind());
  if (!found) return misuse("--elements", found.error().message);
  if (!(crease_angle >= 0 && crease_angle <= 180))
    return misuse("--crease", "it must be an angle from 0 to 180 degrees");
  if (crease_angle != 180 && found.value() != ElementKind::kCorners)
    return misuse("--crease", "only --elements corners can have hard edges");
  if (no_weld && found.value() == ElementKind::kFaces)
    return misuse("--no-weld", "faces are not welded: it goes with vertices or corners");
  return ElementOptions{found.value(), !no_weld, crease_angle};
}

std::string name_of_files(const std::vector<std::string>& files) {
  return files.size() == 1 ? files.front() : short_name(files.front()) + " ... " + short_name(files.back());
}

Status check_input(const InputOptions& options) {
  if (!(options.frames_per_second >= 1e-9 && options.frames_per_second <= 1e9))
    return misuse("--fps", "the frame rate must be a number from 1e-9 to 1e9");
  if (!options.animation.empty() && (!options.base.empty() || options.files.empty()))
    return misuse("--animation", "it chooses among those of a glTF file: name one");
  if (!options.base.empty()) {
    if (!options.samples.empty()) return misuse("--base", "a built-in morph is no target: give .obj, .ply or .target");
    if (options.files.empty()) return misuse("--base", "there is nothing to read: name the targets of the base");
    if (options.frames_per_second != 1)
      return misuse("--fps", "targets of a base have no frames: the base is at 0 s and every target at 1 s");
    return Success{};
  }
  if (options.files.empty() && options.samples.empty())
    return misuse("", "there is nothing to read: name the keyframes, or --sample NAME");
  if (options.samples.size() + (options.files.empty() ? 0 : 1) > 1)
    return misuse("", "there are several inputs: give one");
  for (const std::string& file : options.files) {
    if (is_make_human_target(file)) return misuse(file, "a target changes a mesh: name the mesh with --base FILE");
  }
  return Success{};
}

Result<NamedMotion> read_input(const InputOptions& options, Progress& progress) {
  if (const Status status = check_input(options); !status) return status.error();
  if (!options.base.empty()) {
    auto motion = read_targets(options.base, options.files, progress.callback("reading"));
    progress.clear();
    if (!motion) return motion.error();
    return NamedMotion{options.base, std::move(motion).value()};
  }
  if (!options.files.empty()) {
    auto motion = read_motion(options.files, options.motion_options(), progress.callback("reading"));
    progress.clear();
    if (!motion) return motion.error();
    return NamedMotion{name_of_files(options.files), std::move(motion).value()};
  }
  auto motion = make_builtin_morph(options.samples.front());
  if (!motion) return motion.error();
  return NamedMotion{options.samples.front(), std::move(motion).value()};
}

Result<NamedMotion> read_input_or_mesh(const InputOptions& options, Progress& progress) {
  if (options.files.empty() || !options.base.empty()) return read_input(options, progress);
  if (const Status status = check_input(options); !status) return status.error();
  auto motion = read_motion_or_mesh(options.files, options.motion_options(), progress.callback("reading"));
  progress.clear();
  if (!motion) return motion.error();
  return NamedMotion{name_of_files(options.files), std::move(motion).value()};
}

Error misuse(std::string place, std::string message) {
  return Error{ErrorCode::kUsage, std::move(place), std::move(message)};
}

}  // namespace chronormal::cli
