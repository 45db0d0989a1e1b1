#include "chronormal/io/motion_files.h"

#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include "chronormal/io/file.h"
#include "chronormal/io/gltf_motion.h"
#include "io/bytes/extension.h"
#include "io/cache/maya_cache.h"
#include "io/cache/mdd.h"
#include "io/cache/motion_readers.h"
#include "io/cache/npz.h"
#include "io/cache/pc2.h"
#include "io/input/input_files.h"
#include "io/mesh/mesh_readers.h"

namespace chronormal {
namespace {

using Progress = std::function<void(std::size_t done, std::size_t total)>;

Error not_animated(const std::string& input) {
  return Error{ErrorCode::kUsage, input, "--animation chooses among those of a glTF file, which this is not"};
}

// An input that is a point cache: its file, and the channel after "#".
struct CacheInput {
  std::string path;
  std::string channel;
  const CacheReader* reader = nullptr;  // nullptr: the description of a Maya cache
};

std::optional<CacheInput> as_cache(const std::string& input) {
  const auto classify = [](std::string path, std::string channel) -> std::optional<CacheInput> {
    if (const CacheReader* const reader = find_cache_reader(path))
      return CacheInput{std::move(path), std::move(channel), reader};
    if (lower_extension(path) == ".xml") return CacheInput{std::move(path), std::move(channel), nullptr};
    return std::nullopt;
  };
  if (std::optional<CacheInput> whole = classify(input, "")) return whole;
  const std::size_t hash = input.rfind('#');
  if (hash == std::string::npos) return std::nullopt;
  return classify(input.substr(0, hash), input.substr(hash + 1));
}

Result<PositionCache> read_cache(const CacheInput& input, const CacheOptions& options) {
  if (input.reader == nullptr) return read_maya_cache(input.path, options);
  const Result<FileBytes> file = FileBytes::open(input.path);
  if (!file) return file.error();
  return input.reader->read(file.value().bytes(), file_name_of(input.path), options);
}

Result<Motion> read_cache_over_mesh(const CacheInput& input, const std::string& mesh_input,
                                    const MotionOptions& options, const Progress& progress) {
  const Result<std::vector<std::string>> meshes = find_frames({&mesh_input, 1});
  if (!meshes) return meshes.error();
  if (meshes.value().size() != 1)
    return Error{ErrorCode::kUsage, mesh_input,
                 "a cache goes over one mesh, but this stands for " + std::to_string(meshes.value().size()) + " files"};
  const std::string& mesh_path = meshes.value().front();
  Topology faces;
  {
    const Result<FileBytes> file = FileBytes::open(mesh_path);
    if (!file) return file.error();
    Result<MeshFrame> mesh = read_mesh(file.value().bytes(), file_name_of(mesh_path));
    if (!mesh) return mesh.error();
    faces = std::move(mesh.value().topology);
  }
  if (progress) progress(1, 2);
  Result<PositionCache> cache = read_cache(input, {options.frames_per_second, faces.vertex_count(), input.channel});
  if (!cache) return cache.error();
  if (progress) progress(2, 2);
  return motion_from_cache(std::move(faces), std::move(cache).value(), file_name_of(mesh_path),
                           file_name_of(input.path));
}

// Whether one input is a file, not a folder or pattern, that can be a whole motion.
bool may_be_whole(const std::string& input) {
  if (input == "-" || is_gltf_file(input) || find_motion_reader(input) != nullptr) return true;
  std::error_code code;
  return find_mesh_reader(input) == nullptr && std::filesystem::is_regular_file(input, code);
}

Result<Motion> motion_of(const GltfDocument& document, const MotionOptions& options, bool allow_mesh) {
  GltfMotionOptions gltf_options;
  gltf_options.animation = options.animation;
  gltf_options.world = options.world;
  Result<GltfMotion> read = allow_mesh && options.animation.empty() && !has_moving_targets(document)
                                ? read_gltf_mesh(document, gltf_options)
                                : read_gltf_motion(document, gltf_options);
  if (!read) return read.error();
  return std::move(read.value().motion);
}

Result<Motion> mesh_as_motion(std::string_view bytes, const std::string& input) {
  Result<MeshFrame> mesh = read_mesh(bytes, file_name_of(input));
  if (!mesh) return mesh.error();
  MeshFrame frame = std::move(mesh).value();
  return Motion{std::move(frame.topology), {{std::move(frame.positions), 0, file_name_of(input)}}, {}};
}

// Reads the bytes of one input that is a whole motion: by its extension, or else by its content.
Result<Motion> read_whole(std::string_view bytes, const std::string& input, const MotionOptions& options,
                          bool allow_mesh) {
  const std::string name = file_name_of(input);
  const MotionReader* reader = is_gltf_file(input) ? nullptr : find_motion_reader(input);
  for (const MotionReader& candidate : motion_readers()) {
    if (reader == nullptr && !is_gltf_file(input) && candidate.recognises(bytes)) reader = &candidate;
  }
  const bool is_gltf = is_gltf_file(input) || (reader == nullptr && GltfDocument::recognises(bytes));
  if (!options.animation.empty() && !is_gltf) return not_animated(input);
  if (reader != nullptr) return reader->read(bytes, name, options.frames_per_second);
  if (is_gltf) {
    std::optional<std::string> folder;
    if (input != "-") folder = std::filesystem::path(input).parent_path().string();
    const Result<GltfDocument> document = GltfDocument::read(bytes, name, folder, {options.allow_external});
    if (!document) return document.error();
    return motion_of(document.value(), options, allow_mesh);
  }
  if (allow_mesh) return mesh_as_motion(bytes, input);
  return invalid_input(name,
                       "neither the name nor the content tells a format that holds a whole motion "
                       "(.gltf, .glb, .npz, .md2); a sequence of .obj or .ply files needs two or more");
}

Status check_frame_rate(const MotionOptions& options) {
  if (options.frames_per_second >= 1e-9 && options.frames_per_second <= 1e9) return Success{};
  return Error{ErrorCode::kUsage, "", "the frame rate (--fps) must be a number from 1e-9 to 1e9"};
}

Result<Motion> read_inputs(std::span<const std::string> inputs, const MotionOptions& options, bool allow_mesh,
                           const Progress& progress) {
  if (Status status = check_frame_rate(options); !status) return status.error();
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const std::optional<CacheInput> cache = as_cache(inputs[i]);
    if (!cache) continue;
    if (inputs.size() != 2 || as_cache(inputs[1 - i]))
      return Error{ErrorCode::kUsage, inputs[i], "a cache has no faces: give it together with one mesh (.obj or .ply)"};
    if (!options.animation.empty()) return not_animated(inputs[i]);
    return read_cache_over_mesh(*cache, inputs[1 - i], options, progress);
  }
  for (const std::string& input : inputs) {
    if (inputs.size() > 1 && (is_gltf_file(input) || find_motion_reader(input) != nullptr))
      return Error{ErrorCode::kUsage, input, "the file is a whole motion: give it alone"};
  }
  if (inputs.size() == 1 && may_be_whole(inputs[0])) {
    const Result<FileBytes> file = FileBytes::open(inputs[0]);
    if (!file) return file.error();
    Result<Motion> motion = read_whole(file.value().bytes(), inputs[0], options, allow_mesh);
    if (motion && progress) progress(1, 1);
    return motion;
  }
  if (!options.animation.empty()) return not_animated(inputs.empty() ? "" : inputs[0]);
  if (allow_mesh) {
    const Result<std::vector<std::string>> frames = find_frames(inputs);
    if (!frames) return frames.error();
    if (frames.value().size() == 1) {
      const Result<FileBytes> file = FileBytes::open(frames.value().front());
      if (!file) return file.error();
      return mesh_as_motion(file.value().bytes(), frames.value().front());
    }
  }
  return read_sequence(inputs, {options.frames_per_second}, progress);
}

}  // namespace

