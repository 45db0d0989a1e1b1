#include "chronormal/workflow/bake.h"

#include <algorithm>
#include <cassert>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "workflow/bake/bake_mesh.h"
#include "workflow/bake/bake_plan.h"
#include "workflow/bake/bake_terms.h"
#include "workflow/shading/target_weights.h"

namespace chronormal {
namespace {

// Hosts that keep morphed attributes in vertex attributes have room for so many (WebGL 1, the least that the
// specification asks for).
constexpr std::size_t kMorphedAttributes = 8;

std::string mesh_name(const GltfMesh& mesh, std::size_t index) {
  return mesh.name.empty() ? std::string("mesh ").append(std::to_string(index)) : mesh.name;
}

class Baker {
 public:
  Baker(const GltfDocument& document, const BakeOptions& options, GltfEdit& edit)
      : document_(document), options_(options), edit_(edit), zeros_(edit, options.dense_zeros) {}

  Result<GltfBake> run() {
    const std::vector<std::size_t> moving = moving_meshes();
    for (const std::size_t mesh : moving) total_ += document_.meshes()[mesh].target_count;
    bake_.meshes.reserve(moving.size());
    for (const std::size_t mesh : moving) {
      if (Status status = bake_mesh(mesh); !status) return status.error();
    }
    std::vector<BakedMesh*> reports;
    for (const std::size_t n : report_of_plan_) reports.push_back(&bake_.meshes[n]);
    if (Status status = write_tracks(document_, plans_, options_.tolerance, edit_, reports, bake_.converted_tracks);
        !status)
      return status.error();
    return finish();
  }

 private:
  // Those that might move: it takes their arrays to know.
  [[nodiscard]] std::vector<std::size_t> moving_meshes() const {
    std::vector<std::size_t> result;
    for (std::size_t m = 0; m < document_.meshes().size(); ++m) {
      const auto moves = [](const GltfPrimitive& primitive) {
        return primitive.has_faces() && std::any_of(primitive.targets.begin(), primitive.targets.end(),
                                                    [](const auto& target) { return target.positions; });
      };
      const auto& primitives = document_.meshes()[m].primitives;
      if (std::any_of(primitives.begin(), primitives.end(), moves)) result.push_back(m);
    }
    return result;
  }

  Status bake_mesh(std::size_t index) {
    const GltfMesh& mesh = document_.meshes()[index];
    BakedMesh report;
    report.mesh = index;
    report.name = mesh.name;
    if (mesh.mark_fault) return *mesh.mark_fault;
    if (mesh.mark) {
      report.already_baked = true;
      report.encoding = mesh.mark->encode == "exact" ? BakeEncoding::kExact : BakeEncoding::kEndpoint;
      bake_.meshes.push_back(std::move(report));
      return Success{};
    }
    Result<GltfShading> read = read_gltf_shading(document_, index, {options_.smooth, options_.crease_angle, false});
    if (!read) return read.error();
    if (options_.weighting == Weighting::kArea) read.value().groups.forget_corners();
    const GltfShading& shading = read.value();
    bool any_moves = false;
    for (std::size_t i = 0; i < mesh.target_count; ++i) any_moves = any_moves || moves(shading, i);
    if (!any_moves) return Success{};
    for (const GltfPrimitive& primitive : mesh.primitives) {
      if (primitive.has_faces() && !primitive.has_normals && !options_.smooth) ++report.left_flat;
    }
    if (report.left_flat > 0) {
      bake_.warnings.push_back(mesh_name(mesh, index) + ": " + std::to_string(report.left_flat) +
                               (report.left_flat == 1 ? " primitive has" : " primitives have") +
                               " no normals and stays flat, as hosts shade it by the specification "
                               "(--smooth gives it normals)");
    }
    const bool any_shaded = std::any_of(shading.element_of_vertex.begin(), shading.element_of_vertex.end(),
                                        [](std::uint32_t e) { return e != GltfShading::kNoElement; });
    if (any_shaded) {
      if (Status status = write(shading, report); !status) return status;
    }
    bake_.meshes.push_back(std::move(report));
    return Success{};
  }

  Status write(const GltfShading& shading, BakedMesh& report) {
    const std::size_t index = shading.mesh;
    const GltfMesh& mesh = document_.meshes()[index];
    const std::string extras = std::string("/meshes/").append(std::to_string(index)).append("/extras");
    if (edit_.has(extras) && !edit_.text(extras).starts_with("{")) {
      return invalid_input(std::string(document_.name()).append(", ").append(extras),
                           "it is no object, so that there is no place to say what was baked");
    }
    std::vector<WeightTrack> tracks;
    if (Status status = read_tracks(index, tracks); !status) return status;
    WeightUse use(mesh.target_count);
    for (const WeightTrack& track : tracks) use.add_track(track);
    bool is_driven = false;
    for (std::size_t i = 0; i < mesh.target_count; ++i) is_driven |= moves(shading, i) && use.together(i, i);
    add_poses(index, use);
    const NormalTerms terms(shading, options_.weighting);
    Result<MeshPlan> plan = plan_mesh(document_, shading, terms, use, is_driven, options_);
    if (!plan) return plan.error();
    const auto step = [this] {
      if (options_.progress) options_.progress(std::min(++done_, total_), total_);
    };
    const std::size_t bytes_before = edit_.added_bytes();
    if (Status status = write_mesh(document_, shading, terms, plan.value(), options_, step, zeros_, edit_, report);
        !status)
      return status;
    report.bytes = edit_.added_bytes() - bytes_before;
    warn(plan.value(), report);
    if (shading.split_by_crease > 0) {
      bake_.warnings.push_back(mesh_name(mesh, index) + ": " + std::to_string(shading.split_by_crease) +
                               " vertices lie on edges sharper than the crease angle and got one normal all the same");
    }
    plan.value().is_shown = std::vector<bool>();
    plan.value().largest = std::vector<double>();
    plan.value().lines = FittedLines();
    plans_.push_back(std::move(plan).value());
    report_of_plan_.push_back(bake_.meshes.size());
    return Success{};
  }

