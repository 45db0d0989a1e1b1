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

// The number of morphed attributes that every viewer supports. The glTF specification requires at least this number,
// and viewers that keep morphed data in vertex attributes cannot support more such attributes in WebGL 1.
constexpr std::size_t kMorphedAttributes = 8;
// Factors by which a file may grow without a warning. kLargeTimesOfMany applies if there are more than kFewExtras
// correction targets.
constexpr double kLargeTimes = 2.5, kLargeTimesOfMany = 2;
constexpr std::size_t kFewExtras = 8;

// Rounds an angle up to hundredths of a degree, so that no warning prints an error beyond the tolerance as an error
// within the tolerance.
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
    if (meshes.empty()) continue;  // an earlier mesh has the same sentence, and its text names all of them
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
                          ? "1 primitive has no normals and stays flat; add --smooth to give it smooth normals"
                          : std::to_string(baked.left_flat) +
                                " primitives have no normals and stay flat; add --smooth to give them smooth normals"});
}

void warn_of_track(const GltfMesh& mesh, const BakedMesh& baked, double error, std::vector<MeshWarning>& warnings) {
  if (error < std::numbers::pi) return;
  warnings.push_back({label_of(mesh, baked),
                      "normals may be wrong between some keys of an animation, since these keys are too close or their "
                      "weights too large for float32; move such keys apart, or use smaller weights"});
}

void warn_of_choice(const GltfMesh& mesh, const BakeOptions& options, const BakedMesh& baked,
                    std::vector<MeshWarning>& warnings) {
  const std::string tolerance = rounded_text(options.tolerance.value_or(kHarmlessTolerance));
  const std::string within = with_degrees(tolerance);
  if (baked.left_tangents > 0) {
    warnings.push_back(
        {label_of(mesh, baked),
         "the tangents of " + counted(baked.left_tangents, "target", "targets") +
             " no longer fit the new normals, because --max-bytes leaves no room for new tangents; raise --max-bytes"});
  }
  if (options.most_targets && mesh.target_count > *options.most_targets) {
    warnings.push_back({label_of(mesh, baked), "the mesh has " + counted(mesh.target_count, "target", "targets") +
                                                   " of its own, more than " + std::to_string(*options.most_targets) +
                                                   ", and bake removes none of these; raise --max-targets"});
    return;
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
    warnings.push_back({label_of(mesh, baked), "the errors are within " + within + " before compression, but reach " +
                                                   with_degrees(rounded_text(rounded_up(chosen->rounded))) +
                                                   " after compression by " + names +
                                                   "; store normals with more bits when you compress the file"});
    return;
  }
  if (baked.already_baked) {
    warnings.push_back({label_of(mesh, baked), "this mesh was baked before, and errors reach " +
                                                   with_degrees(rounded_text(rounded_up(chosen->played.worst))) +
                                                   " in its animations, beyond the tolerance of " + within +
                                                   "; bake the ORIGINAL file with this tolerance"});
    return;
  }
  // Gives no warning if no limit was requested, because the report states the remaining error in any case.
  if (!options.tolerance && !options.most_targets && !options.most_delta_bytes) return;
  std::vector<std::string> remedies;
  if (options.most_targets || options.most_delta_bytes)
    remedies.emplace_back("allow more targets or bytes with --max-targets or --max-bytes");
  if (options.viewers.size() > 1 && std::any_of(options.viewers.begin(), options.viewers.end(),
                                                [](const Viewer& h) { return h.normals != NormalRule::kSum; }))
    remedies.emplace_back("name only the viewers that you need with --for");
  remedies.emplace_back("choose a larger --tolerance");
  std::string text =
      "bake could not bring all errors within " + within + (chosen->skinned ? " with the skin applied" : "") +
      (chosen->name == "as it is" ? ", so the mesh stays as it is; " : ", so the closest result was written; ");
  for (std::size_t n = 0; n < remedies.size(); ++n)
    text += (n == 0 ? "" : n + 1 < remedies.size() ? ", " : ", or ") + remedies[n];
  warnings.push_back({label_of(mesh, baked), std::move(text)});
}

