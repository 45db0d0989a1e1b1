// Formats the result of `compare` as a table, as CSV and as LaTeX.
#include "cli/reports/compare_report.h"

#include <array>
#include <cmath>
#include <optional>
#include <string_view>

#include "chronormal/schemes/scheme.h"
#include "cli/options/command.h"
#include "cli/terminal/format.h"
#include "cli/terminal/rows.h"
#include "cli/terminal/screen.h"
#include "cli/terminal/table.h"
#include "cli/terminal/text.h"

namespace chronormal::cli {
namespace {

using Align = Table::Align;

bool is_of_targets(const Comparison& comparison) { return comparison.motion == MotionKind::kTargets; }

std::string headline(const NamedComparison& input) {
  const Comparison& c = input.comparison;
  return formatted(
             "{}: {}, {}, {} x {}\n", heading(printable(input.name)), counted(c.vertices, "vertex", "vertices"),
             counted(c.faces, "face", "faces"),
             counted(c.segments, is_of_targets(c) ? "target" : "segment", is_of_targets(c) ? "targets" : "segments"),
             counted(c.samples, "sample", "samples")) +
         (c.kind == ElementKind::kFaces
              ? std::string()
              : formatted("{} of {}{}\n", counted(c.elements, "different normal", "different normals"),
                          element_kind_name(c.kind),
                          c.weighting == Weighting::kArea
                              ? std::string()
                              : ", faces weighted by " + std::string(weighting_name(c.weighting))));
}

const char* access_name(const SchemeComparison& row) { return row.sequential ? "sequential" : "random"; }

// Round a bound away from the bounded value to four decimals, so that the printed number is a bound as well.
std::string rounded_up(double value) { return four_decimals(std::ceil(value * 1e4) / 1e4); }
std::string rounded_down(double value) { return four_decimals(std::floor(value * 1e4) / 1e4); }

// Returns lines about facts that the table does not show: elements that were treated differently or left out.
std::string notes(const Comparison& comparison, const std::string& prefix) {
  const std::size_t pairs = comparison.elements * comparison.segments;
  const std::string of = std::string(pairs == 1 ? one_element(comparison.kind) : element_kind_name(comparison.kind)) +
                         (comparison.segments == 1    ? ""
                          : is_of_targets(comparison) ? " in all targets"
                                                      : " in all segments");
  const auto share = [pairs, &of](std::size_t count) {
    return formatted("{} of {} {} ({:.2f} %)", grouped(count), grouped(pairs), of,
                     100 * static_cast<double>(count) / static_cast<double>(pairs));
  };
  std::string text, played;
  std::size_t degenerate = 0;
  for (const SchemeComparison& row : comparison.schemes) {
    if (row.sequential) played += (played.empty() ? "" : ", ") + row.scheme;
    degenerate = std::max(degenerate, row.quality.degenerate);
    const auto add = [&](std::size_t count, const std::string& what) {
      if (count > 0) text += formatted("{}{}: {}\n", prefix, row.scheme, what);
    };
    add(row.flagged, share(row.flagged) + (row.flagged == 1 ? " was" : " were") + " computed in double precision");
    add(row.fallbacks, share(row.fallbacks) + " used another scheme, since " + row.scheme + " is undefined there");
    if (row.certified)
      add(row.certified->unbounded, share(row.certified->unbounded) +
                                        (row.certified->unbounded == 1 ? " has" : " have") +
                                        " no bound, since a normal vanishes between the ends of the segment");
    add(row.quality.missing,
        counted(row.quality.missing, "sample was", "samples were") + " left out, since the scheme has no normal there");
  }
  if (!played.empty())
    text += formatted("{}computed step by step, each moment from the one before: {}\n", prefix, played);
  if (degenerate > 0)
    text += formatted("{}{} left out, since faces without area have no normal\n", prefix,
                      counted(degenerate, "sample was", "samples were"));
  if (comparison.tolerance && comparison.cheapest) {
    const SchemeComparison& row = comparison.schemes[*comparison.cheapest];
    text += formatted("{}the cheapest scheme that is always within {} is {}, with an error of at most {}\n", prefix,
                      with_degrees(with_digits(*comparison.tolerance, 6)), row.scheme,
                      with_degrees(rounded_up(in_degrees(row.certified->upper))));
  } else if (comparison.tolerance) {
    text += formatted("{}no scheme is always within {}\n", prefix, with_degrees(with_digits(*comparison.tolerance, 6)));
  }
  return text;
}

std::string segment_cell(const NamedComparison& input, std::size_t segment) {
  constexpr std::size_t kLongest = 24;
  return segment < input.targets.size() ? printable(target_label(input.targets, segment), kLongest) : grouped(segment);
}

// A column of the paper's Table 2, which counts operations.
struct OperationColumn {
  int OperationCounts::*count;
  const char* short_name;  // name in the table for people
  const char* latex;
};

constexpr std::array<OperationColumn, 5> kOperations = {{
    {&OperationCounts::add, "add", "$+$"},
    {&OperationCounts::multiply, "mul", "$\\times$"},
    {&OperationCounts::divide, "div", "$\\div$"},
    {&OperationCounts::sqrt, "sqrt", "$\\surd$"},
    {&OperationCounts::trigonometric, "trig", "trig"},
}};

// Writes a text in LaTeX with only characters that need no LaTeX package.
std::string latex_text(const std::string& text) {
  std::string result;
  for (const char c : printable(text)) {
    const auto code = static_cast<unsigned char>(c);
    if (code >= 0xC0 || code == '?') {
      // A character that takes several bytes in UTF-8 becomes one question mark. This byte is the first byte of such a
      // character.
      result += '?';
    } else if (code >= 0x80 || code < 0x20) {
      continue;
    } else if (std::string_view("{}$&#%_").find(c) != std::string_view::npos) {
      result += {'\\', c};
    } else if (std::string_view("\\^~<>|\"").find(c) != std::string_view::npos) {
      // Without the braces, a digit that follows would become a part of the number.
      result += formatted("{{\\ttfamily\\char{}}}", code);
    } else {
      result += c;
    }
  }
  return result;
}

// Returns the name of a scheme in the tables of the paper, or the scheme's own name if it is not in the paper.
std::string latex_scheme(const std::string& scheme) {
  struct Row {
    std::string_view scheme, name;
  };
  constexpr std::array<Row, 7> kRows = {{{"linear", "Linear"},
                                         {"quadratic", "Quadratic"},
                                         {"cubic", "Cubic"},
                                         {"polynomial", "$t$-variant cross product"},
                                         {"slerp", "Vector SLERP"},
                                         {"decasteljau:4", "Spherical deCasteljau"},
                                         {"quaternion:matrix", "Quaternion SLERP"}}};
  for (const Row& row : kRows)
    if (row.scheme == scheme) return std::string(row.name);
  return "\\texttt{" + latex_text(scheme) + "}";
}

// Returns a LaTeX table with its caption. `columns` is the preamble of the tabular, and rows end with \\\\.
std::string latex_table(const std::string& columns, const std::string& rows, const std::string& caption,
                        const char* label) {
  return formatted(
      "\\begin{{table}}\n\\centering\n\\begin{{tabular}}{{{}}}\n\\hline\n{}\\hline\n\\end{{tabular}}\n"
      "\\caption{{{}}}\n\\label{{{}}}\n\\end{{table}}\n",
      columns, rows, caption, label);
}

std::string ratio_cell(const std::optional<double>& ratio) { return ratio ? four_decimals(*ratio) : "-"; }

}  // namespace

std::string csv_field(const std::string& field) {
  std::string text = printable(field);
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

std::string compare_table(const NamedComparison& input, TableColumns columns) {
  Table table;
  table.add_column("scheme", "", Align::kLeft);
  table.add_column("sum", "degrees", Align::kRight);
  table.add_column("vs linear", "ratio", Align::kRight);
  table.add_column("average", "degrees", Align::kRight);
  table.add_column("rms", "degrees", Align::kRight);
  table.add_column("worst", "degrees", Align::kRight);
  const bool several_segments = input.comparison.segments > 1;
  if (several_segments && is_of_targets(input.comparison))
    table.add_column("worst at", "target", Align::kLeft);
  else if (several_segments)
    table.add_column("worst at", "segment", Align::kRight);
  const std::string element(one_element(input.comparison.kind));
  table.add_column(several_segments ? "" : "worst at", element, Align::kRight);
  table.add_column("", is_of_targets(input.comparison) ? "weight" : "t", Align::kRight);
  const bool certified = input.comparison.schemes.front().certified.has_value();
  if (certified) {
    table.add_column("largest error", "at least", Align::kRight);
    table.add_column("", "at most", Align::kRight);
  }
  table.add_column("memory", "B/" + element, Align::kRight);
  if (columns.operations) {
    table.add_column("operations", kOperations[0].short_name, Align::kRight);
    for (std::size_t i = 1; i < kOperations.size(); ++i) table.add_column("", kOperations[i].short_name, Align::kRight);
  }
  if (columns.times) {
    table.add_column("prepare", "ns/" + element, Align::kRight);
    table.add_column("evaluate", "ns/" + element, Align::kRight);
  }

  for (const SchemeComparison& row : input.comparison.schemes) {
    const Quality& q = row.quality;
    std::vector<std::string> cells = {row.scheme,
                                      grouped_sum(in_degrees(q.sum)),
                                      ratio_cell(row.relative_to_linear),
                                      four_decimals(in_degrees(q.mean())),
                                      four_decimals(in_degrees(q.rms())),
                                      four_decimals(in_degrees(q.max))};
    if (several_segments) cells.push_back(q.max > 0 ? segment_cell(input, q.max_at.segment) : "-");
    cells.push_back(q.max > 0 ? grouped(q.max_at.element) : "-");
    cells.push_back(q.max > 0 ? formatted("{:.2f}", q.max_at.t) : "-");
    if (certified) {
      cells.push_back(rounded_down(in_degrees(row.certified->lower)));
      cells.push_back(rounded_up(in_degrees(row.certified->upper)));
    }
    cells.push_back(formatted("{:.0f}", row.bytes));
    for (std::size_t i = 0; columns.operations && i < kOperations.size(); ++i)
      cells.push_back(grouped(static_cast<std::size_t>(row.operations.*kOperations[i].count)));
    if (columns.times) {
      cells.push_back(formatted("{:.0f}", row.prepare_ns));
      cells.push_back(formatted("{:.1f}", row.evaluate_ns));
    }
    table.add_row(std::move(cells));
  }
  const std::string remarks = notes(input.comparison, "");
  return headline(input) + '\n' + table.text() + (remarks.empty() ? "" : "\n" + remarks);
}

std::string compare_tables_side_by_side(const std::vector<NamedComparison>& inputs) {
  std::string text;
  for (const NamedComparison& input : inputs) text += headline(input);
  Table table;
  table.add_column("scheme", "", Align::kLeft);
  for (const NamedComparison& input : inputs) {
    table.add_column(printable(short_name(input.name)), "sum, degrees", Align::kRight);
    table.add_column("", "vs linear", Align::kRight);
    if (input.comparison.schemes.front().certified) table.add_column("", "at most", Align::kRight);
  }
  const std::size_t rows = inputs.front().comparison.schemes.size();
  for (std::size_t r = 0; r < rows; ++r) {
    std::vector<std::string> cells = {inputs.front().comparison.schemes[r].scheme};
    for (const NamedComparison& input : inputs) {
      const SchemeComparison& row = input.comparison.schemes[r];
      cells.push_back(grouped_sum(in_degrees(row.quality.sum)));
      cells.push_back(ratio_cell(row.relative_to_linear));
      if (row.certified) cells.push_back(rounded_up(in_degrees(row.certified->upper)));
    }
    table.add_row(std::move(cells));
  }
  std::string remarks;
  for (const NamedComparison& input : inputs)
    remarks += notes(input.comparison, printable(short_name(input.name)) + ": ");
  return text + '\n' + table.text() + (remarks.empty() ? "" : "\n" + remarks);
}

std::string compare_latex(const std::vector<NamedComparison>& inputs) {
  const Comparison& first = inputs.front().comparison;
  const std::string elements(element_kind_name(first.kind));
  std::string columns = "l", names, titles, rows;
  for (const NamedComparison& input : inputs) {
    columns += "rr";
    names += formatted(" & \\multicolumn{{2}}{{r}}{{{}}}", latex_text(short_name(input.name)));
    titles += " & sum & ratio";
  }
  for (std::size_t r = 0; r < first.schemes.size(); ++r) {
    rows += latex_scheme(first.schemes[r].scheme);
    for (const NamedComparison& input : inputs) {
      const SchemeComparison& row = input.comparison.schemes[r];
      rows += formatted(" & {} & {}", grouped_sum(in_degrees(row.quality.sum)), ratio_cell(row.relative_to_linear));
    }
    rows += " \\\\\n";
  }
  std::string counts;
  for (const NamedComparison& input : inputs)
    counts += formatted("{}{} with {} in {}", counts.empty() ? "" : ", ", latex_text(short_name(input.name)),
                        grouped(input.comparison.elements), counted(input.comparison.segments, "segment", "segments"));
  std::string text = latex_table(
      columns, names + " \\\\\n" + titles + " \\\\\n\\hline\n" + rows,
      formatted("Sums of the angles in degrees between interpolated and exact normals of {}, over {} of each "
                "segment, and their ratios to linear ({}).",
                elements, counted(first.samples, "sample", "samples"), counts),
      "tab:quality");

  columns = "l";
  titles.clear();
  rows.clear();
  for (int access = 0; access < 2; ++access) {
    columns += "rrrrr";
    for (const OperationColumn& operation : kOperations) titles += std::string(" & ") + operation.latex;
  }
  for (const SchemeComparison& row : first.schemes) {
    const auto scheme = make_scheme(row.scheme).value();
    rows += latex_scheme(row.scheme);
    for (const std::optional<OperationCounts>& counts_of :
         {std::optional(scheme->operations()), scheme->sequential_operations()})
      for (const OperationColumn& operation : kOperations)
        rows += counts_of ? formatted(" & {}", (*counts_of).*operation.count) : std::string(" & --");
    rows += formatted(" & {:.0f} \\\\\n", row.bytes);
  }
  return text + '\n' +
         latex_table(
             columns + "r",
             " & \\multicolumn{5}{c}{random access} & \\multicolumn{5}{c}{sequential access} & \\\\\n" + titles +
                 " & bytes \\\\\n\\hline\n" + rows,
             formatted("Elementary operations of an evaluation for one of the {0} at one time, and the bytes that "
                       "it reads. Operations that all {0} share at one time are not counted, and a sine with "
                       "its cosine is one trigonometric operation.",
                       elements),
             "tab:cost");
}

std::string compare_csv(const std::vector<NamedComparison>& inputs, bool with_times) {
  std::string text =
      "input,vertices,faces,segments,elements,samples,scheme,sum_degrees,relative_to_linear,mean_degrees,rms_degrees,"
      "max_degrees,max_segment,max_element,max_t,degenerate,missing,fallbacks,flagged,";
  if (with_times) text += "prepare_ns,evaluate_ns,";
  text += "bytes,access,add,multiply,divide,sqrt,trigonometric";
  const bool certified = inputs.front().comparison.schemes.front().certified.has_value();
  if (certified)
    text +=
        ",certified_lower_degrees,certified_upper_degrees,certified_segment,certified_element,certified_from,"
        "certified_to,unbounded";
  const bool is_curved = inputs.front().comparison.cut.has_value();
  if (is_curved) text += ",path,bend";
  text += '\n';
  for (const NamedComparison& input : inputs) {
    const Comparison& c = input.comparison;
    for (const SchemeComparison& row : c.schemes) {
      const Quality& q = row.quality;
      text += formatted("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},", csv_field(input.name), c.vertices,
                        c.faces, c.segments, element_kind_name(c.kind), c.samples, csv_field(row.scheme),
                        in_degrees(q.sum), row.relative_to_linear ? formatted("{}", *row.relative_to_linear) : "",
                        in_degrees(q.mean()), in_degrees(q.rms()), in_degrees(q.max), q.max_at.segment,
                        q.max_at.element, q.max_at.t, q.degenerate, q.missing, row.fallbacks, row.flagged);
      if (with_times) text += formatted("{},{},", row.prepare_ns, row.evaluate_ns);
      const OperationCounts& o = row.operations;
      text += formatted("{},{},{},{},{},{},{}", row.bytes, access_name(row), o.add, o.multiply, o.divide, o.sqrt,
                        o.trigonometric);
      if (row.certified) {
        const CertifiedError& e = *row.certified;
        text += formatted(",{},{},{},{},{},{},{}", in_degrees(e.lower), in_degrees(e.upper), e.segment, e.element,
                          e.from, e.to, e.unbounded);
      }
      if (is_curved && c.cut) text += formatted(",{},{}", path_name(c.cut->path.kind), c.cut->bend);
      text += '\n';
    }
  }
  return text;
}

}  // namespace chronormal::cli
