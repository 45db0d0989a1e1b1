// Finds the glTF files among inputs. The names of the files show which are glTF files and which are keyframes of a
// sequence. A folder that directly contains meshes is a sequence, whatever its subfolders contain.
#include <algorithm>
#include <filesystem>
#include <iterator>
#include <string>
#include <system_error>
#include <utility>

#include "chronormal/io/input.h"
#include "io/input/formats.h"
#include "io/input/input_files.h"
#include "io/system/names.h"

namespace chronormal {
namespace {

namespace fs = std::filesystem;

bool holds(const std::string& path, Holds kind) {
  const Format* const format = find_format(file_name_of(path));
  return format != nullptr && format->holds == kind;
}

// Returns the glTF files in a folder and its subfolders. Returns no files if the folder directly contains meshes, or if
// the folder cannot be listed; the caller that opens the folder then reports the error.
Result<std::vector<std::string>> list_folder(const std::string& folder) {
  std::error_code code;
  fs::recursive_directory_iterator entries(path_of(folder), fs::directory_options::skip_permission_denied, code);
  std::vector<std::string> files;
  std::string own_mesh, own_gltf;
  while (!code && entries != fs::recursive_directory_iterator{}) {
    const std::string path = utf8_of(entries->path());
    std::error_code ignored;  // a broken link does not count as a file
    if (file_name_of(path).starts_with('.')) {
      entries.disable_recursion_pending();
    } else if (!fs::is_directory(entries->path(), ignored)) {
      const bool is_own = entries.depth() == 0;
      if (is_own && holds(path, Holds::kMesh)) own_mesh = path;
      if (is_own && holds(path, Holds::kGltf)) own_gltf = path;
      if (holds(path, Holds::kGltf)) files.push_back(path);
    }
    entries.increment(code);
  }
  if (!own_mesh.empty() && !own_gltf.empty())
    return Error{ErrorCode::kUsage, folder,
                 "the folder has both glTF files and keyframes of a sequence, such as " + file_name_of(own_gltf) +
                     " and " + file_name_of(own_mesh) + "; choose one kind with a pattern such as '" +
                     utf8_of(path_of(folder) / "*.glb") + "'"};
  if (!own_mesh.empty()) files.clear();
  return files;
}

}  // namespace

Result<std::vector<std::string>> find_gltf_files(const std::vector<std::string>& inputs) {
  std::vector<std::string> files;
  std::string other;
  for (const std::string& input : inputs) {
    std::error_code code;
    const fs::file_status status = fs::status(path_of(input), code);
    const bool is_folder = fs::is_directory(status);
    const bool is_pattern = !fs::exists(status) && input.find_first_of("*?[") != std::string::npos;
    std::vector<std::string> found;
    if (input != "-" && !is_folder && !is_pattern) {
      found = {input};
    } else if (is_pattern) {
      InputOptions pattern;
      pattern.files = {input};
      // A pattern without matches is not an error here, because the code that opens the input reports it.
      Result<std::vector<std::string>> matches = find_input_files(pattern, list_folder);
      found = matches ? std::move(matches).value() : pattern.files;
    } else if (is_folder) {
      Result<std::vector<std::string>> listed = list_folder(input);
      if (!listed) return listed.error();
      found = std::move(listed).value();
      std::sort(found.begin(), found.end(), stands_before);
    }
    const auto first_other =
        std::find_if(found.begin(), found.end(), [](const std::string& path) { return !holds(path, Holds::kGltf); });
    if (other.empty() && found.empty()) other = input;
    if (other.empty() && first_other != found.end()) other = *first_other;
    std::copy_if(found.begin(), found.end(), std::back_inserter(files),
                 [](const std::string& path) { return holds(path, Holds::kGltf); });
  }
  if (!files.empty() && !other.empty())
    return Error{ErrorCode::kUsage, other,
                 "this file cannot be given together with the glTF file " + files.front() +
                     "; give either glTF files alone, or the keyframes of one sequence"};
  return files;
}

}  // namespace chronormal
