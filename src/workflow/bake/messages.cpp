#include "workflow/bake/messages.h"

#include <map>
#include <string_view>
#include <utility>

namespace chronormal::inline internal {
namespace {

using Json = nlohmann::ordered_json;

// Hosts that keep morphed attributes in vertex attributes have room for so many (WebGL 1, the least that the
// specification asks for).
constexpr std::size_t kMorphedAttributes = 8;
// More extra targets than these make a file large.
constexpr std::size_t kManyExtras = 64;

std::string label_of(const GltfMesh& mesh, const BakedMesh& baked) {
  return mesh.name.empty() ? std::string("mesh ").append(std::to_string(baked.mesh)) : mesh.name;
}

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

std::vector<std::string> said_once(const std::vector<MeshWarning>& warnings) {
  constexpr std::size_t kMostNamed = 4;
  struct Meshes {
    std::string names;
    std::size_t count = 0;
  };
  std::map<std::string_view, Meshes> meshes_of;
  for (const MeshWarning& warning : warnings) {
    Meshes& meshes = meshes_of[warning.sentence];
    if (++meshes.count <= kMostNamed) meshes.names.append(meshes.count == 1 ? "" : ", ").append(warning.mesh);
  }
  std::vector<std::string> texts;
  for (const MeshWarning& warning : warnings) {
    const auto meshes = meshes_of.extract(warning.sentence);
    if (meshes.empty()) continue;  // said already
    const auto& [names, count] = meshes.mapped();
    const std::string more = count > kMostNamed ? " and " + std::to_string(count - kMostNamed) + " more" : "";
    texts.push_back(names + more + ": " + warning.sentence);
  }
  return texts;
}

void warn_of_flat(const GltfMesh& mesh, const BakedMesh& baked, std::vector<MeshWarning>& warnings) {
  if (baked.left_flat == 0) return;
  warnings.push_back({label_of(mesh, baked),
                      baked.left_flat == 1
                          ? "1 primitive has no normals and stays flat, as hosts shade it by the specification "
                            "(--smooth gives it normals)"
                          : std::to_string(baked.left_flat) +
                                " primitives have no normals and stay flat, as hosts shade them by the specification "
                                "(--smooth gives them normals)"});
}

void warn_of_baked(const GltfMesh& mesh, const GltfShading& shading, const MeshPlan& plan, const BakeOptions& options,
                   const BakedMesh& baked, std::vector<MeshWarning>& warnings) {
  const auto warn = [&](const std::string& sentence) { warnings.push_back({label_of(mesh, baked), sentence}); };
  const std::size_t targets = mesh.target_count + baked.extras.size();
  if (!plan.is_driven && !options.encoding) {
    warn(
        "no animation drives its targets, so that nothing could drive extra ones: each got the best single delta "
        "(--encode exact writes them all the same)");
  }
  if (baked.undriven > 0) {
    warn(std::to_string(baked.undriven) + (baked.undriven == 1 ? " target is" : " targets are") +
         " driven by no animation and got the best single delta");
  }
  if (baked.without_stored > 0) {
    warn(std::to_string(baked.without_stored) +
         " stored base normals are zero, or nearly, and stay wrong: add --recompute-base");
  }
  if (baked.extras.size() > kManyExtras) {
    warn(std::to_string(baked.extras.size()) +
         " extra targets, for so many are active at once: --encode endpoint needs none");
  }
  if (baked.without_base > 0) {
    warn(std::to_string(baked.without_base) +
         " vertices have no area around them in the base: their normals are right but for weights near 0");
  }
  if (!baked.extras.empty() && 2 * targets > kMorphedAttributes) {
    warn(std::to_string(targets) + " targets of positions and normals are " + std::to_string(2 * targets) +
         " morphed attributes; hosts that have room for 8 leave out those of the smallest weights");
  }
  if (shading.split_by_crease > 0) {
    warn(std::to_string(shading.split_by_crease) +
         " vertices lie on edges sharper than the crease angle and got one normal all the same");
  }
}

}  // namespace chronormal::inline internal