void warn_of_baked(const GltfMesh& mesh, const GltfShading& shading, const MeshPlan& plan, const BakeOptions& options,
                   const BakedMesh& baked, std::vector<MeshWarning>& warnings) {
  const auto warn = [&](const std::string& sentence) { warnings.push_back({label_of(mesh, baked), sentence}); };
  const std::size_t targets = mesh.target_count + baked.extras.size();
  const bool is_harmless = plan.encoding == BakeEncoding::kHarmless || plan.encoding == BakeEncoding::kSmallest;
  if (!plan.is_driven && is_harmless && baked.extras.empty() && !baked.has_lone_weight && !baked.has_unread_track) {
    warn(options.is_posed ? "no animation drives the targets, and correction targets would not improve the given "
                            "poses; the normals of each target are right at weight 1"
                          : "no animation drives the targets, so the file is only right at rest and with one slider at "
                            "a time; if a program mixes several sliders, add --poses, and let the program drive the "
                            "correction targets (as chronormal/three, /babylon and /playcanvas do)");
  }
  if (plan.is_driven && options.is_posed)
    warn(
        "an animation drives the targets, so the mesh is baked for the animation and not for the given poses; use "
        "--encode exact for both, or bake a file without the animation");
  if (plan.is_driven && !plan.products_fit && is_harmless) {
    warn(
        "weights of the animations are so large that float32 cannot hold their products, so there are no correction "
        "targets; use smaller weights to get them");
  }
  if (baked.has_lone_weight && (is_harmless || plan.encoding == BakeEncoding::kSmallest)) {
    warn(
        "KHR_animation_pointer drives a single weight, so the animation cannot drive correction targets, and the mesh "
        "gets none; let it drive all weights to get them");
  }
  if (baked.has_unread_track && (is_harmless || plan.encoding == BakeEncoding::kSmallest)) {
    warn(
        "an animation drives the weights by numbers that cannot be read, so they cannot be extended to correction "
        "targets, and the mesh gets none; correct or remove this animation to get them");
  }
  if (plan.encoding == BakeEncoding::kExact || plan.encoding == BakeEncoding::kEndpoint) {
    std::string names;
    for (const std::vector<Viewer>* const viewers : {&options.viewers, &options.spared})
      for (const Viewer& viewer : *viewers)
        if (viewer.normals != NormalRule::kSum) names.append(names.empty() ? "" : ", ").append(viewer.title);
    if (!names.empty()) {
      warn("--encode " + std::string(name_of(plan.encoding)) + " can look wrong in " + names +
           "; leave --encode out for these viewers");
    }
  }
  if (baked.undriven > 0) {
    warn("no animation moves " + counted(baked.undriven, "target", "targets") +
         "; if a program sets their weights, the normals are only approximately right; let an animation of the file "
         "move them too");
  }
  if (!baked.unmarked_nodes.empty()) {
    const std::size_t more = baked.unmarked_nodes.size() - 1;
    warn("the extras of node " + std::to_string(baked.unmarked_nodes.front()) +
         (more == 0 ? "" : " and of " + counted(more, "more node", "more nodes")) +
         " are not a JSON object, so only the extras of the mesh say how to drive the correction targets; make them an "
         "object to have this in both");
  }
  if (baked.rescaled > 0) {
    warn(counted(baked.rescaled, "stored base normal is", "stored base normals are") +
         " longer than 1e10 or shorter than 1e-10, so that viewers could not add deltas; the length is now 1");
  }
  if (baked.stilled > 0) {
    warn(std::to_string(baked.stilled) + (baked.stilled == 1 ? " target turns" : " targets turn") +
         " normals without moving positions; bake has removed this turn, since the surface does not change");
  }
  if (baked.without_stored > 0) {
    warn(counted(baked.without_stored, "stored base normal is", "stored base normals are") +
         " (0, 0, 0) or nearly so, which bake does not change; add --recompute-base to replace all base normals");
  }
  if (plan.encoding == BakeEncoding::kSmallest && options.bytes_of_file > 0) {
    const double times = 1 + static_cast<double>(baked.bytes) / static_cast<double>(options.bytes_of_file);
    if (times > kLargeTimes || (times > kLargeTimesOfMany && baked.extras.size() > kFewExtras)) {
      warn(counted(baked.extras.size(), "correction target makes", "correction targets make") + " the file " +
           rounded_text(rounded_up(times)) +
           " times as large; for a smaller file, leave --tolerance out, or choose another candidate that --plan lists");
    }
  }
  if (baked.without_base > 0) {
    warn(counted(baked.without_base, "vertex has", "vertices have") +
         " only faces without area in the base, so normals there are wrong at weights near 0; give such faces an area "
         "to avoid this");
  }
  // Warns of viewers with few attributes. Each target morphs two attributes. The viewers that options can name support
  // more attributes, but other viewers may support only kMorphedAttributes.
  if (!baked.extras.empty() && 2 * targets > kMorphedAttributes && !options.spared.empty() && !options.most_targets) {
    warn(std::to_string(targets) +
         " morph targets are in the result, and viewers that show only 4 or 8 drop the weakest; to avoid this, add "
         "--max-targets with the number that your viewer shows");
  }
  if (shading.split_by_crease > 0) {
    warn(counted(shading.split_by_crease, "vertex lies", "vertices lie") +
         " on edges sharper than --crease, but can only have one normal; split these edges in the file to make them "
         "hard");
  }
}

}  // namespace chronormal::inline internal
