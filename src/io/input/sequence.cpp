// Sequences: mesh files in order, of one topology.
#include "io/input/sequence.h"

#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include "chronormal/motion/motion.h"
#include "io/input/formats.h"

namespace chronormal::inline internal {
namespace {

Result<std::vector<std::string>> list_folder(const std::string& folder) {
  std::error_code code;
  std::filesystem::directory_iterator entries(folder, code);
  std::vector<std::string> files;
  const Format* format = nullptr;
  while (!code && entries != std::filesystem::directory_iterator{}) {
    const std::filesystem::path path = entries->path();
    const std::string name = path.filename().string();
    const Format* const own = find_format(name);
    std::error_code ignored;  // a link to nowhere is no file
    if (own != nullptr && own->holds == Holds::kMesh && !name.starts_with('.') &&
        !std::filesystem::is_directory(path, ignored)) {
      if (format != nullptr && format != own)
        return invalid_input(folder, "the folder has both " + std::string(format->name) + " and " +
                                         std::string(own->name) + " files; use a pattern such as '" +
                                         (std::filesystem::path(folder) / "*").string() +
                                         std::string(format->extensions.front()) + "'");
      format = own;
      files.push_back(path.string());
    }
    entries.increment(code);
  }
  if (code) return Error{ErrorCode::kFailed, folder, code.message()};
  if (files.empty())
    return invalid_input(folder, "the folder has no mesh files (" + extensions_of({Holds::kMesh}, " or ") + ")");
  return files;
}

std::string frame_place(std::size_t k, const std::string& name) {
  return "frame " + std::to_string(k) + " (" + name + ")";
}

}  // namespace

Result<std::vector<std::string>> find_frames(const InputOptions& options) {
  return find_input_files(options, list_folder);
}

Result<ReadMotion> read_sequence(const std::vector<std::string>& files, const InputOptions& options) {
  const std::size_t total = files.size();
  if (total < 2)
    return invalid_input(total == 0 ? "" : files.front(),
                         "a sequence needs two frames or more, but " + std::to_string(total) +
                             (total == 1 ? " was" : " were") + " found; give several " +
                             extensions_of({Holds::kMesh}, " or ") + " files, a quoted pattern or a folder");
  ReadMotion read;
  Motion& motion = read.motion;
  motion.keyframes.reserve(total);
  for (std::size_t k = 0; k < total; ++k) {
    const std::string name = file_name_of(files[k]), place = frame_place(k, name);
    Result<MeshFrame> frame = read_mesh_file(options, files[k], place, read);
    if (!frame) return frame.error();
    if (k == 0) {
      motion.topology = std::move(frame.value().topology);
    } else if (Status status = check_same_topology(motion.topology, "frame 0", frame.value().topology, place);
               !status) {
      return status.error();
    }
    const double time = static_cast<double>(k) / options.frames_per_second;
    motion.keyframes.push_back({std::move(frame.value().positions), time, name});
    if (options.progress) options.progress(k + 1, total);
  }
  motion.connect_as_sequence();
  if (Status status = validate(motion); !status) return status.error();
  return read;
}

}  // namespace chronormal::inline internal
