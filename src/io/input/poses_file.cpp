#include "chronormal/io/input.h"

#include <utility>

#include "io/bytes/file.h"
#include "io/bytes/known_kinds.h"
#include "io/json/json.h"

namespace chronormal {

Result<std::vector<RigPose>> parse_poses(std::string_view text, const std::string& name) {
  const Result<nlohmann::json> parsed = parse_json(text, name, 0, {"", [](std::size_t, const nlohmann::json&) {}});
  if (!parsed) return parsed.error();
  const nlohmann::json& root = parsed.value();
  if (!root.is_array() || root.empty())
    return invalid_input(name, "the file must be a list of at least one pose, such as [{\"smile\": 1}]");
  JsonComplaint complaint(name);
  std::vector<RigPose> poses;
  const JsonView list(root, "", complaint);
  for (std::size_t n = 0; n < root.size(); ++n) {
    const JsonView item = list.item(n);
    RigPose& pose = poses.emplace_back();
    pose.place = item.place();
    if (root[n].is_array()) {
      for (std::size_t i = 0; i < item.size(); ++i) pose.in_order.push_back(item.item(i).as_number());
    } else if (root[n].is_object()) {
      for (const auto& [target, weight] : root[n].items()) {
        const JsonView of_target(weight, item.pointer(target), complaint);
        pose.named.push_back({target, of_target.as_number(), of_target.place()});
      }
    } else {
      item.complain(
          "a pose must be an object with the weights of targets by name, such as {\"smile\": 1}, or a list of weights");
    }
    if (complaint.first()) return *complaint.first();
  }
  return poses;
}

Result<std::vector<RigPose>> read_poses_file(const std::string& path) {
  const Result<FileBytes> file = FileBytes::open(path);
  if (!file) return file.error();
  if (Status is_other = check_kind(file.value().bytes(), path, "json"); !is_other) return is_other.error();
  return parse_poses(file.value().bytes(), path);
}

}  // namespace chronormal
