#include "io/input/targets.h"

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "chronormal/io/file.h"
#include "chronormal/motion/motion.h"
#include "io/bytes/extension.h"
#include "io/input/input_files.h"
#include "io/mesh/make_human_target.h"
#include "io/mesh/mesh_readers.h"

namespace chronormal {
namespace {

namespace fs = std::filesystem;

// What kind of target a file is by its name; empty for none.
std::string_view format_of(const std::string& file_name) {
  if (is_make_human_target(file_name)) return "target";
  const MeshReader* const reader = find_mesh_reader(file_name);
  return reader == nullptr ? std::string_view() : reader->name;
}

bool is_same_file(const std::string& a, const std::string& b) {
  std::error_code ignored;  // what is not there is reported when it is opened
  return a == b || fs::equivalent(a, b, ignored);
}

// All targets in a folder and in the folders in it, without the base.
Result<std::vector<std::string>> list_targets(const std::string& folder, const std::string& base) {
  std::error_code code;
  fs::recursive_directory_iterator entries(folder, code);
  std::vector<std::string> files;
  std::string_view format;
  while (!code && entries != fs::recursive_directory_iterator{}) {
    const std::string path = entries->path().string(), name = entries->path().filename().string();
    const std::string_view own_format = format_of(name);
    std::error_code ignored;  // a link to nowhere is no file
    if (name.starts_with('.')) {
      entries.disable_recursion_pending();
    } else if (!own_format.empty() && !fs::is_directory(path, ignored) && !is_same_file(path, base)) {
      if (!format.empty() && format != own_format)
        return invalid_input(folder, "the folder has both " + std::string(format) + " and " + std::string(own_format) +
                                         " files (" + files.back() + ", " + path +
                                         "); name the targets by patterns or one by one");
      format = own_format;
      files.push_back(path);
    }
    entries.increment(code);
  }
  if (code) return Error{ErrorCode::kFailed, folder, code.message()};
  if (files.empty())
    return invalid_input(folder, "the folder has no targets (.target, .target.gz, .obj or .ply) besides the base");
  return files;
}

// What messages call a file.
std::string place_of(const std::string& path) { return path == "-" ? "<stdin>" : path; }

// "a/blink.target.gz" -> "blink"
std::string keyframe_name(const std::string& path) {
  const fs::path name = file_name_of(path), stem = name.stem();
  const bool is_packed_target = is_make_human_target(path) && lower_extension(path) == ".gz";
  return (is_packed_target ? stem.stem() : stem).string();
}

Result<std::vector<float>> read_deltas(const std::string& path, const Motion& motion) {
  const Result<FileBytes> file = FileBytes::open(path);
  if (!file) return file.error();
  std::vector<float> positions = motion.keyframes.front().positions;
  const auto base = VectorView<const float>::packed(positions.data(), motion.topology.vertex_count());
  const Result<MakeHumanTarget> target = read_make_human_target(file.value().bytes(), path, base);
  if (!target) return target.error();
  for (std::size_t i = 0; i < target.value().vertices.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      positions[3 * std::size_t{target.value().vertices[i]} + axis] += target.value().deltas[3 * i + axis];
  }
  return positions;
}

Result<std::vector<float>> read_shape(const std::string& path, const Motion& motion) {
  Result<MeshFrame> mesh = read_mesh_file(path, place_of(path));
  if (!mesh) return mesh.error();
  const Status status = check_same_topology(motion.topology, "the base", mesh.value().topology, place_of(path));
  if (!status) return status.error();
  return std::move(mesh).value().positions;
}

}  // namespace

Result<Motion> read_targets(const std::string& base, std::span<const std::string> inputs,
                            const std::function<void(std::size_t done, std::size_t total)>& progress) {
  if (base == "-" && std::find(inputs.begin(), inputs.end(), "-") != inputs.end())
    return Error{ErrorCode::kUsage, "-", "the standard input can be given only once"};
  Result<std::vector<std::string>> found =
      find_input_files(inputs, [&](const std::string& folder) { return list_targets(folder, base); });
  if (!found) return found.error();
  std::vector<std::string> files = std::move(found).value();
  files.erase(std::remove_if(files.begin(), files.end(), [&](const auto& file) { return is_same_file(file, base); }),
              files.end());
  if (files.empty()) return invalid_input(place_of(base), "there is no target besides the base itself");

  const std::size_t total = 1 + files.size();
  Result<MeshFrame> mesh = read_mesh_file(base, place_of(base));
  if (!mesh) return mesh.error();
  Motion motion;
  motion.keyframes.reserve(total);
  motion.topology = std::move(mesh.value().topology);
  motion.keyframes.push_back({std::move(mesh.value().positions), 0, keyframe_name(base)});
  if (progress) progress(1, total);
  for (std::size_t k = 1; k < total; ++k) {
    const std::string& path = files[k - 1];
    Result<std::vector<float>> positions =
        is_make_human_target(path) ? read_deltas(path, motion) : read_shape(path, motion);
    if (!positions) return positions.error();
    motion.keyframes.push_back({std::move(positions).value(), 1, keyframe_name(path)});
    motion.segments.push_back({0, k});
    if (progress) progress(1 + k, total);
  }
  if (Status status = validate(motion); !status) return status.error();
  return motion;
}

}  // namespace chronormal
