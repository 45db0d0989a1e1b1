// Sequences: mesh files in order, of one topology.
#include "io/input/sequence.h"

#include <algorithm>
#include <filesystem>
#include <span>
#include <string_view>
#include <system_error>
#include <utility>

#include "chronormal/motion/motion.h"
#include "io/input/formats.h"
#include "motion/outline.h"

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

std::string frame_name(std::size_t k) { return "frame " + std::to_string(k); }

std::string frame_place(std::size_t k, const std::string& name) { return frame_name(k) + " (" + name + ")"; }

}  // namespace

Result<std::vector<std::string>> find_frames(const InputOptions& options) {
  return find_input_files(options, list_folder);
}

namespace {

// Which of the files are keyframes.
Result<std::vector<std::size_t>> choose_files(const std::vector<std::string>& files, const InputOptions& options) {
  const std::size_t total = files.size();
  if (total < 2)
    return invalid_input(total == 0 ? "" : files.front(),
                         "a sequence needs two frames or more, but " + std::to_string(total) +
                             (total == 1 ? " was" : " were") + " found; give several " +
                             extensions_of({Holds::kMesh}, " or ") + " files, a quoted pattern or a folder");
  return choose_frames(total, options);
}

}  // namespace

Result<ReadMotion> read_sequence(const std::vector<std::string>& files, const InputOptions& options) {
  const Result<std::vector<std::size_t>> frames = choose_files(files, options);
  if (!frames) return frames.error();
  ReadMotion read;
  Motion& motion = read.motion;
  motion.keyframes.reserve(frames.value().size());
  for (const std::size_t k : frames.value()) {
    const std::string name = file_name_of(files[k]), place = frame_place(k, name);
    Result<MeshFrame> frame = read_mesh_file(options, files[k], place, read);
    if (!frame) return frame.error();
    if (motion.keyframes.empty()) {
      motion.topology = std::move(frame.value().topology);
    } else if (Status status = check_same_topology(motion.topology, frame_name(frames.value().front()),
                                                   frame.value().topology, place);
               !status) {
      return status.error();
    }
    const double time = static_cast<double>(k) / options.frames_per_second;
    motion.keyframes.push_back({std::move(frame.value().positions), time, name});
    if (options.progress) options.progress(motion.keyframes.size(), frames.value().size());
  }
  motion.connect_as_sequence();
  if (Status status = validate(motion); !status) return status.error();
  return read;
}

Result<ReadMotion> stream_sequence(const std::vector<std::string>& files, const InputOptions& options) {
  Result<std::vector<std::size_t>> chosen = choose_files(files, options);
  if (!chosen) return chosen.error();
  const std::vector<std::size_t>& frames = chosen.value();
  ReadMotion read;
  Motion outline;
  for (const std::size_t k : frames)
    outline.keyframes.push_back({{}, static_cast<double>(k) / options.frames_per_second, file_name_of(files[k])});
  outline.connect_as_sequence();
  const std::string place = frame_place(frames[0], outline.keyframes[0].name);
  Result<MeshFrame> first = read_mesh_file(options, files[frames[0]], place, read);
  if (!first) return first.error();
  if (options.shading == KeepShading::kAll && !read.normals.of_keyframes.empty()) return read_sequence(files, options);
  outline.topology = std::move(first.value().topology);
  outline.keyframes[0].positions = std::move(first.value().positions);
  if (Status status = validate_positions(outline, 0, outline.keyframes[0].positions); !status) return status.error();
  if (Status status = validate_outline(outline); !status) return status.error();
  for (std::size_t i = 1; i < frames.size(); ++i) {
    std::error_code ignored;  // who reads it will say what is wrong
    const std::uintmax_t size = std::filesystem::file_size(files[frames[i]], ignored);
    if (!ignored) read.bytes_read += size;
  }
  const auto read_frame = [files, frames, options](const Motion& motion, std::size_t keyframe,
                                                   std::span<float> positions) -> Status {
    const std::size_t k = frames[keyframe];
    const std::string own_place = frame_place(k, motion.keyframes[keyframe].name);
    ReadMotion beside;  // shading is that of the first one
    InputOptions plain = options;
    plain.shading = KeepShading::kNone;
    const Result<MeshFrame> frame = read_mesh_file(plain, files[k], own_place, beside);
    if (!frame) return frame.error();
    Status status = check_same_topology(motion.topology, frame_name(frames[0]), frame.value().topology, own_place);
    if (status) status = validate_positions(motion, keyframe, frame.value().positions);
    if (status) std::copy(frame.value().positions.begin(), frame.value().positions.end(), positions.begin());
    return status;
  };
  read.stream.emplace(std::move(outline), read_frame);
  return read;
}

}  // namespace chronormal::inline internal
