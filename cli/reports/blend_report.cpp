#include "cli/reports/blend_report.h"

#include <algorithm>
#include <vector>

#include "cli/reports/compare_report.h"
#include "cli/terminal/format.h"
#include "cli/terminal/rows.h"
#include "cli/terminal/screen.h"
#include "cli/terminal/table.h"
#include "cli/terminal/text.h"

namespace chronormal::cli {
namespace {

using Align = Table::Align;

constexpr std::size_t kShownTargets = 3, kShownName = 24;

bool is_several_primitives(const BlendSubject& subject) {
  for (const BlendErrors& errors : subject.errors)
    for (const BlendError& error : errors.deltas)
      if (error.worst_primitive.value_or(0) > 0) return true;
  return false;
}

std::string headline(const NamedBlendComparison& input, const BlendSubject& subject) {
  std::string text = heading(printable(input.name));
  if (subject.mesh) {
    text += formatted(", mesh {}", *subject.mesh);
    if (!subject.name.empty()) text += formatted(" '{}'", printable(subject.name, kShownName));
  }
  text += formatted(": {}, {}, {}\n", counted(subject.vertices, "vertex", "vertices"),
                    counted(subject.faces, "face", "faces"), counted(subject.targets.size(), "target", "targets"));
  const std::size_t rows = subject.errors.empty() ? 0 : subject.errors.front().rows;
  text += subject.mesh ? counted(subject.outputs, "vertex with a normal", "vertices with normals")
                       : counted(subject.outputs, "different normal", "different normals")
                             .append(subject.kind == ElementKind::kFaces
                                         ? ""
                                         : " of " + std::string(element_kind_name(subject.kind)));
  if (input.animation.empty())
    text += formatted(", {} for each number of active targets\n", counted(rows, "random pose", "random poses"));
  else
    text += formatted(", {} of animation {}\n", counted(rows, "pose", "poses"), printable(input.animation, kShownName));
  return text;
}

std::string target_name(const BlendSubject& subject, std::size_t target) {
  const std::string& name = subject.targets[target];
  return name.empty() ? formatted("{}", target) : name;
}

// Returns the targets that are active at the sample with the worst error, with their weights, the largest weights
// first.
std::string targets_cell(const BlendSubject& subject, const BlendError& error) {
  std::vector<BlendError::Weight> weights = error.worst_weights;
  if (weights.empty()) return "-";
  std::stable_sort(weights.begin(), weights.end(),
                   [](const auto& a, const auto& b) { return std::abs(a.weight) > std::abs(b.weight); });
  std::string text;
  for (std::size_t i = 0; i < std::min(weights.size(), kShownTargets); ++i) {
    if (i > 0) text += ", ";
    const std::string& name = subject.targets[weights[i].target];
    text += formatted("{}{} {:.2f}", weights[i].target, name.empty() ? "" : " (" + printable(name, kShownName) + ")",
                      weights[i].weight);
  }
  if (weights.size() > kShownTargets) text += formatted(" and {} more", weights.size() - kShownTargets);
  return text;
}

std::string table_of(const BlendSubject& subject) {
  Table table;
  table.add_column("active", "targets", Align::kRight);
  table.add_column("deltas", "", Align::kLeft);
  for (const char* const title : {"average", "rms", "worst"}) table.add_column(title, "degrees", Align::kRight);
  const bool several = is_several_primitives(subject);
  if (several) table.add_column("worst at", "primitive", Align::kRight);
  table.add_column(several ? "" : "worst at", std::string(one_element(subject.kind)), Align::kRight);
  table.add_column("", "targets", Align::kLeft);
  for (const BlendErrors& errors : subject.errors) {
    for (const BlendError& error : errors.deltas) {
      const Quality& q = error.quality;
      std::vector<std::string> cells = {&error == &errors.deltas.front() ? grouped(errors.active) : "",
                                        std::string(name_of(error.deltas)), four_decimals(in_degrees(q.mean())),
                                        four_decimals(in_degrees(q.rms())), four_decimals(in_degrees(q.max))};
      if (several) cells.push_back(q.max > 0 ? grouped(error.worst_primitive.value_or(0)) : "-");
      cells.push_back(q.max > 0 ? grouped(error.worst_output) : "-");
      cells.push_back(targets_cell(subject, error));
      table.add_row(std::move(cells));
    }
  }
  return table.text();
}

// Returns a line for each part of the comparison that was left out.
std::string notes(const BlendSubject& subject) {
  std::string text;
  for (const BlendErrors& errors : subject.errors) {
    for (const BlendError& error : errors.deltas) {
      const std::string active = formatted(", {} active: ", grouped(errors.active));
      if (error.quality.missing > 0)
        text += formatted("{}{}{} zero, infinite or NaN, and counted as an error of 180 degrees\n",
                          name_of(error.deltas), active, counted(error.quality.missing, "normal was", "normals were"));
      if (error.quality.degenerate > 0 && error.deltas == BlendDeltas::kExact)
        text += formatted("exact{}{} left out, since faces without area have no normal\n", active,
                          counted(error.quality.degenerate, "normal was", "normals were"));
    }
  }
  return text;
}

std::string notes(const BlendComparison& comparison) {
  std::string text;
  if (comparison.still > 0)
    text += formatted("{} left out, since no target moves any of its normals\n",
                      counted(comparison.still, "mesh was", "meshes were"));
  if (comparison.flat > 0)
    text += formatted("{} left out, since no normals are stored; add --elements vertices to compare smooth ones\n",
                      counted(comparison.flat, "mesh was", "meshes were"));
  return text;
}

}  // namespace

std::string blend_table(const NamedBlendComparison& input) {
  std::string text;
  for (const BlendSubject& subject : input.comparison.subjects) {
    if (!text.empty()) text += '\n';
    const std::string remarks = notes(subject);
    text += headline(input, subject) + '\n' + table_of(subject) + (remarks.empty() ? "" : "\n" + remarks);
  }
  const std::string remarks = notes(input.comparison);
  return text + (text.empty() || remarks.empty() ? "" : "\n") + remarks;
}

std::string blend_csv(const NamedBlendComparison& input) {
  std::string text =
      "input,mesh,vertices,faces,targets,elements,active,rows,deltas,mean_degrees,rms_degrees,max_degrees,"
      "max_row,max_primitive,max_output,max_targets,normals,degenerate,missing\n";
  for (const BlendSubject& subject : input.comparison.subjects) {
    for (const BlendErrors& errors : subject.errors) {
      for (const BlendError& error : errors.deltas) {
        const Quality& q = error.quality;
        std::string targets;
        for (const BlendError::Weight& w : error.worst_weights)
          targets += formatted("{}{}:{}", targets.empty() ? "" : " ", target_name(subject, w.target), w.weight);
        text += formatted(
            "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", csv_field(input.name),
            subject.mesh ? formatted("{}", *subject.mesh) : "", subject.vertices, subject.faces, subject.targets.size(),
            element_kind_name(subject.kind), errors.active, errors.rows, name_of(error.deltas), in_degrees(q.mean()),
            in_degrees(q.rms()), in_degrees(q.max), q.max > 0 ? formatted("{}", q.max_at.segment) : "",
            error.worst_primitive ? formatted("{}", *error.worst_primitive) : "",
            q.max > 0 ? formatted("{}", error.worst_output) : "", csv_field(targets), q.count, q.degenerate, q.missing);
      }
    }
  }
  return text;
}

}  // namespace chronormal::cli
