#include "cli/inputs.h"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include "chronormal/io/file.h"
#include "chronormal/io/gltf_document.h"
#include "chronormal/io/motion_files.h"
#include "chronormal/io/sequence.h"
#include "io/cache/motion_readers.h"
#include "io/mesh/mesh_readers.h"
#include "io/mesh/obj.h"

namespace chronormal::cli {
namespace {

// The OBJ files whose normals belong to the motion: one for each keyframe, or the mesh of a cache or of targets.
Result<std::vector<std::string>> files_with_normals(const InputOptions& input) {
  const auto is_obj = [](const std::string& file) {
    const MeshReader* reader = file == "-" ? nullptr : find_mesh_reader(file);
    return reader != nullptr && reader->name == "obj";
  };
  std::vector<std::string> files;
  if (!input.base.empty()) {
    if (is_obj(input.base)) files.push_back(input.base);
    return files;
  }
  if (input.files.empty() || (input.files.size() == 1 && find_motion_reader(input.files[0]) != nullptr)) return files;
  const auto is_cache = [](const std::string& file) {
    const std::string path = file.substr(0, file.rfind('#'));
    return find_cache_reader(path) != nullptr || path.ends_with(".xml") || path.ends_with(".XML");
  };
  if (input.files.size() == 2 && is_cache(input.files[0]) != is_cache(input.files[1])) {
    const std::string& mesh = input.files[is_cache(input.files[0]) ? 1 : 0];
    if (is_obj(mesh)) files.push_back(mesh);
    return files;
  }
  Result<std::vector<std::string>> frames = find_frames(input.files);
  if (!frames) return frames;
  for (const std::string& frame : frames.value())
    if (!is_obj(frame)) return files;
  return frames;
}

}  // namespace

bool is_gltf(const std::string& path, std::string_view bytes) {
  const bool is_other = find_motion_reader(path) != nullptr || find_mesh_reader(path) != nullptr;
  return is_gltf_file(path) || (!is_other && GltfDocument::recognises(bytes));
}

bool is_one_file(const InputOptions& input) {
  if (input.files.size() != 1 || !input.base.empty()) return false;
  std::error_code code;
  return input.files[0] == "-" || is_gltf_file(input.files[0]) ||
         std::filesystem::is_regular_file(input.files[0], code);
}

Result<StoredNormals> read_stored_normals(const InputOptions& input, const Topology& topology) {
  const Result<std::vector<std::string>> files = files_with_normals(input);
  if (!files) return files.error();
  StoredNormals normals;
  for (const std::string& path : files.value()) {
    const Result<FileBytes> file = FileBytes::open(path);
    if (!file) return file.error();
    Result<ObjShading> shading = read_obj_shading(file.value().bytes(), short_name(path));
    if (!shading) return shading.error();
    if (shading.value().topology != topology)
      return invalid_input(path, "the faces are not those of the motion: the file has changed meanwhile");
    if (shading.value().normal_of_corner.empty()) {
      normals.of_keyframes.resize(std::min<std::size_t>(1, normals.of_keyframes.size()));
      break;
    }
    normals.of_keyframes.push_back(std::move(shading.value().normal_of_corner));
  }
  return normals;
}

}  // namespace chronormal::cli
