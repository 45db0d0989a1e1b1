#include "workflow/bake/drivers.h"

#include <utility>

namespace chronormal {
namespace {

using Json = nlohmann::ordered_json;

// The weight of an extra target: "w0*w1".
std::string formula_of(const GltfExtraTarget& extra) {
  return std::string("w").append(std::to_string(extra.i)).append("*w").append(std::to_string(extra.j));
}

}  // namespace

std::string name_of_extra(const GltfExtraTarget& extra) { return "chronormal " + formula_of(extra); }

Json drivers_of(const GltfMesh& mesh, const BakedMesh& baked) {
  Json extras = Json::array();
  for (const GltfExtraTarget& extra : baked.extras) {
    Json entry = {{"target", extra.target}};
    if (!mesh.target_names.empty()) entry["targetName"] = name_of_extra(extra);
    entry["formula"] = formula_of(extra);
    entry["factors"] = {extra.i, extra.j};
    extras.push_back(std::move(entry));
  }
  return {{"mesh", baked.mesh}, {"name", mesh.name}, {"extras", std::move(extras)}};
}

std::string drivers_file(const std::vector<Json>& of_meshes) {
  if (of_meshes.empty()) return "";
  return Json({{"version", 1}, {"meshes", of_meshes}}).dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace chronormal
