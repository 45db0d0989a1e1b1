#include "cli/command.h"

#include "chronormal/io/builtin_morphs.h"
#include "cli/format.h"

namespace chronormal::cli {
namespace {

std::string morph_list() {
  std::string list = "a built-in morph (compare --each takes several):";
  for (const BuiltinMorph& morph : builtin_morphs()) list += formatted("\n  {:<9} {}", morph.name, morph.summary);
  for (const BuiltinMorph& morph : builtin_blend_shapes()) list += formatted("\n  {:<9} {}", morph.name, morph.summary);
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

std::vector<Option> input_table(InputOptions& input) {
  return {{"INPUT", &input.files,
           "one motion: .obj or .ply keyframes in order, a quoted pattern, a folder\n"
           "(sorted by number); a mesh and a .pc2, .mdd, .npy or Maya cache; one\n"
           ".gltf, .glb, .vrm, .npz or .md2; - is one file on stdin"},
          {"--base FILE",
           &input.base,
           "the mesh of which every INPUT is a morph target: .obj or .ply meshes,\n"
           ".target or .target.gz of MakeHuman, folders of them",
           {.check = check_given("it must name a file")}},
          {"--animation NAME",
           &input.animation,
           "an animation of a glTF file, by name or index; without it\n"
           "every morph target is a segment",
           {.check = check_given("it must be a name or an index")}},
          {"--world", &input.world, "vertices of a glTF file are where its nodes put them"},
          {"--allow-external", &input.allow_external, "a glTF file may name files outside its folder"},
          {"--max-expansion N",
           &input.max_expansion,
           "what is read may ask for N times its bytes of memory and output (default 100;\n"
           "always for 32 MiB)",
           {.check = check_whole(0)}},
          {"--sample NAME", &input.samples, morph_list()},
          {"--fps N", &input.frames_per_second, "frames per second of the keyframes (default 1)"}};
}

std::vector<Option> ElementArguments::table() {
  const auto marked = [this](const char* name) { return usual == name ? formatted("{} (default)", name) : name; };
  return {{"--elements KIND", &asked,
           formatted("which normals: {}, {}, {}", marked("faces"), marked("vertices"), marked("corners"))},
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

Result<Input> open_input(InputOptions options, Progress& progress) {
  options.progress = progress.callback("reading");
  Result<Input> input = chronormal::open_input(options);
  progress.clear();
  return input;
}

Error misuse(std::string place, std::string message) {
  return Error{ErrorCode::kUsage, std::move(place), std::move(message)};
}

}  // namespace chronormal::cli
