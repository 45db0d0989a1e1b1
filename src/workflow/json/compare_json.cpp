// Writes the result of a comparison as JSON.
#include "chronormal/analysis/quality.h"
#include "workflow/json/json.h"
#include "workflow/json/object.h"

namespace chronormal::inline internal {
namespace {

double degrees(double radians) { return radians * kDegreesPerRadian; }

Json input_json(const NamedComparison& input) {
  const Comparison& c = input.comparison;
  Json json = {{"name", input.name}, {"vertices", c.vertices}, {"faces", c.faces}, {"segments", c.segments}};
  if (c.kind != ElementKind::kFaces) json["different_normals"] = c.elements;
  put_path(json, c.cut);
  return json;
}

Json scheme_json(const SchemeComparison& row, bool with_times) {
  const Quality& q = row.quality;
  Json json = {{"scheme", row.scheme},
               {"sum_degrees", degrees(q.sum)},
               {"relative_to_linear", or_null(row.relative_to_linear)},
               {"mean_degrees", degrees(q.mean())},
               {"rms_degrees", degrees(q.rms())},
               {"max_degrees", degrees(q.max)},
               {"max_at", {{"segment", q.max_at.segment}, {"element", q.max_at.element}, {"t", q.max_at.t}}},
               {"degenerate", q.degenerate},
               {"missing", q.missing},
               {"fallbacks", row.fallbacks},
               {"flagged", row.flagged}};
  if (row.certified) {
    const CertifiedError& c = *row.certified;
    json["certified"] = {{"lower_degrees", degrees(c.lower)},
                         {"upper_degrees", degrees(c.upper)},
                         {"upper_at", {{"segment", c.segment}, {"element", c.element}, {"from", c.from}, {"to", c.to}}},
                         {"unbounded", c.unbounded}};
  }
  if (with_times) {
    json["prepare_ns"] = row.prepare_ns;
    json["evaluate_ns"] = row.evaluate_ns;
  }
  json["bytes"] = row.bytes;
  json["access"] = row.sequential ? "sequential" : "random";
  json["operations"] = {{"add", row.operations.add},
                        {"multiply", row.operations.multiply},
                        {"divide", row.operations.divide},
                        {"sqrt", row.operations.sqrt},
                        {"trigonometric", row.operations.trigonometric}};
  return json;
}

Json schemes_json(const NamedComparison& input, bool with_times) {
  Json schemes = Json::array();
  for (const SchemeComparison& row : input.comparison.schemes) schemes.push_back(scheme_json(row, with_times));
  return schemes;
}

// Writes the field `cheapest`, but only if the caller gave a tolerance. The value is null if no scheme is within the
// tolerance.
void put_cheapest(Json& json, const Comparison& c) {
  if (!c.tolerance) return;
  json["tolerance_degrees"] = *c.tolerance;
  json["cheapest"] = c.cheapest ? Json(c.schemes[*c.cheapest].scheme) : Json();
}

Json error_json(const BlendSubject& subject, const BlendError& error) {
  const Quality& q = error.quality;
  Json weights = Json::array();
  for (const BlendError::Weight& w : error.worst_weights)
    weights.push_back({{"target", w.target}, {"name", subject.targets[w.target]}, {"weight", w.weight}});
  Json at = {{"row", q.max_at.segment}};
  if (error.worst_primitive) at["primitive"] = *error.worst_primitive;
  at[std::string(one_element(subject.kind))] = error.worst_output;
  at["weights"] = std::move(weights);
  return {{"deltas", name_of(error.deltas)},
          {"mean_degrees", degrees(q.mean())},
          {"rms_degrees", degrees(q.rms())},
          {"max_degrees", degrees(q.max)},
          {"max_at", q.max > 0 ? std::move(at) : Json()},
          {"normals", q.count},
          {"degenerate", q.degenerate},
          {"missing", q.missing}};
}

}  // namespace

std::string compare_json(const std::vector<NamedComparison>& inputs, bool several, bool with_times) {
  Json json = json_of_command("compare");
  if (!several) json["input"] = input_json(inputs.front());
  json["elements"] = element_kind_name(inputs.front().comparison.kind);
  if (inputs.front().comparison.kind != ElementKind::kFaces)
    json["weighting"] = weighting_name(inputs.front().comparison.weighting);
  json["samples"] = inputs.front().comparison.samples;
  if (several) {
    json["inputs"] = Json::array();
    for (const NamedComparison& input : inputs) {
      Json one = {{"input", input_json(input)}, {"schemes", schemes_json(input, with_times)}};
      put_cheapest(one, input.comparison);
      json["inputs"].push_back(std::move(one));
    }
  } else {
    json["schemes"] = schemes_json(inputs.front(), with_times);
    put_cheapest(json, inputs.front().comparison);
  }
  return json_text(json);
}

std::string blend_json(const NamedBlendComparison& input) {
  Json json = json_of_command("compare");
  json["input"] = input.name;
  json["weights"] = input.animation.empty() ? "random" : "animation";
  if (!input.animation.empty()) json["animation"] = input.animation;
  json["meshes"] = Json::array();
  for (const BlendSubject& subject : input.comparison.subjects) {
    Json mesh = Json::object();
    if (subject.mesh) mesh = {{"mesh", *subject.mesh}, {"name", subject.name}};
    mesh["vertices"] = subject.vertices;
    mesh["faces"] = subject.faces;
    mesh["targets"] = subject.targets.size();
    mesh["elements"] = element_kind_name(subject.kind);
    mesh["normals"] = subject.outputs;
    mesh["errors"] = Json::array();
    for (const BlendErrors& errors : subject.errors) {
      Json one = {{"active", errors.active}, {"rows", errors.rows}, {"deltas", Json::array()}};
      for (const BlendError& error : errors.deltas) one["deltas"].push_back(error_json(subject, error));
      mesh["errors"].push_back(std::move(one));
    }
    json["meshes"].push_back(std::move(mesh));
  }
  json["flat_meshes"] = input.comparison.flat;
  json["still_meshes"] = input.comparison.still;
  return json_text(json);
}

}  // namespace chronormal::inline internal
