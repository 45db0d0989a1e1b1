// Finds the names of the morph targets of an input, and looks targets up by name.
#include "chronormal/io/input.h"

#include <algorithm>

#include "core/charconv.h"
#include "core/nearest.h"

namespace chronormal {
namespace {

// Adds to names[k] the names that the meshes of a glTF document give to target k, each name once. Meshes without faces
// are skipped, because they take no part in the motion.
void add_names_of_meshes(const Input& input, TargetNames& names) {
  for (const GltfPart& part : input.parts()) {
    const std::vector<std::string>& of_mesh = input.document()->meshes()[part.mesh].target_names;
    for (std::size_t k = 0; k < std::min(names.size(), of_mesh.size()); ++k) {
      std::vector<std::string>& own = names[k];
      if (!of_mesh[k].empty() && std::find(own.begin(), own.end(), of_mesh[k]) == own.end()) own.push_back(of_mesh[k]);
    }
  }
}

std::string list_of(const TargetNames& names) {
  constexpr std::size_t kMostNamed = 20;
  std::string text;
  for (std::size_t k = 0; k < std::min(names.size(), kMostNamed); ++k)
    text += (k == 0 ? "" : ", ") + target_label(names, k);
  return names.size() > kMostNamed ? text + ", ..." : text;
}

}  // namespace

Result<TargetNames> target_names(Input& input) {
  const Result<MotionStream*> read = input.stream();
  if (!read) return read.error();
  const Motion& motion = read.value()->motion();
  if (motion.kind != MotionKind::kTargets) return TargetNames();
  TargetNames names(motion.segments.size());
  if (input.document() != nullptr) {
    add_names_of_meshes(input, names);
    return names;
  }
  for (std::size_t k = 0; k < names.size(); ++k) {
    const std::string& name = motion.keyframes[motion.segments[k].to].name;
    if (!name.empty()) names[k].push_back(name);
  }
  return names;
}

Result<std::size_t> find_target(const TargetNames& names, const std::string& name_or_number) {
  std::vector<std::size_t> found;
  for (std::size_t k = 0; k < names.size(); ++k)
    if (std::find(names[k].begin(), names[k].end(), name_or_number) != names[k].end()) found.push_back(k);
  if (found.size() == 1) return found.front();
  if (found.size() > 1) {
    std::string numbers = std::to_string(found.front());
    for (std::size_t i = 1; i < found.size(); ++i)
      numbers += (i + 1 == found.size() ? " and " : ", ") + std::to_string(found[i]);
    return Error{
        ErrorCode::kUsage, "",
        "targets " + numbers + " all have the name '" + name_or_number + "'; give the number of the target instead"};
  }
  std::size_t number = 0;
  const char* const end = name_or_number.data() + name_or_number.size();
  const auto [stop, code] = from_chars(name_or_number.data(), end, number);
  if (code == std::errc() && stop == end && number < names.size()) return number;

  std::vector<std::string> all;
  for (const std::vector<std::string>& own : names) all.insert(all.end(), own.begin(), own.end());
  const std::string nearest = nearest_name(name_or_number, all);
  return Error{ErrorCode::kUsage, "",
               "there is no target '" + name_or_number + "'" +
                   (nearest.empty() ? "; the targets are " : "; did you mean " + nearest + "? The targets are ") +
                   list_of(names)};
}

std::string target_label(const TargetNames& names, std::size_t target) {
  const std::string number = std::to_string(target);
  return names[target].empty() ? number : number + " (" + names[target].front() + ")";
}

}  // namespace chronormal
