// Gathers the data of a report, and puts it into its container.
#include "workflow/report/report.h"

#include <algorithm>
#include <string>
#include <utility>

#include "workflow/audit/watched_audit.h"
#include "workflow/json/audit_json.h"
#include "workflow/json/json.h"
#include "workflow/json/object.h"
#include "workflow/report/container.h"
#include "workflow/report/report_model.h"
#include "workflow/report/report_parts.h"
#include "workflow/report/thinning.h"
#include "workflow/report/watched_motions.h"
#include "workflow/report/worst_places.h"

namespace chronormal::inline internal {
namespace {

// If a page is still too large after its arrays were thinned out, the arrays are thinned out again, each time to kShare
// times the bytes of the attempt before. The attempts end below kLeastShare of the bytes that should fit.
constexpr double kShare = 0.9, kLeastShare = 0.1;

std::function<void(std::size_t, std::size_t)> told(const ReportOptions& options, std::string_view what) {
  if (!options.progress) return {};
  return [&options, what](std::size_t done, std::size_t total) { options.progress(what, done, total); };
}

// Compares schemes on the vertices of a motion, at the samples of its audit.
Result<NamedComparison> compare_schemes(Input& input, const Motion& motion, const Audit& audit,
                                        const ReportOptions& options) {
  CompareOptions how;
  how.samples = audit.subjects[0].samples;
  how.elements = {ElementKind::kVertices};
  how.keep_samples = true;
  how.progress = told(options, "comparing");
  Result<Comparison> compared = compare(motion, how);
  if (!compared) return compared.error();
  Result<TargetNames> names = target_names(input);
  if (!names) return names.error();
  return NamedComparison{input.name(), std::move(compared).value(), std::move(names).value()};
}

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
  how.viewers = {kViewers.begin(), kViewers.end()};
  how.skins = false;  // a page cannot move joints
  WatchedMotions watched(how.viewers, options.viewers);
  Result<Audit> found = watched_audit(document, how, [&](const AuditSample& sample) { watched.add(sample); });
  if (!found) return found.error();
  report.audit = std::move(found).value();
  model.kind = "gltf";
  for (auto& [mesh, motions] : watched.take()) {
    Result<ModelPart> part = gltf_part(document, *mesh, options.weighting, options.viewers, std::move(motions));
    if (!part) return part.error();
    model.parts.push_back(std::move(part).value());
  }
  return Success{};
}

Status read_motion(Input& input, const ReportOptions& options, Report& report, ReportModel& model) {
  const Result<const Motion*> motion = input.motion();
  if (!motion) return motion.error();
  const Result<const StoredNormals*> normals = input.normals();
  if (!normals) return normals.error();
  const Result<MotionVertices> vertices = motion_vertices(*motion.value(), *normals.value());
  if (!vertices) return vertices.error();
  WatchedMotions watched({}, {}, vertices.value().of_corner);
  MotionStream stream(*motion.value());
  AuditRun run;
  run.progress = told(options, "auditing");
  Result<Audit> found = watched_audit(stream, *normals.value(), audit_options(options), run,
                                      [&](const AuditSample& sample) { watched.add(sample); });
  if (!found) return found.error();
  report.audit = std::move(found).value();
  if (report.audit.subjects.empty()) return Success{};
  Result<NamedComparison> compared = compare_schemes(input, *motion.value(), report.audit, options);
  if (!compared) return compared.error();
  model.kind = motion.value()->kind == MotionKind::kTargets ? "targets" : "sequence";
  model.parts.push_back(motion_part(*motion.value(), *normals.value(), vertices.value(), compared.value().comparison,
                                    std::move(watched.take().begin()->second)));
  report.comparison = std::move(compared).value();
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

// Returns the fields of a container that hold the JSON of commands. Each field is followed by a comma.
std::string head_of(const Report& report) {
  const auto line = [](const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); };
  const auto in_one_line = [&](const std::string& text) { return line(Json::parse(text)); };
  std::string fields;
  const auto add = [&](const std::string& name, const std::string& value) { fields += line(name) + ':' + value + ','; };
  add("schema", "2");
  add("program", line("chronormal " + json_of_command("report")["chronormal"].get<std::string>()));
  add("input", line(report.input));
  add("audit", audit_line(report.input, report.audit, {}));
  add("plan",
      report.plan ? in_one_line(plan_json(*report.plan, {report.input, "", std::nullopt, std::nullopt})) : "null");
  add("plan_message", report.plan_message.empty() ? "null" : line(report.plan_message));
  add("compare", report.comparison ? in_one_line(compare_json({*report.comparison}, false, false)) : "null");
  return fields;
}

// Returns the size in bytes of a page: the template with the container inserted. The container has `packed` bytes after
// compression, and takes a third more in base64.
std::size_t page_bytes(std::size_t packed, const ReportOptions& options) {
  constexpr std::size_t kElement = 128;
  return options.template_bytes + kElement + (packed + 2) / 3 * 4;
}

// Returns the bytes of the container. If the page would be too large, thins out the model first.
std::string write_within(const std::string& head, ReportModel& model, const ReportOptions& options) {
  std::string container = write_container(head, model);
  // Measures how well the arrays of the whole model compress, as an estimate for the thinned model. The arrays of the
  // thinned model may compress worse.
  const std::size_t packed = page_bytes(gzipped(container).size(), options);
  if (packed <= options.most_bytes) return container;
  const double per_byte = static_cast<double>(packed - options.template_bytes) / static_cast<double>(container.size());
  const std::size_t room =
      options.most_bytes > options.template_bytes ? options.most_bytes - options.template_bytes : 0;
  const ReportModel whole = std::move(model);
  for (double share = kShare;; share *= kShare) {
    model = whole;
    const double most = share * static_cast<double>(room) / per_byte;
    // The bytes of the container that are not in arrays.
    const std::size_t beside = container.size() - std::min(container.size(), bytes_of(whole));
    thin_out(model, static_cast<std::size_t>(std::max(0.0, most - static_cast<double>(beside))));
    std::string thinned = write_container(head, model);
    if (share < kLeastShare || page_bytes(gzipped(thinned).size(), options) <= options.most_bytes) return thinned;
  }
}

}  // namespace

Result<Report> report(Input& input, const ReportOptions& options) {
  Report result;
  ReportModel model;
  result.input = without_folders(input.name());
  if (const GltfDocument* const document = input.document(); document != nullptr) {
    if (const Status status = read_gltf(*document, options, result, model); !status) return status.error();
    if (!model.parts.empty()) plan(*document, options, result);
  } else {
    if (const Status status = read_motion(input, options, result, model); !status) return status.error();
  }
  if (model.parts.empty()) {
    constexpr const char* kStillDocument =
        "the file has no morph target that moves a surface with normals, so there is nothing to show; export shape "
        "keys (blend shapes) as morph targets with normals";
    constexpr const char* kStillMotion = "nothing moves in this input, so there is nothing to show; give a motion";
    return invalid_input(input.name(), input.document() != nullptr ? kStillDocument : kStillMotion);
  }
  model.worst = find_worst_places(model.parts);
  result.container = write_within(head_of(result), model, options);
  for (const ModelPart& part : model.parts) {
    ReportPart& told_part = result.parts.emplace_back();
    told_part.name = part.name;
    told_part.vertices = part.vertex_count();
    told_part.triangles = (part.triangles.size() + part.coarse.size()) / 3;
    told_part.motions = part.motions.size();
    for (const ModelMotion& motion : part.motions) told_part.samples += motion.at.size();
  }
  result.worst = model.worst;
  result.thinned = model.thinned;
  return result;
}

}  // namespace chronormal::inline internal
