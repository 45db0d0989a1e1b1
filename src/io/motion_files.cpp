#include "chronormal/io/motion_files.h"

#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include "chronormal/io/file.h"
#include "chronormal/io/maya_cache.h"
#include "chronormal/io/mdd.h"
#include "chronormal/io/motion_readers.h"
#include "chronormal/io/npz.h"
#include "chronormal/io/pc2.h"
#include "chronormal/io/readers.h"
#include "io/extension.h"

namespace chronormal {
namespace {

using Progress = std::function<void(std::size_t done, std::size_t total)>;

std::string name_of(const std::string& path) {
  return path == "-" ? "<stdin>" : std::filesystem::path(path).filename().string();
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
  return input.reader->read(file.value().bytes(), name_of(input.path), options);
}

Result<Motion> read_cache_over_mesh(const CacheInput& input, const std::string& mesh_input,
                                    const SequenceOptions& options, const Progress& progress) {
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
    Result<MeshFrame> mesh = read_mesh(file.value().bytes(), name_of(mesh_path));
    if (!mesh) return mesh.error();
    faces = std::move(mesh.value().topology);
  }
  if (progress) progress(1, 2);
  Result<PositionCache> cache = read_cache(input, {options.frames_per_second, faces.vertex_count(), input.channel});
  if (!cache) return cache.error();
  if (progress) progress(2, 2);
  return motion_from_cache(std::move(faces), std::move(cache).value(), name_of(mesh_path), name_of(input.path));
}

// The reader of a whole motion that one input has: by its extension, or else by its content.
Result<const MotionReader*> choose_motion_reader(const std::string& input, std::string_view bytes) {
  if (const MotionReader* const reader = find_motion_reader(input)) return reader;
  for (const MotionReader& reader : motion_readers()) {
    if (reader.recognises(bytes)) return &reader;
  }
  return invalid_input(name_of(input),
                       "neither the name nor the content tells a format that holds a whole motion "
                       "(.npz, .md2); a sequence of .obj or .ply files needs two or more");
}

// Whether one input is a file, not a folder or pattern, that can be a whole motion.
bool may_be_whole(const std::string& input) {
  if (input == "-" || find_motion_reader(input) != nullptr) return true;
  std::error_code code;
  return find_mesh_reader(input) == nullptr && std::filesystem::is_regular_file(input, code);
}

}  // namespace

Result<Motion> read_motion(std::span<const std::string> inputs, const SequenceOptions& options,
                           const Progress& progress) {
  if (!(options.frames_per_second >= 1e-9 && options.frames_per_second <= 1e9))
    return Error{ErrorCode::kUsage, "", "the frame rate (--fps) must be a number from 1e-9 to 1e9"};

  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const std::optional<CacheInput> cache = as_cache(inputs[i]);
    if (!cache) continue;
    if (inputs.size() != 2 || as_cache(inputs[1 - i]))
      return Error{ErrorCode::kUsage, inputs[i], "a cache has no faces: give it together with one mesh (.obj or .ply)"};
    return read_cache_over_mesh(*cache, inputs[1 - i], options, progress);
  }
  for (const std::string& input : inputs) {
    if (inputs.size() > 1 && find_motion_reader(input) != nullptr)
      return Error{ErrorCode::kUsage, input, "the file is a whole motion: give it alone"};
  }
  if (inputs.size() != 1 || !may_be_whole(inputs[0])) return read_sequence(inputs, options, progress);

  const Result<FileBytes> file = FileBytes::open(inputs[0]);
  if (!file) return file.error();
  const Result<const MotionReader*> reader = choose_motion_reader(inputs[0], file.value().bytes());
  if (!reader) return reader.error();
  Result<Motion> motion = reader.value()->read(file.value().bytes(), name_of(inputs[0]), options.frames_per_second);
  if (motion && progress) progress(1, 1);
  return motion;
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
