/// A report: all data that a page needs to show how an input deforms, with the rendered normals beside the true ones.
///
///     Result<Input> input = open_input(...);                  // with KeepShading::kAll
///     Result<Report> found = report(input.value(), {});
///     write_output("face.html", report_page(found.value(), page_template).value(), false);
///
/// The report is a container of bytes (docs/formats.md). It has the mesh, its motions and its stored normals. It also
/// has the samples that audit() judged, with the worst and the average error of each sample, and the worst places. Its
/// JSON has the results of audit and compare, and the plan of bake. The page computes the true and the rendered normals
/// at any moment from the same positions and normals, so its numbers at the worst places equal the numbers of the
/// audit.
///
/// Worst      At most kMostWorstPlaces vertices, each at its largest error, which is above kLeastPlace. No two places
///            on one mesh are within kPlaceDistance of each other.
/// Thinned    A page above the size limit is thinned out, and states what is left out. First, keyframes and samples
///            between the worst places are removed. Then triangles far from these places become fewer, and are not
///            judged. All data on which the normals around a worst place depend stay unchanged.
/// Threads    Uses all cores, and gives the same bytes on any number of cores.
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

inline constexpr std::size_t kMostReportBytes = 30000000;  ///< in bytes; the size limit of a page with its template
inline constexpr std::size_t kMostWorstPlaces = 20;
inline constexpr double kLeastPlace = 0.001;  ///< in degrees; a vertex with a smaller error is not a worst place
/// The smallest distance between two of the worst places, as a share of the diagonal of the box around the mesh.
inline constexpr double kPlaceDistance = 0.04;

struct ReportOptions {
  std::string animation = {};               ///< see AuditOptions
  std::optional<std::size_t> samples = {};  ///< see AuditOptions
  std::optional<Weighting> weighting = {};  ///< see AuditOptions
  std::vector<Viewer> viewers = {};         ///< the viewers of glTF files that the page shows besides the specification
  bool plan = true;                         ///< for a glTF file, adds the plan: the candidates of bake for each mesh
  std::size_t most_bytes = kMostReportBytes;
  std::size_t template_bytes = 0;  ///< bytes: the size of the template of the page
  /// A function that is called with the current step ("auditing", "comparing", "planning") and its progress.
  std::function<void(std::string_view what, std::size_t done, std::size_t total)> progress = {};
};

/// One of the worst places of a report: a vertex at the moment of its largest error.
struct ReportPlace {
  /// Indices of the part in Report::parts, of the motion in the part, of the sample in the motion, and of the vertex in
  /// the part.
  std::size_t part = 0, motion = 0, sample = 0, vertex = 0;
  double degrees = 0;
  std::string label;   ///< the name of the vertex, such as "mesh 0, primitive 1, vertex 5051"
  std::string moment;  ///< the moment as text, such as "jawOpen at 0.55" or "talk at 1.25 s"
};

/// A part of the report: one mesh with its motions.
struct ReportPart {
  std::string name;
  std::size_t vertices = 0, triangles = 0, motions = 0, samples = 0;
};

struct Report {
  std::string input;  ///< the name of the input without folders
  Audit audit;        ///< the errors of the input; for a glTF file, also those in all viewers
  std::optional<GltfBake> plan;
  std::string plan_message;                   ///< the reason why a requested plan is missing
  std::optional<NamedComparison> comparison;  ///< the comparison of schemes at vertices; not set for a glTF file
  std::vector<ReportPart> parts;
  std::vector<ReportPlace> worst;    ///< the worst places, the largest error first
  std::vector<std::string> thinned;  ///< describes the data that were left out, one sentence for each kind
  std::string container;             ///< the bytes of the container
};

/// Makes the report of an input that was opened with KeepShading::kAll. The container has keyframes in float32, from
/// which a page computes normals. The numbers of the audit and of the schemes also use the residuals of positions
/// beyond float32. Needs about three times the memory of the container, besides the memory of an audit. Errors: those
/// of audit(); kInvalidInput if no motion can be judged.
[[nodiscard]] Result<Report> report(Input& input, const ReportOptions& options);

/// The mark that a page template contains exactly once. The data of the report replace the mark.
inline constexpr std::string_view kReportMark = "<!--chronormal-data-->";

/// Checks that a page template contains kReportMark exactly once. Errors: kInvalidInput if it does not.
[[nodiscard]] Status check_report_template(std::string_view page_template);

/// Returns the page: the template, in which a script element with the container replaces kReportMark. The container is
/// compressed and in base64, so no name from a file can end the element. Errors: those of check_report_template().
[[nodiscard]] Result<std::string> report_page(const Report& report, std::string_view page_template);

/// Returns the contents of the report as JSON, for programs that do not read the page. `output` is the name of the
/// written file, and `bytes` its size.
[[nodiscard]] std::string report_json(const Report& report, const std::string& output, std::size_t bytes);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_REPORT_REPORT_H_
