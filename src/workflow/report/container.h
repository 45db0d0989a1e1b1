/// Writes the container of a report: a JSON object, followed by the arrays that the object refers to (docs/formats.md).
/// Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_REPORT_CONTAINER_H_
#define CHRONORMAL_WORKFLOW_REPORT_CONTAINER_H_

#include <string>
#include <string_view>

#include "workflow/report/report_model.h"

namespace chronormal::inline internal {

/// Returns the bytes of the container of a report. `head` is the beginning of the JSON text. It has the fields that do
/// not belong to the model, each followed by a comma.
[[nodiscard]] std::string write_container(const std::string& head, const ReportModel& model);

/// Compresses the bytes with gzip.
[[nodiscard]] std::string gzipped(std::string_view bytes);

/// Encodes the bytes as base64, with padding.
[[nodiscard]] std::string base64(std::string_view bytes);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_REPORT_CONTAINER_H_
