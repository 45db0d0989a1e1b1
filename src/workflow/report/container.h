/// The container of a report: JSON, and the arrays that it names (docs/formats.md). Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_REPORT_CONTAINER_H_
#define CHRONORMAL_WORKFLOW_REPORT_CONTAINER_H_

#include <string>
#include <string_view>

#include "workflow/report/report_model.h"

namespace chronormal::inline internal {

/// head has what the JSON begins with: the fields that are no part of the model, as text, each with a comma behind it.
[[nodiscard]] std::string write_container(const std::string& head, const ReportModel& model);

/// The bytes by gzip.
[[nodiscard]] std::string gzipped(std::string_view bytes);

/// The bytes as base64, with padding.
[[nodiscard]] std::string base64(std::string_view bytes);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_REPORT_CONTAINER_H_
