/// A report: everything that a page needs to show how an input deforms, as it is shown beside as it should be.
///
///     Result<Input> input = open_input(...);                  // with KeepShading::kAll
///     Result<Report> found = report(input.value(), {});
///     write_output("face.html", report_page(found.value(), page_template).value(), false);
///
/// The report is one container of bytes (docs/formats.md): the mesh, what moves it, what is stored of normals, the
/// samples that audit() judged with the worst and the mean error of each, the worst places, and as JSON what audit, the
/// plan of bake and compare say. What is right and what is shown at any moment in between is computed by the page, from
/// the same positions and normals, so that its numbers at the worst places are those of the audit.
///
/// Worst      at most kMostWorstPlaces vertices, each where it is off the most, by more than kLeastPlace, none within
///            kPlaceDistance of another of the same mesh.
/// Thinned    what would make the page larger than the limit is left out, and said: keyframes and samples between those
///            of the worst places, and then triangles far from these, which become fewer and are not judged. Everything
///            that the normals around a worst place depend on is kept as it is.
/// Threads    on all cores; the same bytes on any number of them.
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

inline constexpr std::size_t kMostReportBytes = 30000000;  ///< of a page, its template counted in
inline constexpr std::size_t kMostWorstPlaces = 20;
inline constexpr double kLeastPlace = 0.001;    ///< degrees: what is off by no more is no worst place
inline constexpr double kPlaceDistance = 0.04;  ///< of two worst places, as a share of the diagonal of the mesh

struct ReportOptions {
  std::string animation = {};               ///< as AuditOptions has it
  std::optional<std::size_t> samples = {};  ///< as AuditOptions has it
  std::optional<Weighting> weighting = {};  ///< as AuditOptions has it
  std::vector<Viewer> viewers = {};         ///< glTF: what these show can be looked at, beside the specification
  bool plan = true;                         ///< glTF: with the forms that bake could give each mesh
  std::size_t most_bytes = kMostReportBytes;
  std::size_t template_bytes = 0;  ///< of the page, those that are not the report
  /// Told what is being done ("auditing", "comparing", "planning"), and how much of it.
  std::function<void(std::string_view what, std::size_t done, std::size_t total)> progress = {};
};

/// A vertex at a moment at which it is off the most.
struct ReportPlace {
  std::size_t part = 0, motion = 0, sample = 0, vertex = 0;  ///< of Report::parts, and as these count
  double degrees = 0;
  std::string label;   ///< as the file counts: "mesh 0, primitive 1, vertex 5051"
  std::string moment;  ///< "jawOpen at 0.55", "talk at 1.25 s"
};

/// A mesh as the report has it.
struct ReportPart {
  std::string name;
  std::size_t vertices = 0, triangles = 0, motions = 0, samples = 0;
};

struct Report {
  std::string input;  ///< its name without folders
  Audit audit;        ///< of a glTF file with all viewers
  std::optional<GltfBake> plan;
  std::string plan_message;                   ///< why there is no plan where one was asked for
  std::optional<NamedComparison> comparison;  ///< of the schemes, on the vertices of what is no glTF file
  std::vector<ReportPart> parts;
  std::vector<ReportPlace> worst;    ///< worst first
  std::vector<std::string> thinned;  ///< what was left out: a sentence each
  std::string container;             ///< the bytes
};

/// Makes the report of an input that was opened with KeepShading::kAll. The container has keyframes in float32, from
/// which a page computes; the numbers of the audit and of the schemes count residuals too. Memory: about three times
/// the container, beside what an audit takes. Errors: of audit(); kInvalidInput where nothing moves that could be
/// judged.
[[nodiscard]] Result<Report> report(Input& input, const ReportOptions& options);

/// A template holds this mark exactly once, and the report takes its place.
inline constexpr std::string_view kReportMark = "<!--chronormal-data-->";

/// Whether a template holds the mark exactly once. Errors: kInvalidInput
[[nodiscard]] Status check_report_template(std::string_view page_template);

/// Fills a template: the container, packed and as base64, becomes a script element in place of the mark, from which no
/// name in a file can break out. Errors: those of check_report_template()
[[nodiscard]] Result<std::string> report_page(const Report& report, std::string_view page_template);

/// What the report holds, as JSON for programs. output: the name of what was written, and its size.
[[nodiscard]] std::string report_json(const Report& report, const std::string& output, std::size_t bytes);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_REPORT_REPORT_H_
