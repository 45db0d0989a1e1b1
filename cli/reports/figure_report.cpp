#include "cli/reports/figure_report.h"

#include <algorithm>
#include <cmath>

#include "cli/terminal/format.h"
#include "cli/terminal/screen.h"
#include "cli/terminal/table.h"
#include "cli/terminal/text.h"

namespace chronormal::cli {
namespace {

using Align = Table::Align;

// Formats a component of a vector; a value that rounds to zero has no sign.
std::string component(double value) { return formatted("{:8.4f}", std::fabs(value) < 5e-5 ? 0 : value); }

std::string shortest(const std::vector<double>& lengths) {
  return lengths.empty() ? "1" : formatted("{:.4g}", *std::min_element(lengths.begin(), lengths.end()));
}

// Formats the tangent, binormal and normal of a scheme at one sample as the columns of a matrix.
std::string frame_text(const char* name, const SchemeFigure& scheme, std::size_t sample) {
  const Vec3d n = scheme.normals[sample], t = scheme.tangents[sample], b = cross(n, t);
  const double rows[3][3] = {{t.x, b.x, n.x}, {t.y, b.y, n.y}, {t.z, b.z, n.z}};
  std::string text;
  for (std::size_t row = 0; row < 3; ++row)
    text += formatted("  {:<4} {} {} {}\n", row == 0 ? name : "", component(rows[row][0]), component(rows[row][1]),
                      component(rows[row][2]));
  return text;
}

}  // namespace

std::string figure_table(const std::string& input, const FaceFigure& figure) {
  std::string text = formatted("{}: face {} in segment {}, {}\n\n", heading(printable(input)), grouped(figure.face),
                               grouped(figure.segment), counted(figure.times.size(), "sample", "samples"));
  Table table;
  table.add_column("scheme", "", Align::kLeft);
  for (const char* title : {"sum", "max"}) table.add_column(title, "degrees", Align::kRight);
  table.add_column("at", "t", Align::kRight);
  table.add_column("shortest", "length", Align::kRight);
  for (const SchemeFigure& scheme : figure.schemes) {
    std::size_t worst = 0;
    for (std::size_t i = 0; i < scheme.angles.size(); ++i) {
      if (!(scheme.angles[i] <= scheme.angles[worst])) worst = std::isnan(scheme.angles[i]) ? worst : i;
    }
    const double degrees = scheme.angles[worst] * kDegreesPerRadian;
    table.add_row({scheme.scheme, grouped_sum(scheme.sum * kDegreesPerRadian),
                   std::isnan(degrees) ? "-" : four_decimals(degrees), formatted("{:.2f}", figure.times[worst]),
                   shortest(scheme.lengths)});
  }
  text += table.text();
  if (figure.matrix) {
    text += "\nThe matrix M, which moves the face and its unit normal from t = 0 to t = 1:\n";
    for (const auto& row : *figure.matrix)
      text +=
          formatted("       {} {} {} {}\n", component(row[0]), component(row[1]), component(row[2]), component(row[3]));
  }
  for (const SchemeFigure& scheme : figure.schemes) {
    if (scheme.tangents.empty()) continue;
    text += formatted("\n{}: tangent, binormal and normal at both ends:\n", scheme.scheme);
    text += frame_text("F0", scheme, 0) + frame_text("F1", scheme, figure.times.size() - 1);
  }
  return text;
}

}  // namespace chronormal::cli
