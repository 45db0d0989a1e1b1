// Creates the page of a report from a template and the container.
#include <string>

#include "workflow/json/object.h"
#include "workflow/report/container.h"
#include "workflow/report/report.h"

namespace chronormal::inline internal {

Status check_report_template(std::string_view page_template) {
  const std::size_t at = page_template.find(kReportMark);
  if (at != std::string_view::npos && page_template.find(kReportMark, at + 1) == std::string_view::npos)
    return Success{};
  return invalid_input("", std::string("the template of the page must hold the text ").append(kReportMark) +
                               " exactly once, where the report goes; ./run report makes such a template");
}

Result<std::string> report_page(const Report& report, std::string_view page_template) {
  if (const Status status = check_report_template(page_template); !status) return status.error();
  const std::size_t at = page_template.find(kReportMark);
  std::string page(page_template.substr(0, at));
  page += "<script type=\"application/octet-stream\" id=\"chronormal-data\">";
  page += base64(gzipped(report.container));
  page += "</script>";
  page += page_template.substr(at + kReportMark.size());
  return page;
}

std::string report_json(const Report& report, const std::string& output, std::size_t bytes) {
  Json json = json_of_command("report");
  json["input"] = {{"name", report.input}};
  json["output"] = {{"name", output}, {"bytes", bytes}};
  json["worst_degrees"] = report.audit.error.worst;
  json["mean_degrees"] = report.audit.error.mean();
  json["parts"] = Json::array();
  for (const ReportPart& part : report.parts)
    json["parts"].push_back({{"name", part.name},
                             {"vertices", part.vertices},
                             {"triangles", part.triangles},
                             {"motions", part.motions},
                             {"samples", part.samples}});
  json["worst"] = Json::array();
  for (const ReportPlace& place : report.worst)
    json["worst"].push_back({{"place", place.label}, {"moment", place.moment}, {"degrees", place.degrees}});
  json["planned"] = report.plan.has_value();
  json["plan_message"] = report.plan_message.empty() ? Json() : Json(report.plan_message);
  json["thinned"] = report.thinned;
  return json_text(json);
}

}  // namespace chronormal::inline internal
