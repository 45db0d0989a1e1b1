// Prints the result of `audit` as tables and lists.
#include "cli/reports/audit/audit_report.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "chronormal/normals/weighting.h"
#include "cli/options/command.h"
#include "cli/reports/audit/audit_advice.h"
#include "cli/reports/audit/audit_findings.h"
#include "cli/reports/audit/audit_words.h"
#include "cli/terminal/format.h"
#include "cli/terminal/screen.h"
#include "cli/terminal/table.h"
#include "cli/terminal/text.h"
#include "workflow/inspect/trouble.h"

namespace chronormal::cli {
namespace {

using Align = Table::Align;

constexpr std::size_t kLongestBar = 40;
constexpr double kSeen = 0.005;                     // the smallest number of degrees that two decimals show
constexpr double kMost = 0.99, kNearlyAll = 0.999;  // shares of the samples for the columns of percentiles
// A report names a viewer that draws a vertex farther from its true place than this share of the mesh's diagonal.
constexpr double kDisplaced = 1e-5;

// Returns words that say if the audit is within its limits, or in how many viewers: "within 1 degree and 0 torn edges
// in 2 of 3 viewers".
std::string limits_words(const Audited& input) {
  std::string limits;
  if (input.limits.degrees) limits = with_degrees(with_digits(*input.limits.degrees, 6));
  if (input.limits.torn_edges)
    limits += (limits.empty() ? "" : " and ") + counted(*input.limits.torn_edges, "torn edge", "torn edges");
  const std::vector<ViewerAudit>& viewers = input.audit.viewers;
  if (viewers.empty()) return formatted("{} {}", input.passed() ? "within" : "beyond", limits);
  const auto within =
      std::count_if(viewers.begin(), viewers.end(), [&](const ViewerAudit& viewer) { return input.passed(viewer); });
  return formatted("within {} in {} of {}", limits, within, counted(viewers.size(), "viewer", "viewers"));
}

// Returns the number of torn edges per sample, on average, or "-" if torn edges were not counted.
std::string torn(const MotionError& error) {
  if (error.samples == 0) return "-";
  const double edges = error.torn_edges();
  if (edges >= 10 || edges == std::floor(edges)) return grouped(static_cast<std::size_t>(std::lround(edges)));
  return formatted("{:.2g}", edges);
}

// Returns a line that names the weighting by which true normals are defined, or an empty text for the usual weighting,
// which is by area.
std::string weighting_words(const Audited& input) {
  const Audit& audit = input.audit;
  if (audit.weighting == Weighting::kArea) return "";
  if (!audit.weighting) return "  true normals are weighted like the base normals of each mesh (see below)\n";
  const bool is_detected = !audit.offsets.empty() && audit.offsets.front().is_detected;
  return formatted("  true normals are {}-weighted, as {}\n", weighting_name(*audit.weighting),
                   is_detected ? "the base normals of the file are" : "--weighting says");
}

std::string headline(const Audited& input) {
  const Audit& audit = input.audit;
  std::string text = heading(printable(input.name())) + ": ";
  if (audit.subjects.empty())
    return text + "there is nothing to judge, since no morph target and no animation moves stored normals\n";
  text += formatted("errors of {} degrees on average, {} at worst", degrees(audit.error.mean()),
                    judged_degrees(audit.error.worst));
  if (audit.error.samples > 0)
    text += audit.error.most_torn == 0 ? ", no torn edges" : formatted(", {} torn edges on average", torn(audit.error));
  if (input.limits.any()) text += "; " + limits_words(input);
  text += formatted("\n  99 % of the normals are within {} degrees, 99.9 % within {}\n",
                    degrees(audit.error.percentile(kMost)), degrees(audit.error.percentile(kNearlyAll)));
  if (audit.worst) text += "  the worst is at " + worst_label(input) + '\n';
  const char* source =
      audit.stored ? "stored normals" : "normals that a viewer computes at keyframes, since none are stored";
  if (audit.rule == AuditRule::kFlat) source = "the normals of faces";
  text += formatted("  checked {} (vertices at moments) in {}, by the rule {} from {}\n", samples(audit.error.judged),
                    counted(audit.subjects.size(), "motion", "motions"), audit_rule_name(audit.rule), source);
  text += weighting_words(input);
  if (audit.still > 0)
    text += formatted("  {} nothing that can be judged\n",
                      counted(audit.still, "target or track moves", "targets or tracks move"));
  if (audit.error.no_normal > 0)
    text +=
        formatted("  {} cannot be judged, since the faces there have almost no area\n", samples(audit.error.no_normal));
  if (audit.error.cancelled > 0)
    text += formatted(
        "  {} of the samples cannot be judged because the normals of faces cancel each other, as on a sheet "
        "whose sides share\n  vertices. Such samples count as errors whatever --tolerance is. The first is at {}\n",
        grouped(audit.error.cancelled), cancelled_label(input));
  if (audit.error.faint_worst > input.limits.degrees.value_or(kAuditFault))
    text += formatted(
        "  at {}, the faces have almost no area but the normal has a direction; errors there reach {} degrees, and "
        "--tolerance applies to them\n",
        samples(audit.error.faint), degrees(audit.error.faint_worst));
  if (audit.error.unlit > 0)
    text += formatted(
        "  the normals of {} would be zero, infinite or NaN in a viewer, and count as errors of 180 degrees. The first "
        "is at {}\n",
        samples(audit.error.unlit), unlit_label(input));
  return text;
}

std::string subject_table(const Audited& input) {
  const std::vector<AuditSubject>& subjects = input.audit.subjects;
  std::vector<double> errors;
  errors.reserve(subjects.size());
  for (const AuditSubject& subject : subjects) errors.push_back(subject.error.worst);
  Table table;
  table.add_column("motion", "", Align::kLeft);
  table.add_column("worst", "degrees", Align::kRight);
  table.add_column("average", "degrees", Align::kRight);
  table.add_column("99 %", "degrees", Align::kRight);
  table.add_column("99.9 %", "degrees", Align::kRight);
  table.add_column("at keys", "degrees", Align::kRight);
  if (input.audit.error.samples > 0) table.add_column("torn", "edges", Align::kRight);
  table.add_column("worst at", "vertex", Align::kRight);
  table.add_column("", "", Align::kLeft);
  table.add_column("vertices", "that move", Align::kRight);
  table.add_column("samples", "", Align::kRight);
  for (const std::size_t s : indices_of_largest(errors, kMostAuditRows)) {
    const AuditSubject& subject = subjects[s];
    const bool some = subject.error.worst > 0;
    std::vector<std::string> cells = {subject_words(input, subject),
                                      judged_degrees(subject.error.worst),
                                      degrees(subject.error.mean()),
                                      degrees(subject.error.percentile(kMost)),
                                      degrees(subject.error.percentile(kNearlyAll)),
                                      degrees(subject.at_keys.worst)};
    if (input.audit.error.samples > 0) cells.push_back(torn(subject.error));
    cells.insert(cells.end(), {some ? formatted("{}", subject.error.worst_at.vertex) : "-",
                               some ? moment_words(subject, subject.error.worst_at.at) : "", grouped(subject.vertices),
                               subject.segments > 1 ? formatted("{} x {}", grouped(subject.segments), subject.samples)
                                                    : formatted("{}", subject.samples)});
    table.add_row(std::move(cells));
  }
  std::string text = table.text();
  if (subjects.size() > kMostAuditRows)
    text += formatted("... and {} with smaller errors (--json has all)\n",
                      counted(subjects.size() - kMostAuditRows, "more motion", "more motions"));
  return text;
}

// Returns a table with a row of errors for each viewer. The first row follows the specification of glTF, and so do all
// later tables.
std::string viewer_table(const Audited& input) {
  const Audit& audit = input.audit;
  if (audit.viewers.empty()) return "";
  Table table;
  table.add_column("viewer", "", Align::kLeft);
  for (const char* const title : {"average", "99 %", "99.9 %", "worst"})
    table.add_column(title, "degrees", Align::kRight);
  table.add_column("torn", "edges", Align::kRight);
  table.add_column("unlit", "samples", Align::kRight);
  table.add_column("displaced", "% of size", Align::kRight);
  table.add_column("", "", Align::kLeft);
  const auto add_row = [&](std::string_view title, const MotionError& error, const std::string& displaced,
                           const std::string& note) {
    table.add_row({std::string(title), degrees(error.mean()), degrees(error.percentile(kMost)),
                   degrees(error.percentile(kNearlyAll)), judged_degrees(error.worst), torn(error),
                   grouped(error.unlit), displaced, note});
  };
  add_row("(specification)", audit.error, "-", "");
  for (const ViewerAudit& found : audit.viewers) {
    std::string note = found.beyond > 0 ? "too many targets" : "";
    if (note.empty() && !input.passed(found)) note = "beyond the limits";
    add_row(found.viewer.title, found.error,
            found.displaced > kDisplaced ? formatted("{:.2g}", 100 * found.displaced) : "-", note);
  }
  return '\n' + table.text();
}

std::string bin_words(std::size_t bin) {
  if (bin == 0) return formatted("below {:g}", kAuditBinEdges.front());
  if (bin == kAuditBinEdges.size()) return formatted("{:g} and more", kAuditBinEdges.back());
  return formatted("{:g} to {:g}", kAuditBinEdges[bin - 1], kAuditBinEdges[bin]);
}

std::string histogram(const MotionError& error) {
  Table table;
  table.add_column("error", "degrees", Align::kRight);
  table.add_column("samples", "", Align::kRight);
  table.add_column("share", "%", Align::kRight);
  table.add_column("", "", Align::kLeft);
  const std::size_t most = *std::max_element(error.histogram.begin(), error.histogram.end());
  // The bars get the columns that the other cells leave free.
  constexpr std::size_t kShare = 5, kGaps = 6;
  std::size_t words = 0;
  for (std::size_t bin = 0; bin < kAuditBins; ++bin) words = std::max(words, bin_words(bin).size());
  const std::size_t taken = words + std::max(grouped(most).size(), std::string_view("samples").size()) + kShare + kGaps,
                    columns = columns_of_output();
  const std::size_t longest = std::min(kLongestBar, columns > taken ? columns - taken : 1);
  for (std::size_t bin = 0; bin < kAuditBins; ++bin) {
    const double count = static_cast<double>(error.histogram[bin]);
    const auto bar =
        most > 0
            ? static_cast<std::size_t>(std::lround(static_cast<double>(longest) * count / static_cast<double>(most)))
            : 0;
    const double share = error.judged > 0 ? 100 * count / static_cast<double>(error.judged) : 0;
    table.add_row({bin_words(bin), grouped(error.histogram[bin]), formatted("{:.1f}", share),
                   std::string(error.histogram[bin] > 0 ? std::max<std::size_t>(bar, 1) : 0, '#')});
  }
  return table.text();
}

std::string offset_line(const Audited& input, const AuthoredOffset& offset) {
  const std::string mesh = offset.mesh ? mesh_label(*input.document(), *offset.mesh) : "keyframe 0";
  const std::string_view weighting = weighting_name(offset.weighting);
  std::string text =
      formatted("  {}: {} degrees on average, {} at worst, from {}-weighted normals{}", mesh, degrees(offset.mean()),
                degrees(offset.worst), weighting, offset.of_polygons ? " of polygons" : "");
  if (offset.worst >= kSeen) text += " (" + vertex_words(input, offset.worst_at) + ")";
  if (offset.is_detected && offset.weighting != Weighting::kArea)
    text += formatted(", which your normals follow; on average they are {} degrees from area-weighted ones",
                      degrees(offset.area_mean));
  else if (!offset.is_detected && offset.mean() >= kSeen && offset.closest_mean < offset.mean() / 2)
    text += formatted("; --weighting {} is closer, {} on average, {} at worst", weighting_name(offset.closest),
                      degrees(offset.closest_mean), degrees(offset.closest_worst));
  return text + '\n';
}

std::string offset_lines(const Audited& input) {
  std::string text;
  std::size_t rows = 0, more = 0;
  for (const AuthoredOffset& offset : input.audit.offsets) {
    if (offset.vertices == 0) continue;
    if (rows++ < kMostAuditRows)
      text += offset_line(input, offset);
    else
      ++more;
  }
  if (more > 0) text += formatted("  ... and {} (--json has all)\n", counted(more, "more mesh", "more meshes"));
  return text.empty()
             ? text
             : "\nDifference between your normals at rest and smooth ones (intended by authors, and no error):\n" +
                   text;
}

// Names the place of the first sample with a fault of one kind. `count` is the member of MotionError that counts such
// samples, such as unlit. `place` is the member that has the place of the first one, such as unlit_at.
std::string first_label(const Audited& input, std::size_t MotionError::*count, AuditPlace MotionError::*place) {
  const std::vector<AuditSubject>& subjects = input.audit.subjects;
  const auto first =
      std::find_if(subjects.begin(), subjects.end(), [&](const AuditSubject& s) { return s.error.*count > 0; });
  return first == subjects.end() ? "" : place_words(input, *first, first->error.*place);
}

}  // namespace

std::string worst_label(const Audited& input) {
  if (!input.audit.worst) return "";
  const AuditSubject& subject = input.audit.subjects[*input.audit.worst];
  return place_words(input, subject, subject.error.worst_at);
}

std::string worst_label(const Audited& input, const ViewerAudit& viewer) {
  return viewer.worst ? place_words(input, input.audit.subjects[*viewer.worst], viewer.error.worst_at) : "";
}

std::string unlit_label(const Audited& input) {
  return first_label(input, &MotionError::unlit, &MotionError::unlit_at);
}

std::string cancelled_label(const Audited& input) {
  return first_label(input, &MotionError::cancelled, &MotionError::cancelled_at);
}

std::string faint_label(const Audited& input) {
  const std::vector<AuditSubject>& subjects = input.audit.subjects;
  const auto worst = std::max_element(
      subjects.begin(), subjects.end(),
      [](const AuditSubject& a, const AuditSubject& b) { return a.error.faint_worst < b.error.faint_worst; });
  return worst == subjects.end() ? "" : place_words(input, *worst, worst->error.faint_at);
}

std::string audit_text(const Audited& input) {
  std::string text = headline(input);
  if (!input.audit.subjects.empty())
    text += viewer_table(input) + '\n' + subject_table(input) + '\n' + histogram(input.audit.error);
  return with_headings(text + offset_lines(input) + fault_lines(input) + note_lines(input) + advice(input));
}

}  // namespace chronormal::cli
