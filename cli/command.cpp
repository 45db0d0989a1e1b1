#include "cli/command.h"

#include <fmt/core.h>

#include <cstdio>

#include "chronormal/io/builtin_morphs.h"
#include "chronormal/io/motion_files.h"

namespace chronormal::cli {
namespace {

std::string morph_list() {
  std::string list = "a built-in morph, may be repeated:";
  for (const BuiltinMorph& morph : builtin_morphs()) list += fmt::format("\n  {:<9} {}", morph.name, morph.summary);
  return list;
}

}  // namespace

std::string short_name(std::string path) {
  while (path.size() > 1 && path.back() == '/') path.pop_back();
  const std::size_t slash = path.find_last_of('/');
  return slash == std::string::npos || slash + 1 == path.size() ? path : path.substr(slash + 1);
}

void CommonOptions::add_to(CLI::App& command, bool output_required) {
  CLI::Option* option = command.add_option(
      "-o,--output", output, output_required ? "where to write" : "where to write (default: standard output)");
  option->type_name("OUT");
  if (output_required) option->required();
  command.add_flag("--force", force, "overwrite OUT if it exists");
  command.add_flag("-q,--quiet", quiet, "no progress bar");
}

void InputOptions::add_to(CLI::App& command) {
  command
      .add_option("INPUT", files,
                  "one motion: .obj or .ply keyframes in order, a quoted pattern, a folder\n"
                  "(sorted by number); a mesh and a .pc2, .mdd, .npy or Maya cache; one\n"
                  ".npz or .md2; - is one file on stdin")
      ->type_name("");
  command.add_option("--sample", samples, morph_list())->type_name("NAME")->take_all()->allow_extra_args(false);
  command.add_option("--fps", frames_per_second, "frames per second of the keyframes (default 1)")->type_name("N");
}

Result<NamedMotion> read_files(const std::vector<std::string>& files, double frames_per_second, Progress& progress) {
  auto motion = read_motion(files, {frames_per_second}, progress.callback("reading"));
  progress.clear();
  if (!motion) return motion.error();
  const std::string name =
      files.size() == 1 ? files.front() : short_name(files.front()) + " ... " + short_name(files.back());
  return NamedMotion{name, std::move(motion).value()};
}

Result<NamedMotion> read_input(const InputOptions& options, Progress& progress) {
  if (options.files.empty() && options.samples.empty())
    return Error{ErrorCode::kUsage, "", "there is nothing to read: name the keyframes, or --sample NAME"};
  if (options.samples.size() + (options.files.empty() ? 0 : 1) > 1)
    return Error{ErrorCode::kUsage, "", "there are several inputs: give one"};
  if (!options.files.empty()) return read_files(options.files, options.frames_per_second, progress);
  auto motion = make_builtin_morph(options.samples.front());
  if (!motion) return motion.error();
  return NamedMotion{options.samples.front(), std::move(motion).value()};
}

int report(const std::string& command, const Error& error) {
  fmt::print(stderr, "chronormal {}: {}\n", command, error.text());
  if (error.code == ErrorCode::kUsage) fmt::print(stderr, "Try: chronormal {} --help\n", command);
  return static_cast<int>(error.code);
}

}  // namespace chronormal::cli
