#include "workflow/json/json.h"
#include "workflow/json/object.h"

namespace chronormal::inline internal {

std::string truth_json(const NamedTruthComparison& input) {
  const TruthComparison& c = input.comparison;
  const auto degrees = [](double radians) { return radians * kDegreesPerRadian; };
  Json json = json_of_command("compare");
  json["input"] = {{"name", input.name}, {"vertices", c.vertices}, {"faces", c.faces}};
  if (c.kind != ElementKind::kFaces) json["input"]["different_normals"] = c.elements;
  json["elements"] = element_kind_name(c.kind);
  json["kept_keyframes"] = c.kept;
  json["left_out_keyframes"] = c.left_out;
  json["bend"] = c.bend;
  json["is_too_sparse"] = is_too_sparse(c.bend);
  json["rows"] = Json::array();
  for (const TruthRow& row : c.rows) {
    const Quality& q = row.quality;
    json["rows"].push_back(
        {{"path", row.path},
         {"scheme", row.scheme},
         {"mean_degrees", degrees(q.mean())},
         {"rms_degrees", degrees(q.rms())},
         {"max_degrees", degrees(q.max)},
         {"max_at", {{"segment", q.max_at.segment}, {"element", q.max_at.element}, {"t", q.max_at.t}}},
         {"degenerate", q.degenerate},
         {"missing", q.missing}});
  }
  return json_text(json);
}

}  // namespace chronormal::inline internal
