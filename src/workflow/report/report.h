/// A report: all data that a page needs to show how an input deforms, with the rendered normals beside the true ones.
///
///     Result<Input> input = open_input(...);                  // with KeepShading::kAll
///     Result<Report> found = report(input.value(), {});
///     write_output("face.html", report_page(found.value(), page_template).value(), false);
///
/// The report is one container of bytes (docs/formats.md): the mesh, its motions, its stored normals, the samples that
/// audit() judged with the worst and the average error of each, the worst places, and as JSON the results of audit, the
/// plan of bake and compare. The page computes the true and the rendered normals at any moment in between from the same
/// positions and normals, so that its numbers at the worst places are the numbers of the audit.
///
/// Worst      at most kMostWorstPlaces vertices, each at its largest error, which is above kLeastPlace; no two of a
///            mesh are within kPlaceDistance of each other.
/// Thinned    a page above the size limit is thinned out, and states this. First keyframes and samples between the
///            worst places are dropped, then triangles far from these places become fewer and are not judged. All data
///            that the normals around a worst place depend on is kept unchanged.
/// Threads    uses all cores; gives the same bytes on any number of them.
#ifndef CHRONORMAL_WORKFLOW_REPORT_REPORT_H_
#define CHRONORMAL_WORKFLOW_REPORT_REPORT_H_

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/io/input.h"
#include "chronormal/normals/weighting.h"
#include "chronormal/workflow/audit.h"
#include "chronormal/workflow/bake.h"
#include "chronormal/workflow/viewers.h"
#include "workflow/json/json.h"

namespace chronormal::inline internal {

inline constexpr std::size_t kMostReportBytes = 30000000;  ///< size limit of a page with its template
inline constexpr std::size_t kMostWorstPlaces = 20;
inline constexpr double kLeastPlace = 0.001;  ///< degrees; a place with a smaller error is not a worst place
/// Least distance between worst places, as a share of the mesh's diagonal.
inline constexpr double kPlaceDistance = 0.04;

struct ReportOptions {
  std::string animation = {};               ///< see AuditOptions
  std::optional<std::size_t> samples = {};  ///< see AuditOptions
  std::optional<Weighting> weighting = {};  ///< see AuditOptions
  std::vector<Viewer> viewers = {};         ///< viewers of glTF files to show besides the specification
  bool plan = true;                         ///< glTF: with the candidates of bake for each mesh
  std::size_t most_bytes = kMostReportBytes;
  std::size_t template_bytes = 0;  ///< size of the page without the report
  /// A function that is called with the current step ("auditing", "comparing", "planning") and its progress.
  std::function<void(std::string_view what, std::size_t done, std::size_t total)> progress = {};
};

/// A vertex at the moment of its largest error.
struct ReportPlace {
  std::size_t part = 0, motion = 0, sample = 0, vertex = 0;  ///< indices in Report::parts and below
  double degrees = 0;
  std::string label;   ///< the name in terms of the file: "mesh 0, primitive 1, vertex 5051"
  std::string moment;  ///< "jawOpen at 0.55", "talk at 1.25 s"
};

/// A mesh in the report.
struct ReportPart {
  std::string name;
  std::size_t vertices = 0, triangles = 0, motions = 0, samples = 0;
};

struct Report {
  std::string input;  ///< name of the input without folders
  Audit audit;        ///< errors of the input; for a glTF file, with all viewers
  std::optional<GltfBake> plan;
  std::string plan_message;                   ///< why a requested plan is missing
  std::optional<NamedComparison> comparison;  ///< errors of schemes, on vertices, unless the input is glTF
  std::vector<ReportPart> parts;
  std::vector<ReportPlace> worst;    ///< worst first
  std::vector<std::string> thinned;  ///< descriptions of the data that was left out, one sentence each
  std::string container;             ///< the bytes
};

/// Makes the report of an input that was opened with KeepShading::kAll. The container has keyframes in float32, from
/// which a page computes; the numbers of the audit and of the schemes include residuals too. Needs about three times
/// the memory of the container, besides the memory of an audit. Errors: of audit(); kInvalidInput if no motion can be
/// judged.
[[nodiscard]] Result<Report> report(Input& input, const ReportOptions& options);

/// The mark that a template contains exactly once, and that the report replaces.
inline constexpr std::string_view kReportMark = "<!--chronormal-data-->";

/// Checks that a template contains the mark exactly once. Errors: kInvalidInput if not.
[[nodiscard]] Status check_report_template(std::string_view page_template);

/// Fills a template. The container, compressed and in base64, becomes a script element in place of the mark. In base64,
/// no name from a file can end the element. Errors: those of check_report_template().
[[nodiscard]] Result<std::string> report_page(const Report& report, std::string_view page_template);

/// Returns the contents of the report as JSON for programs. `output` is the name of the written file, and `bytes` its
/// size.
[[nodiscard]] std::string report_json(const Report& report, const std::string& output, std::size_t bytes);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_REPORT_REPORT_H_
