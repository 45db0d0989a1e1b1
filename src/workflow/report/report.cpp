#include "chronormal/workflow/report.h"

#include <algorithm>
#include <string>
#include <utility>

#include "chronormal/workflow/json.h"
#include "workflow/audit/watched_audit.h"
#include "workflow/json/object.h"
#include "workflow/report/container.h"
#include "workflow/report/report_model.h"
#include "workflow/report/report_parts.h"
#include "workflow/report/watched_motions.h"
#include "workflow/report/worst_places.h"

namespace chronormal {
namespace {

std::function<void(std::size_t, std::size_t)> told(const ReportOptions& options, std::string_view what) {
  if (!options.progress) return {};
  return [&options, what](std::size_t done, std::size_t total) { options.progress(what, done, total); };
}

// The last part of a path.
std::string without_folders(const std::string& name) {
  const std::size_t slash = name.find_last_of("/\\");
  return slash == std::string::npos ? name : name.substr(slash + 1);
}

AuditOptions audit_options(const ReportOptions& options) {
  AuditOptions how;
  how.samples = options.samples;
  how.animation = options.animation;
  how.weighting = options.weighting;
  how.progress = told(options, "auditing");
  return how;
}

Status read_gltf(const GltfDocument& document, const ReportOptions& options, Report& report, ReportModel& model) {
  AuditOptions how = audit_options(options);
  how.hosts = {kHosts.begin(), kHosts.end()};
  WatchedMotions watched(how.hosts, options.hosts);
  Result<Audit> found = watched_audit(document, how, [&](const AuditSample& sample) { watched.add(sample); });
  if (!found) return found.error();
  report.audit = std::move(found).value();
  model.kind = "gltf";
  for (auto& [mesh, motions] : watched.take()) {
    Result<ModelPart> part = gltf_part(document, *mesh, options.hosts, std::move(motions));
    if (!part) return part.error();
    model.parts.push_back(std::move(part).value());
  }
  return Success{};
}

void plan(const GltfDocument& document, const ReportOptions& options, Report& report) {
  if (!options.plan) return;
  BakeOptions how;
  how.plan = true;
  how.weighting = options.weighting;
  how.progress = told(options, "planning");
  GltfEdit edit(document);
  Result<GltfBake> planned = bake(document, how, edit);
  if (planned)
    report.plan = std::move(planned).value();
  else
    report.plan_message = planned.error().text();
}

Json head_of(const Report& report) {
  const auto object = [](const std::string& text) { return Json::parse(text); };
  Json head = {{"schema", 1}, {"program", object(audit_json("", Audit(), std::nullopt))["chronormal"]}};
  head["program"] = "chronormal " + head["program"].get<std::string>();
  head["input"] = report.input;
  head["audit"] = object(audit_json(report.input, report.audit, std::nullopt));
  head["plan"] = Json();
  if (report.plan) head["plan"] = object(plan_json(*report.plan, {report.input, "", std::nullopt, std::nullopt}));
  head["plan_message"] = report.plan_message.empty() ? Json() : Json(report.plan_message);
  head["compare"] = Json();
  return head;
}

}  // namespace

Result<Report> report(Input& input, const ReportOptions& options) {
  Report result;
  ReportModel model;
  result.input = without_folders(input.name());
  if (const GltfDocument* const document = input.document(); document != nullptr) {
    if (const Status status = read_gltf(*document, options, result, model); !status) return status.error();
    if (!model.parts.empty()) plan(*document, options, result);
  }
  if (model.parts.empty())
    return invalid_input(input.name(), "nothing in it moves that could be judged, so there is nothing to show");
  model.worst = find_worst_places(model.parts);
  for (const ModelPart& part : model.parts) {
    ReportPart& told_part = result.parts.emplace_back();
    told_part.name = part.name;
    told_part.vertices = part.vertex_count();
    told_part.triangles = part.triangles.size() / 3;
    told_part.motions = part.motions.size();
    for (const ModelMotion& motion : part.motions) told_part.samples += motion.at.size();
  }
  result.worst = model.worst;
  result.thinned = model.thinned;
  result.container = write_container(head_of(result), model);
  return result;
}

}  // namespace chronormal