bool is_gltf_file(const std::string& input) {
  const std::string extension = lower_extension(input);
  return extension == ".gltf" || extension == ".glb";
}

Result<Motion> read_motion(std::span<const std::string> inputs, const MotionOptions& options,
                           const Progress& progress) {
  return read_inputs(inputs, options, false, progress);
}

Result<Motion> read_motion_or_mesh(std::string_view bytes, const std::string& input, const MotionOptions& options) {
  if (Status status = check_frame_rate(options); !status) return status.error();
  return read_whole(bytes, input, options, true);
}

Result<Motion> read_motion_or_mesh(std::span<const std::string> inputs, const MotionOptions& options,
                                   const Progress& progress) {
  return read_inputs(inputs, options, true, progress);
}

Status write_motion(const Motion& motion, const std::string& path, bool force) {
  const std::string extension = lower_extension(path);
  if (extension != ".npz" && extension != ".pc2" && extension != ".mdd") return write_sequence(motion, path, force);
  if (Status status = check_output(path, force); !status) return status;
  Result<std::string> bytes = extension == ".npz"   ? write_npz(motion)
                              : extension == ".pc2" ? write_pc2(motion)
                                                    : write_mdd(motion);
  if (!bytes) return Error{bytes.error().code, path, bytes.error().message};
  return write_output(path, bytes.value(), force);
}

}  // namespace chronormal
