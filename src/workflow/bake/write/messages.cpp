#include "workflow/bake/write/messages.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string_view>
#include <utility>

#include "core/text.h"
#include "io/gltf/model/gltf_bake_mark.h"

namespace chronormal::inline internal {
namespace {

using Json = nlohmann::ordered_json;

// The room for morphed attributes in viewers that keep them in vertex attributes (WebGL 1, the least that the
// specification asks for).
constexpr std::size_t kMorphedAttributes = 8;
// A file that grows by this factor, or by a smaller one with more than a few correction targets, gets a warning.
constexpr double kLargeTimes = 2.5, kLargeTimesOfMany = 2;
constexpr std::size_t kFewExtras = 8;

// Rounds up to hundredths of a degree, so that an error beyond the tolerance is never printed as within it.
double rounded_up(double degrees) { return std::ceil(100 * degrees) / 100; }

std::string label_of(const GltfMesh& mesh, const BakedMesh& baked) {
  return mesh.name.empty() ? std::string("mesh ").append(std::to_string(baked.mesh)) : mesh.name;
}

}  // namespace

std::string name_of_extra(const GltfExtraTarget& extra) {
  if (extra.quadratic.empty() && extra.linear.empty()) return "chronormal of the animations";
  if (extra.linear.size() + extra.quadratic.size() > 2) return "chronormal of many";
  if (extra.quadratic.empty()) return "chronormal w" + std::to_string(extra.linear.front().i);
  const auto& [i, j, q] = extra.quadratic.front();
  std::string name("chronormal w");
  name.append(std::to_string(i)).append(i == j ? "*(1-w" : "*w").append(std::to_string(j));
  return name.append(i == j ? ")" : "");
}

std::string drivers_file(const GltfDocument& document, const std::vector<BakedMesh>& meshes) {
  Json of_meshes = Json::array();
  for (const BakedMesh& baked : meshes) {
    if (baked.extras.empty()) continue;
    const GltfMesh& mesh = document.meshes()[baked.mesh];
    const GltfBakeMark mark{baked.encoding, mesh.mark && mesh.mark->sequence, baked.extras};
    of_meshes.push_back({{"mesh", baked.mesh}, {"name", mesh.name}, {"chronormal", gltf::bake_mark_json(mark)}});
  }
  return Json({{"meshes", std::move(of_meshes)}}).dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
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
                          ? "1 primitive has no normals and stays flat, as viewers shade it by the specification "
                            "(--smooth gives it normals)"
                          : std::to_string(baked.left_flat) +
                                " primitives have no normals and stay flat, as viewers shade them by the specification "
                                "(--smooth gives them normals)"});
}

void warn_of_track(const GltfMesh& mesh, const BakedMesh& baked, double error, std::vector<MeshWarning>& warnings) {
  if (error < std::numbers::pi) return;
  warnings.push_back({label_of(mesh, baked),
                      "keys of a track are so near to each other, or weights so large, that float32 cannot hold the "
                      "products of weights between them: normals may be anything there"});
}

void warn_of_choice(const GltfMesh& mesh, const BakeOptions& options, const BakedMesh& baked,
                    std::vector<MeshWarning>& warnings) {
  const std::string tolerance = rounded_text(options.tolerance.value_or(kHarmlessTolerance));
  if (baked.left_tangents > 0) {
    warnings.push_back(
        {label_of(mesh, baked),
         (baked.left_tangents == 1 ? std::string("the tangents of 1 target lean")
                                   : "the tangents of " + std::to_string(baked.left_tangents) + " targets lean") +
             " on the right normals and stay as they are, because --max-bytes has no room for new ones"});
  }
  const auto chosen =
      std::find_if(baked.candidates.begin(), baked.candidates.end(), [](const auto& c) { return c.chosen; });
  if (chosen == baked.candidates.end()) return;
  if (chosen->within) {
    if (!is_beyond_by_rounding(*chosen, options)) return;
    std::string names;
    for (const Viewer& viewer : options.viewers)
      if (viewer.normals == NormalRule::kClamped)
        names.append(names.empty() ? "" : ", ")
            .append(viewer.title)
            .append(" (" + std::to_string(viewer.bits) + " bits)");
    warnings.push_back({label_of(mesh, baked), "its normals are within " + tolerance + " degrees, but up to " +
                                                   rounded_text(rounded_up(chosen->rounded)) +
                                                   " degrees off where compression rounds them: " + names});
    return;
  }
  if (baked.already_baked) {
    warnings.push_back({label_of(mesh, baked), "it was baked before, and its normals are up to " +
                                                   rounded_text(rounded_up(chosen->played.worst)) +
                                                   " degrees off along its animations, beyond the tolerance of " +
                                                   tolerance + ": bake the original file with this tolerance"});
    return;
  }
  // If nothing was asked for, the report states the remaining error.
  if (!options.tolerance && !options.most_targets && !options.most_delta_bytes) return;
  std::vector<std::string> remedies;
  if (options.most_targets || options.most_delta_bytes)
    remedies.emplace_back("allow more by --max-targets and --max-bytes");
  if (options.viewers.size() > 1 && std::any_of(options.viewers.begin(), options.viewers.end(),
                                                [](const Viewer& h) { return h.normals != NormalRule::kSum; }))
    remedies.emplace_back("name the viewers that count by --for");
  remedies.emplace_back("take a larger --tolerance");
  std::string text = "no candidate is within " + tolerance +
                     (chosen->skinned ? " degrees throughout, as its skin shows it" : " degrees throughout") +
                     ", and the nearest was taken (--plan lists them all): ";
  for (std::size_t n = 0; n < remedies.size(); ++n)
    text += (n == 0 ? "" : n + 1 < remedies.size() ? ", " : ", or ") + remedies[n];
  warnings.push_back({label_of(mesh, baked), std::move(text)});
}

