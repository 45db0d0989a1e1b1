// Writes the result of a bake as JSON.
#include <algorithm>
#include <array>

#include "chronormal/normals/weighting.h"
#include "workflow/json/json.h"
#include "workflow/json/object.h"

namespace chronormal::inline internal {
namespace {

// The version of the JSON of bakes. Version 3 renamed `hosts` to `viewers` and `choices` to `candidates`, and added
// kinds of poses and torn edges.
constexpr int kSchema = 3;

Json common_json(const BakeReport& report) {
  Json json = json_of_command("bake", kSchema);
  json["input"] = {{"name", report.input}};
  json["output"] = report.output;
  json["notes"] = report.notes;
  return json;
}

Json audit_json(const MotionError& before, const MotionError& after) {
  return {{"worst_degrees_before", before.worst},
          {"worst_degrees_after", after.worst},
          {"mean_degrees_before", before.mean()},
          {"mean_degrees_after", after.mean()},
          {"unlit_before", before.unlit},
          {"unlit_after", after.unlit},
          {"torn_edges_before", before.torn_edges()},
          {"torn_edges_after", after.torn_edges()},
          {"worse", is_worse(after, before)}};
}

// The names of the kinds of poses in JSON: the animations and static poses of the file, each target alone, and poses
// that a program may set.
constexpr std::array<const char*, 3> kPoses = {"file", "alone", "posed"};

Json shown_json(const ShownErrors& errors) {
  Json torn = Json::array();  // the average number of torn edges in a pose, beyond 10, 20 and 40 degrees
  for (const std::size_t tears : errors.tears)
    torn.push_back(errors.poses > 0 ? static_cast<double>(tears) / static_cast<double>(errors.poses) : 0);
  return {{"mean_degrees", errors.mean},
          {"most_degrees", errors.most},
          {"worst_degrees", errors.worst},
          {"torn_edges", std::move(torn)}};
}

Json viewers_json(const std::vector<ViewerChange>& changes) {
  Json viewers = Json::array();
  for (const ViewerChange& change : changes) {
    Json viewer = {{"viewer", change.viewer}, {"named", change.is_named}, {"better", change.is_better}};
    for (std::size_t k = 0; k < kPoses.size(); ++k) {
      const auto& [before, after] = change.poses[k];
      if (before.judged == 0) continue;
      viewer[kPoses[k]] = {{"judged", before.judged}, {"before", shown_json(before)}, {"after", shown_json(after)}};
    }
    viewers.push_back(std::move(viewer));
  }
  return viewers;
}

Json candidates_json(const BakedMesh& mesh) {
  Json candidates = Json::array();
  for (const BakedCandidate& choice : mesh.candidates) {
    candidates.push_back({{"name", choice.name},
                          {"targets", choice.targets},
                          {"bytes", choice.bytes},
                          {"played", shown_json(choice.played)},
                          {"viewers", viewers_json(choice.viewers)},
                          {"within", choice.within},
                          {"chosen", choice.chosen},
                          {"animations_only", choice.animations_only},
                          {"rounded_degrees", choice.rounded}});
  }
  return candidates;
}

Json mesh_json(const BakedMesh& mesh, const BakeReport& report) {
  Json extras = Json::array();
  for (const GltfExtraTarget& extra : mesh.extras) {
    Json linear = Json::array(), quadratic = Json::array();
    for (const auto& term : extra.linear) linear.push_back(Json::array({term.i, term.a}));
    for (const auto& term : extra.quadratic) quadratic.push_back(Json::array({term.i, term.j, term.q}));
    extras.push_back({{"target", extra.target}, {"linear", std::move(linear)}, {"quadratic", std::move(quadratic)}});
  }
  return {{"mesh", mesh.mesh},
          {"name", mesh.name},
          {"encoding", name_of(mesh.encoding)},
          {"weighting", mesh.already_baked ? Json() : Json(weighting_name(mesh.weighting))},
          {"already_baked", mesh.already_baked},
          {"different_normals", mesh.elements},
          {"extra_targets", std::move(extras)},
          {"bytes", mesh.bytes},
          {"undriven_targets", mesh.undriven},
          {"flat_primitives", mesh.left_flat},
          {"vertices_without_base", mesh.without_base},
          {"vertices_without_stored_normal", mesh.without_stored},
          {"rescaled_normals", mesh.rescaled},
          {"new_tangents", mesh.new_tangents},
          {"stilled_targets", mesh.stilled},
          {"fitted_normals", mesh.fitted_elements},
          {"left_out_targets", mesh.left_out},
          {"viewers", viewers_json(mesh.viewers)},
          {"candidates", candidates_json(mesh)},
          {"target_fit_degrees", mesh.largest_error},
          {"track_fit_degrees", mesh.resampling_error},
          {"audit", report.audit ? audit_json(error_of_mesh(report.audit->before, mesh.mesh),
                                              error_of_mesh(report.audit->after, mesh.mesh))
                                 : Json()}};
}

void add_audit(const BakeReport& report, Json& json) {
  if (!report.audit) return;
  json["audit"] = audit_json(report.audit->before.error, report.audit->after.error);
  const std::vector<ViewerAudit>&before = report.audit->before.viewers, &after = report.audit->after.viewers;
  json["audit"]["viewers"] = Json::array();
  for (std::size_t h = 0; h < std::min(before.size(), after.size()); ++h) {
    Json viewer = {{"viewer", before[h].viewer.name}};
    viewer.update(audit_json(before[h].error, after[h].error));
    json["audit"]["viewers"].push_back(std::move(viewer));
  }
}

}  // namespace

std::string bake_json(const GltfBake& bake, const BakeReport& report) {
  Json json = common_json(report);
  json["changed"] = bake.changed;
  Json meshes = Json::array();
  for (const BakedMesh& mesh : bake.meshes) meshes.push_back(mesh_json(mesh, report));
  json["meshes"] = std::move(meshes);
  json["added_targets"] = bake.added_targets;
  json["added_bytes"] = bake.added_bytes;
  json["left_out_bytes"] = bake.left_out_bytes;
  json["converted_tracks"] = bake.converted_tracks;
  json["pointers"] = bake.pointers;
  json["warnings"] = bake.warnings;
  json["drivers"] = or_null(report.drivers_file);
  add_audit(report, json);
  return json_text(json);
}

std::string plan_json(const GltfBake& bake, const BakeReport& report) {
  Json json = json_of_command("bake", kSchema);
  json["input"] = {{"name", report.input}};
  json["notes"] = report.notes;
  json["plan"] = true;
  Json meshes = Json::array();
  for (const BakedMesh& mesh : bake.meshes)
    meshes.push_back({{"mesh", mesh.mesh}, {"name", mesh.name}, {"candidates", candidates_json(mesh)}});
  json["meshes"] = std::move(meshes);
  json["warnings"] = bake.warnings;
  return json_text(json);
}

std::string bake_json(const SequenceBake& bake, BakeEncoding encoding, const BakeReport& report) {
  Json json = common_json(report);
  json["encoding"] = name_of(encoding);
  put_path(json, bake.cut);
  json["keyframes"] = bake.keyframes;
  json["vertices"] = bake.vertices;
  json["targets"] = bake.targets;
  json["extra_targets"] = bake.extra_targets;
  json["bytes"] = bake.bytes;
  json["bound_degrees"] = bake.largest_error;
  json["without_normals"] = bake.without_normals;
  if (bake.keys)
    json["keys"] = {{"count", bake.keys->count},
                    {"in_between", bake.keys->in_between},
                    {"keyframes_left_out", bake.keys->left_out},
                    {"even", bake.keys->even},
                    {"beyond", bake.keys->beyond}};
  json["warnings"] = bake.warnings;
  add_audit(report, json);
  return json_text(json);
}

}  // namespace chronormal::inline internal
