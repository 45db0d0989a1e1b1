#include "cli/reports/report_report.h"

#include <algorithm>

#include "cli/reports/audit/audit_words.h"
#include "cli/terminal/format.h"
#include "cli/terminal/rows.h"
#include "cli/terminal/screen.h"
#include "cli/terminal/table.h"
#include "cli/terminal/text.h"

namespace chronormal::cli {
namespace {

using Align = Table::Align;

constexpr std::size_t kMostPlaces = 5;

std::string parts_table(const Report& report) {
  Table table;
  table.add_column("mesh", "", Align::kLeft);
  for (const char* title : {"vertices", "triangles", "motions", "samples"}) table.add_column(title, "", Align::kRight);
  for (const ReportPart& part : report.parts)
    table.add_row({part.name.empty() ? "-" : printable(part.name, kLongestName), grouped(part.vertices),
                   grouped(part.triangles), grouped(part.motions), grouped(part.samples)});
  return table.text();
}

std::string places_table(const Report& report) {
  if (report.worst.empty()) return formatted("no error is larger than {} degrees\n", kLeastPlace);
  Table table;
  table.add_column("worst place", "", Align::kLeft);
  table.add_column("at", "", Align::kLeft);
  table.add_column("error", "degrees", Align::kRight);
  for (std::size_t i = 0; i < std::min(kMostPlaces, report.worst.size()); ++i) {
    const ReportPlace& place = report.worst[i];
    table.add_row({place.label, printable(place.moment, kLongestName), judged_degrees(place.degrees)});
  }
  return table.text();
}

}  // namespace

std::string report_text(const Report& report, const std::string& output, std::size_t bytes) {
  std::string text = formatted("{} -> {}, {}\n\n", heading(printable(report.input)), heading(printable(output)),
                               counted(bytes, "byte", "bytes"));
  text += parts_table(report) + '\n' + places_table(report);
  if (!report.plan_message.empty())
    text += formatted("\nthe page does not show what bake could do: {}\n", printable(report.plan_message));
  if (!report.thinned.empty()) text += "\nto keep the page small, this was left out:\n";
  for (const std::string& sentence : report.thinned) text += formatted("  {}\n", sentence);
  return text;
}

}  // namespace chronormal::cli
