// Reads morph targets over a base. A target is a mesh with the faces of the base, or a file of deltas.
#include "io/input/targets.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "chronormal/motion/motion.h"
#include "core/twofold.h"
#include "io/bytes/expansion.h"
#include "io/bytes/extension.h"
#include "io/bytes/file.h"
#include "io/bytes/known_kinds.h"
#include "io/input/formats.h"
#include "io/mesh/make_human_target.h"
#include "io/system/names.h"

namespace chronormal::inline internal {
namespace {

namespace fs = std::filesystem;

// Returns the format that the name of a file gives, or nullptr if a target cannot have this format.
const Format* target_format(const std::string& file_name) {
  const Format* const format = find_format(file_name);
  return format != nullptr && (format->holds == Holds::kTarget || format->holds == Holds::kMesh) ? format : nullptr;
}

bool is_same_file(const std::string& a, const std::string& b) {
  std::error_code ignored;  // a missing file is reported when it is opened
  return a == b || fs::equivalent(path_of(a), path_of(b), ignored);
}

// Returns all targets in a folder and its subfolders, except the base.
Result<std::vector<std::string>> list_targets(const std::string& folder, const std::string& base) {
  std::error_code code;
  fs::recursive_directory_iterator entries(path_of(folder), code);
  std::vector<std::string> files;
  const Format* format = nullptr;
  while (!code && entries != fs::recursive_directory_iterator{}) {
    const std::string path = utf8_of(entries->path()), name = file_name(path);
    const Format* const own = target_format(name);
    std::error_code ignored;  // a broken link does not count as a file
    if (name.starts_with('.')) {
      entries.disable_recursion_pending();
    } else if (own != nullptr && !fs::is_directory(entries->path(), ignored) && !is_same_file(path, base)) {
      if (format != nullptr && format != own)
        return invalid_input(folder, "the folder has both " + std::string(format->name) + " and " +
                                         std::string(own->name) + " files (" + files.back() + ", " + path +
                                         "); choose one kind with a pattern, or name the targets one by one");
      format = own;
      files.push_back(path);
    }
    entries.increment(code);
  }
  if (code) return Error{ErrorCode::kFailed, folder, code.message()};
  if (files.empty())
    return invalid_input(folder, "the folder has no targets beside the base; put targets there (" +
                                     extensions_of({Holds::kMesh, Holds::kTarget}, " or ") + "), or name other files");
  return files;
}

// Returns the name of a file for messages.
std::string place_of(const std::string& path) { return path == "-" ? "<stdin>" : path; }

// Returns the name of a file without its extensions: "blink" for "a/blink.target.gz".
std::string keyframe_name(const std::string& path) {
  const fs::path name = path_of(file_name_of(path)), stem = name.stem();
  const bool is_packed_target = is_make_human_target(path) && lower_extension(path) == ".gz";
  return utf8_of(is_packed_target ? stem.stem() : stem);
}

// Checks that options.max_expansion allows the memory of one more keyframe in addition to the keyframes and residuals
// that were read. Even a target file of a single line needs memory for all vertices, so a small file can ask for much
// memory.
Status ask_for_keyframe(const InputOptions& options, const std::string& path, const ReadMotion& read) {
  const std::uint64_t keyframes = read.motion.keyframes.size() + 1, vertices = read.motion.topology.vertex_count();
  const Expansion expansion(options.max_expansion, read.bytes_read);
  std::uint64_t bytes = keyframes * vertices * 3 * sizeof(float);
  for (const Motion::Keyframe& keyframe : read.motion.keyframes) bytes += keyframe.residuals.size() * sizeof(double);
  return expansion.check(bytes, place_of(path));
}

Result<Motion::Keyframe> read_deltas(const InputOptions& options, const std::string& path, ReadMotion& read) {
  const Motion& motion = read.motion;
  const Result<FileBytes> file = FileBytes::open(path, options.resolve);
  if (!file) return file.error();
  if (Status is_other = check_kind(file.value().bytes(), place_of(path), "target"); !is_other) return is_other.error();
  read.bytes_read += file.value().bytes().size();
  if (const Status status = ask_for_keyframe(options, path, read); !status) return status.error();
  const std::vector<float>& base_positions = motion.keyframes.front().positions;
  const auto base = VectorView<const float>::packed(base_positions.data(), motion.topology.vertex_count());
  const Result<MakeHumanTarget> target = read_make_human_target(file.value().bytes(), path, base);
  if (!target) return target.error();
  std::vector<double> high(base_positions.begin(), base_positions.end()), low(high.size(), 0);
  for (std::size_t i = 0; i < target.value().deltas.size(); ++i) {
    const std::size_t c = 3 * std::size_t{target.value().vertices[i / 3]} + i % 3;
    const Twofold sum = Twofold::sum(high[c], double{target.value().deltas[i]});
    high[c] = sum.high;
    low[c] = sum.low;
  }
  Motion::Keyframe keyframe;
  keyframe.set_positions(high, low);
  return keyframe;
}

Result<Motion::Keyframe> read_shape(const InputOptions& options, const std::string& path, ReadMotion& read) {
  Result<MeshFrame> mesh = read_mesh_file(options, path, place_of(path), read);
  if (!mesh) return mesh.error();
  const Status status = check_same_topology(read.motion.topology, "the base", mesh.value().topology, place_of(path));
  if (!status) return status.error();
  Motion::Keyframe keyframe;
  keyframe.positions = std::move(mesh.value().positions);
  keyframe.residuals = std::move(mesh.value().residuals);
  return keyframe;
}

}  // namespace

Result<ReadMotion> read_targets(const InputOptions& options) {
  const std::string& base = options.base;
  if (base == "-" && std::find(options.files.begin(), options.files.end(), "-") != options.files.end())
    return Error{ErrorCode::kUsage, "-", "the standard input (-) can only be read once; give - once"};
  Result<std::vector<std::string>> found =
      find_input_files(options, [&](const std::string& folder) { return list_targets(folder, base); });
  if (!found) return found.error();
  std::vector<std::string> files = std::move(found).value();
  std::erase_if(
      files, [&](const std::string& file) { return file == base || (!options.resolve && is_same_file(file, base)); });
  if (files.empty())
    return invalid_input(place_of(base), "there is no target beside the base; name the files of the targets");

  // Normals are read only from the base. Viewers compute the normals of targets from positions, so the stored normals
  // of targets would not be used.
  InputOptions of_base = options;
  if (of_base.shading != KeepShading::kNone) of_base.shading = KeepShading::kFirst;
  const std::size_t total = 1 + files.size();
  ReadMotion read;
  Motion& motion = read.motion;
  Result<MeshFrame> mesh = read_mesh_file(of_base, base, place_of(base), read);
  if (!mesh) return mesh.error();
  motion.keyframes.reserve(total);
  motion.topology = std::move(mesh.value().topology);
  motion.keyframes.push_back({std::move(mesh.value().positions), 0, keyframe_name(base)});
  if (options.progress) options.progress(1, total);
  for (std::size_t k = 1; k < total; ++k) {
    const std::string& path = files[k - 1];
    const Format* const format = target_format(path);
    Result<Motion::Keyframe> target = format != nullptr && format->holds == Holds::kTarget
                                          ? read_deltas(options, path, read)
                                          : read_shape(of_base, path, read);
    if (!target) return target.error();
    target.value().time = 1;
    target.value().name = keyframe_name(path);
    motion.keyframes.push_back(std::move(target).value());
    if (options.progress) options.progress(1 + k, total);
  }
  motion.connect_as_targets();
  if (Status status = validate(motion); !status) return status.error();
  return read;
}

}  // namespace chronormal::inline internal
