#include "cli/reports/truth_report.h"

#include <algorithm>

#include "cli/reports/compare_report.h"
#include "cli/terminal/format.h"
#include "cli/terminal/rows.h"
#include "cli/terminal/screen.h"
#include "cli/terminal/table.h"
#include "cli/terminal/text.h"

namespace chronormal::cli {
namespace {

using Align = Table::Align;

const TruthRow* find_row(const TruthComparison& comparison, const std::string& path, const std::string& scheme) {
  const auto found = std::find_if(comparison.rows.begin(), comparison.rows.end(),
                                  [&](const TruthRow& row) { return row.path == path && row.scheme == scheme; });
  return found == comparison.rows.end() ? nullptr : &*found;
}

std::string mean_of(const TruthRow& row) { return four_decimals(in_degrees(row.quality.mean())); }

std::string remarks(const TruthComparison& c) {
  constexpr double kAsGood = 0.98;
  std::string text;
  const TruthRow* const linear = find_row(c, "linear", "linear");
  const TruthRow* const exact = find_row(c, "linear", "polynomial");
  const TruthRow* const curved = find_row(c, "catmull-rom", "exact");
  if (linear != nullptr && exact != nullptr && exact->quality.mean() > kAsGood * linear->quality.mean())
    text += formatted(
        "\nExact normals of straight motion (polynomial) are {} to this motion than linear ones: their errors are {} "
        "and\n{} degrees on average. The vertices did not move straight between the keyframes that were kept.\n",
        exact->quality.mean() < linear->quality.mean() ? "hardly closer" : "not closer", mean_of(*exact),
        mean_of(*linear));
  if (is_too_sparse(c.bend))
    text += formatted(
        "\nThe keyframes are too far apart for curves through them, which bend by {:.2f} of their length (at most "
        "{:.2f} is\nreliable). Add keyframes; no scheme can make up for them.\n",
        up_to_hundredths(c.bend), kTooSparse);
  if (curved == nullptr)
    text += find_row(c, "hermite", "exact") == nullptr
                ? "\nCurved paths are not compared, since they need at least three keyframes.\n"
                : "\nThe path catmull-rom is not compared, since it needs at least three keyframes.\n";
  std::size_t degenerate = 0;
  for (const TruthRow& row : c.rows) degenerate = std::max(degenerate, row.quality.degenerate);
  if (degenerate > 0)
    text += formatted("\n{} left out, since faces without area have no normal\n",
                      counted(degenerate, "sample was", "samples were"));
  return text;
}

}  // namespace

std::string truth_table(const NamedTruthComparison& input) {
  const TruthComparison& c = input.comparison;
  std::string text =
      formatted("{}: {}, {}; {} kept and compared with the {} left out\n", heading(printable(input.name)),
                counted(c.vertices, "vertex", "vertices"), counted(c.faces, "face", "faces"),
                counted(c.kept, "keyframe was", "keyframes were"), counted(c.left_out, "that was", "that were"));
  if (c.kind != ElementKind::kFaces)
    text += formatted("{} of {}\n", counted(c.elements, "different normal", "different normals"),
                      element_kind_name(c.kind));
  Table table;
  const std::string element(one_element(c.kind));
  table.add_column("path", "", Align::kLeft);
  table.add_column("scheme", "", Align::kLeft);
  for (const char* title : {"average", "rms", "worst"}) table.add_column(title, "degrees", Align::kRight);
  table.add_column("worst at", "segment", Align::kRight);
  table.add_column("", element, Align::kRight);
  table.add_column("", "t", Align::kRight);
  for (const TruthRow& row : c.rows) {
    const Quality& q = row.quality;
    const bool has_worst = q.max > 0;
    table.add_row({row.path, row.scheme, mean_of(row), four_decimals(in_degrees(q.rms())),
                   four_decimals(in_degrees(q.max)), has_worst ? grouped(q.max_at.segment) : "-",
                   has_worst ? grouped(q.max_at.element) : "-", has_worst ? formatted("{:.2f}", q.max_at.t) : "-"});
  }
  return text + '\n' + table.text() + remarks(c);
}

std::string truth_csv(const NamedTruthComparison& input) {
  const TruthComparison& c = input.comparison;
  std::string text =
      "input,vertices,faces,elements,kept,left_out,bend,path,scheme,mean_degrees,rms_degrees,max_degrees,max_segment,"
      "max_element,max_t,degenerate,missing\n";
  for (const TruthRow& row : c.rows) {
    const Quality& q = row.quality;
    text += formatted("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", csv_field(input.name), c.vertices,
                      c.faces, element_kind_name(c.kind), c.kept, c.left_out, c.bend, row.path, csv_field(row.scheme),
                      in_degrees(q.mean()), in_degrees(q.rms()), in_degrees(q.max), q.max_at.segment, q.max_at.element,
                      q.max_at.t, q.degenerate, q.missing);
  }
  return text;
}

}  // namespace chronormal::cli