  // The tracks that drive a mesh through any node; those of the same keys once.
  Status read_tracks(std::size_t mesh, std::vector<WeightTrack>& tracks) const {
    for (std::size_t a = 0; a < document_.animations().size(); ++a) {
      std::set<std::size_t> seen;
      const std::vector<GltfTrack>& of_animation = document_.animations()[a].tracks;
      for (std::size_t t = 0; t < of_animation.size(); ++t) {
        if (document_.nodes()[of_animation[t].node].mesh != mesh) continue;
        if (!seen.insert(of_animation[t].same_keys_as).second) continue;
        Result<GltfKeys> keys = document_.keys(a, t);
        if (!keys) return keys.error();
        tracks.push_back(
            {of_animation[t].interpolation, std::move(keys).value(), document_.meshes()[mesh].target_count});
      }
    }
    return Success{};
  }

  void add_poses(std::size_t mesh, WeightUse& use) const {
    use.add_pose(document_.meshes()[mesh].weights);
    for (const GltfNode& node : document_.nodes()) {
      if (node.mesh == mesh && !node.weights.empty()) use.add_pose(node.weights);
    }
  }

  void warn(const MeshPlan& plan, const BakedMesh& report) {
    const GltfMesh& mesh = document_.meshes()[plan.mesh];
    const std::string name = mesh_name(mesh, plan.mesh) + ": ";
    if (!plan.is_driven && !options_.encoding) {
      bake_.warnings.push_back(name +
                               "no animation drives its targets, so that nothing could drive extra ones: each got the "
                               "best single delta (--encode exact writes them all the same)");
    }
    if (report.undriven > 0) {
      bake_.warnings.push_back(name + std::to_string(report.undriven) +
                               (report.undriven == 1 ? " target is" : " targets are") +
                               " driven by no animation and got the best single delta");
    }
    if (report.without_stored > 0) {
      bake_.warnings.push_back(name + std::to_string(report.without_stored) +
                               " stored base normals are zero, or nearly, and stay wrong: add --recompute-base");
    }
    constexpr std::size_t kMany = 64;
    if (plan.extras.size() > kMany) {
      bake_.warnings.push_back(name + std::to_string(plan.extras.size()) +
                               " extra targets, for so many are active at once: --encode endpoint needs none");
    }
    if (report.without_base > 0) {
      bake_.warnings.push_back(name + std::to_string(report.without_base) +
                               " vertices have no area around them in the base: their normals are right but for "
                               "weights near 0");
    }
    if (!plan.extras.empty() && (mesh.target_count + plan.extras.size()) * 2 > kMorphedAttributes) {
      const std::size_t targets = mesh.target_count + plan.extras.size();
      bake_.warnings.push_back(
          name + std::to_string(targets) + " targets of positions and normals are " + std::to_string(2 * targets) +
          " morphed attributes; hosts that have room for 8 leave out those of the smallest weights");
    }
    if (!plan.is_driven && !plan.extras.empty()) add_drivers(mesh, report);
  }

  void add_drivers(const GltfMesh& mesh, const BakedMesh& report) {
    nlohmann::ordered_json extras = nlohmann::ordered_json::array();
    for (const GltfExtraTarget& extra : report.extras) {
      const std::string formula = formula_of(extra);
      nlohmann::ordered_json entry = {{"target", extra.target}};
      if (!mesh.target_names.empty()) entry["targetName"] = "chronormal " + formula;
      entry["formula"] = formula;
      entry["factors"] = {extra.i, extra.j};
      extras.push_back(std::move(entry));
    }
    drivers_.push_back({{"mesh", report.mesh}, {"name", mesh.name}, {"extras", std::move(extras)}});
  }

  Result<GltfBake> finish() {
    Result<std::vector<std::string>> pointers = edit_.pointers();
    if (!pointers) return pointers.error();
    bake_.pointers = std::move(pointers).value();
    bake_.added_bytes = edit_.added_bytes();
    bake_.changed = !bake_.pointers.empty();
    for (const BakedMesh& mesh : bake_.meshes) bake_.added_targets += mesh.extras.size();
    if (options_.most_bytes && bake_.added_bytes > *options_.most_bytes) {
      return invalid_input(document_.name(), "the new arrays take " + std::to_string(bake_.added_bytes) +
                                                 " bytes, and at most " + std::to_string(*options_.most_bytes) +
                                                 " are allowed");
    }
    if (!drivers_.empty()) {
      bake_.drivers = nlohmann::ordered_json({{"version", 1}, {"meshes", std::move(drivers_)}})
                          .dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
      bake_.drivers += '\n';
    }
    return std::move(bake_);
  }

  const GltfDocument& document_;
  const BakeOptions& options_;
  GltfEdit& edit_;
  ZeroVectors zeros_;
  GltfBake bake_;
  std::vector<MeshPlan> plans_;
  std::vector<std::size_t> report_of_plan_;  // indices of bake_.meshes
  nlohmann::ordered_json drivers_ = nlohmann::ordered_json::array();
  std::size_t done_ = 0, total_ = 0;
};

}  // namespace

Result<GltfBake> bake(const GltfDocument& document, const BakeOptions& options, GltfEdit& edit) {
  assert(options.tolerance >= 0 && options.crease_angle >= 0 && options.crease_angle <= 180);
  return Baker(document, options, edit).run();
}

}  // namespace chronormal
