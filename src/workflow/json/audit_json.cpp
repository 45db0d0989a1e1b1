// Writes the result of an audit as JSON.
#include "workflow/json/audit_json.h"

#include "chronormal/normals/weighting.h"
#include "workflow/json/json.h"

namespace chronormal::inline internal {
namespace {

constexpr const char* kKinds[] = {
    "unlit",          "missing_normals", "wrong_at_keys",   "wrong_between",  "wrong_together", "wrong_pose",
    "stale_tangents", "stale_keys",      "unknown_rule",    "flat_primitive", "skin",           "unread_skin",
    "baked",          "emptied",         "baked_keyframes", "beyond_viewer"};

Json place_json(const AuditPlace& place, const char* moment) {
  Json json;
  if (place.mesh) json = {{"mesh", *place.mesh}, {"primitive", or_null(place.primitive)}};
  json["vertex"] = place.vertex;
  if (moment != nullptr) {
    json["segment"] = place.segment;
    json[moment] = place.at;
  }
  return json;
}

const char* moment_of(const AuditSubject& subject) { return audit_moment_name(subject.kind); }

// Adds the average number of torn edges in a sample, and the largest number in one sample, for tears beyond 10, 20 and
// 40 degrees.
void add_torn(const MotionError& error, Json& json) {
  if (error.samples == 0) return;
  Json average = Json::array();
  for (const std::size_t torn : error.torn)
    average.push_back(static_cast<double>(torn) / static_cast<double>(error.samples));
  json["torn_edges"] = std::move(average);
  json["most_torn_edges"] = error.most_torn;
}

void add_error(const MotionError& error, Json& json) {
  json["worst_degrees"] = error.worst;
  json["mean_degrees"] = error.mean();
  json["rms_degrees"] = error.rms();
  json["percentile_99_degrees"] = error.percentile(0.99);
  json["percentile_99_9_degrees"] = error.percentile(0.999);
  json["judged"] = error.judged;
  json["no_normal"] = error.no_normal;
  json["faint"] = error.faint;
  json["faint_worst_degrees"] = error.faint_worst;
  json["cancelled"] = error.cancelled;
  json["unlit"] = error.unlit;
  add_torn(error, json);
}

Json histogram_json(const MotionError& error) {
  Json bins = Json::array();
  for (std::size_t bin = 0; bin < kAuditBins; ++bin)
    bins.push_back({{"from_degrees", bin == 0 ? 0 : kAuditBinEdges[bin - 1]},
                    {"to_degrees", bin == kAuditBinEdges.size() ? 180 : kAuditBinEdges[bin]},
                    {"pairs", error.histogram[bin]}});
  return bins;
}

Json subject_json(const AuditSubject& subject) {
  Json json = {{"kind", audit_subject_name(subject.kind)},
               {"name", subject.name},
               {"mesh", or_null(subject.mesh)},
               {"target", or_null(subject.target)},
               {"animation", or_null(subject.animation)},
               {"node", or_null(subject.node)},
               {"expression", or_null(subject.expression)},
               {"weighting", weighting_name(subject.weighting)},
               {"segments", subject.segments},
               {"samples", subject.samples},
               {"vertices", subject.vertices}};
  add_error(subject.error, json);
  json["worst_at_keys_degrees"] = subject.at_keys.worst;
  json["skinning_worst_degrees"] = subject.skinning ? Json(subject.skinning->worst) : Json();
  json["skinning_mean_degrees"] = subject.skinning ? Json(subject.skinning->mean()) : Json();
  json["worst_at"] = subject.error.worst > 0 ? place_json(subject.error.worst_at, moment_of(subject)) : Json();
  json["faint_at"] = subject.error.faint_worst > 0 ? place_json(subject.error.faint_at, moment_of(subject)) : Json();
  json["unlit_at"] = subject.error.unlit > 0 ? place_json(subject.error.unlit_at, moment_of(subject)) : Json();
  json["histogram"] = histogram_json(subject.error);
  return json;
}

Json offset_json(const AuthoredOffset& offset) {
  return {{"mesh", or_null(offset.mesh)},
          {"vertices", offset.vertices},
          {"weighting", weighting_name(offset.weighting)},
          {"weighting_detected", offset.is_detected},
          {"polygons", offset.of_polygons},
          {"worst_degrees", offset.worst},
          {"mean_degrees", offset.mean()},
          {"worst_at", offset.worst > 0 ? place_json(offset.worst_at, nullptr) : Json()},
          {"area_mean_degrees", offset.area_mean},
          {"closest_weighting", weighting_name(offset.closest)},
          {"closest_mean_degrees", offset.closest_mean},
          {"closest_worst_degrees", offset.closest_worst}};
}

Json finding_json(const AuditFinding& finding) {
  return {{"kind", kKinds[static_cast<std::size_t>(finding.kind)]},
          {"fault", finding.is_fault()},
          {"mesh", or_null(finding.mesh)},
          {"target", or_null(finding.target)},
          {"animation", or_null(finding.animation)},
          {"node", or_null(finding.node)},
          {"expression", or_null(finding.expression)},
          {"count", finding.count},
          {"viewer", finding.viewer ? Json(finding.viewer->name) : Json()},
          {"reason", finding.reason ? Json(finding.reason->text()) : Json()},
          {"worst_degrees", finding.is_fault() || finding.kind == AuditFinding::Kind::kSkinned ||
                                    finding.kind == AuditFinding::Kind::kUnknownRule
                                ? Json(finding.degrees)
                                : Json()},
          {"worst_at", finding.worst_at
                           ? place_json(*finding.worst_at, finding.target || finding.expression ? "weight" : "time")
                           : Json()}};
}

Json viewer_json(const Audit& audit, const AuditLimits& limits, const ViewerAudit& found) {
  constexpr const char* kNormals[] = {"sum", "unit", "clamped"};
  constexpr const char* kTracks[] = {"specified", "splines_resampled", "all_resampled", "splines_without_duration",
                                     "splines_misread"};
  constexpr const char* kSkins[] = {"blended", "inverse_transpose", "by_joint"};
  Json json = {{"name", found.viewer.name},
               {"title", found.viewer.title},
               {"normals", kNormals[static_cast<std::size_t>(found.viewer.normals)]},
               {"tracks", kTracks[static_cast<std::size_t>(found.viewer.tracks)]},
               {"skins", kSkins[static_cast<std::size_t>(found.viewer.skins)]},
               {"most_targets", found.viewer.most_targets > 0 ? Json(found.viewer.most_targets) : Json()},
               {"source", found.viewer.source},
               {"passed", limits.any() ? Json(limits.allow(found)) : Json()}};
  add_error(found.error, json);
  json["worst_subject"] = or_null(found.worst);
  json["worst_at"] = found.worst ? place_json(found.error.worst_at, moment_of(audit.subjects[*found.worst])) : Json();
  json["displaced_share"] = found.displaced;
  json["targets_beyond"] = found.beyond;
  return json;
}

// Returns the JSON of an audit of one input, without the list of its subjects.
Json without_subjects(const std::string& input, const Audit& audit, const AuditLimits& limits) {
  Json json;
  json["input"] = {{"name", input}};
  json["rule"] = audit_rule_name(audit.rule);
  put_path(json, audit.cut);
  json["weighting"] = audit.weighting ? Json(weighting_name(*audit.weighting)) : Json();
  json["stored_normals"] = audit.stored;
  json["tolerance_degrees"] = or_null(limits.degrees);
  json["tolerance_torn_edges"] = or_null(limits.torn_edges);
  json["passed"] = limits.any() ? Json(limits.allow(audit)) : Json();
  add_error(audit.error, json);
  json["worst_subject"] = or_null(audit.worst);
  json["worst_at"] = audit.worst ? place_json(audit.error.worst_at, moment_of(audit.subjects[*audit.worst])) : Json();
  json["histogram"] = histogram_json(audit.error);
  json["still"] = audit.still;
  json["subjects"] = Json::array();
  json["viewers"] = Json::array();
  for (const ViewerAudit& found : audit.viewers) json["viewers"].push_back(viewer_json(audit, limits, found));
  json["authored_offsets"] = Json::array();
  for (const AuthoredOffset& offset : audit.offsets) json["authored_offsets"].push_back(offset_json(offset));
  json["findings"] = Json::array();
  for (const AuditFinding& finding : audit.findings) json["findings"].push_back(finding_json(finding));
  json["notes"] = audit.notes;
  return json;
}

// Returns the JSON text of an audit of one input. Converts subjects one by one, so that the JSON objects of all
// subjects are never in memory together.
std::string audit_text_of(const std::string& input, const Audit& audit, const AuditLimits& limits, bool is_indented) {
  Json json = json_of_command("audit", kAuditSchema);
  json.update(without_subjects(input, audit, limits));
  // Sets `passed` to false if nothing could be judged. audit_object() does not do this, because it is for lists of
  // inputs.
  if (limits.any() && !audit.is_judged()) json["passed"] = false;
  return with_items(
      is_indented ? json_text(json) : json.dump(-1, ' ', false, Json::error_handler_t::replace), "subjects",
      audit.subjects.size(), [&](std::size_t i) { return subject_json(audit.subjects[i]); }, is_indented);
}

}  // namespace

Json audit_object(const std::string& input, const Audit& audit, const AuditLimits& limits) {
  Json json = without_subjects(input, audit, limits);
  for (const AuditSubject& subject : audit.subjects) json["subjects"].push_back(subject_json(subject));
  return json;
}

std::string audit_line(const std::string& input, const Audit& audit, const AuditLimits& limits) {
  return audit_text_of(input, audit, limits, false);
}

std::string audit_json(const std::string& input, const Audit& audit, const AuditLimits& limits) {
  return audit_text_of(input, audit, limits, true);
}

}  // namespace chronormal::inline internal