void warn_of_baked(const GltfMesh& mesh, const GltfShading& shading, const MeshPlan& plan, const BakeOptions& options,
                   const BakedMesh& baked, std::vector<MeshWarning>& warnings) {
  const auto warn = [&](const std::string& sentence) { warnings.push_back({label_of(mesh, baked), sentence}); };
  const std::size_t targets = mesh.target_count + baked.extras.size();
  const bool is_harmless = plan.encoding == BakeEncoding::kHarmless || plan.encoding == BakeEncoding::kSmallest;
  if (!plan.is_driven && is_harmless && baked.extras.empty() && !baked.has_lone_weight) {
    warn(options.is_posed
             ? "no animation drives its targets, and no extra target that a program could drive brings its poses "
               "nearer: each is right at weight 1"
             : "no animation drives its targets, so that the file can hold the rest pose and each slider alone; where "
               "several are up, a program has to drive correction targets, which --poses writes (chronormal/three, "
               "/babylon and /playcanvas do)");
  }
  if (plan.is_driven && !plan.products_fit && is_harmless) {
    warn("weights of its animations are so large that float32 cannot hold their products: there are no extra targets");
  }
  if (baked.has_lone_weight && (is_harmless || plan.encoding == BakeEncoding::kSmallest)) {
    warn("KHR_animation_pointer drives a weight alone, so that nothing could drive extra targets: the mesh gets none");
  }
  if (plan.encoding == BakeEncoding::kExact || plan.encoding == BakeEncoding::kEndpoint) {
    std::string names;
    for (const std::vector<Viewer>* const viewers : {&options.viewers, &options.spared})
      for (const Viewer& viewer : *viewers)
        if (viewer.normals != NormalRule::kSum) names.append(names.empty() ? "" : ", ").append(viewer.title);
    if (!names.empty()) {
      warn("by --encode " + std::string(name_of(plan.encoding)) +
           " its normals are made for viewers that add up deltas as they are stored; they can be far off in " + names +
           ": leave --encode out for these");
    }
  }
  if (baked.undriven > 0) {
    warn(std::to_string(baked.undriven) + (baked.undriven == 1 ? " target is" : " targets are") +
         " driven by no animation and got the best single delta");
  }
  if (!baked.unmarked_nodes.empty()) {
    warn("extras of node " + std::to_string(baked.unmarked_nodes.front()) +
         (baked.unmarked_nodes.size() == 1
              ? " is"
              : " and of " + std::to_string(baked.unmarked_nodes.size() - 1) + " more are") +
         " no object: what drives the extra targets stands in the mesh alone");
  }
  if (baked.rescaled > 0) {
    warn(std::to_string(baked.rescaled) +
         " stored base normals are longer than 1e10 or shorter than 1e-10, which no viewer can add to: they were "
         "brought "
         "to length 1");
  }
  if (baked.stilled > 0) {
    warn(std::to_string(baked.stilled) + (baked.stilled == 1 ? " target turns" : " targets turn") +
         " normals and move no position: where the surface stays its normals stay, and these deltas are zero now");
  }
  if (baked.without_stored > 0) {
    warn(std::to_string(baked.without_stored) +
         " stored base normals are zero, or nearly, and stay wrong: add --recompute-base");
  }
  if (plan.encoding == BakeEncoding::kSmallest && options.bytes_of_file > 0) {
    const double times = 1 + static_cast<double>(baked.bytes) / static_cast<double>(options.bytes_of_file);
    if (times > kLargeTimes || (times > kLargeTimesOfMany && baked.extras.size() > kFewExtras)) {
      warn(std::to_string(baked.extras.size()) + " correction targets make the file " +
           rounded_text(rounded_up(times)) +
           " times as large: without --tolerance it stays smaller, and --plan lists the smaller ones");
    }
  }
  if (baked.without_base > 0) {
    warn(std::to_string(baked.without_base) +
         " vertices have no area around them in the base: their normals are right but for weights near 0");
  }
  // All viewers that can be named have more room, but others have only this.
  if (!baked.extras.empty() && 2 * targets > kMorphedAttributes && !options.spared.empty()) {
    warn(std::to_string(targets) + " targets of positions and normals are " + std::to_string(2 * targets) +
         " morphed attributes; viewers that have room for 8 leave out those of the smallest weights");
  }
  if (shading.split_by_crease > 0) {
    warn(std::to_string(shading.split_by_crease) +
         " vertices lie on edges sharper than the crease angle and got one normal all the same");
  }
}

}  // namespace chronormal::inline internal
