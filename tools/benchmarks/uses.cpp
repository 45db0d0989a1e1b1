// Writes what answers for whole intervals cost beside samples. A run that did not measure
// them gets no such parts.

#include <fmt/core.h>

#include <algorithm>
#include <string_view>

#include "benchmarks/sections.h"

namespace chronormal::benchmarks {
namespace {

const Row* row_of(const Results& results, const std::string& group, const std::string& size, std::string_view name) {
  const auto found = std::find_if(results.rows.begin(), results.rows.end(), [&](const Row& row) {
    return row.group == group && row.size == size && row.name == name;
  });
  return found == results.rows.end() ? nullptr : &*found;
}

constexpr std::string_view kBegin = "containment, ";

// Which rows of a group a table has.
enum class Rows { kAll, kContainment, kOthers };

bool is_among(const Row& row, Rows rows) {
  return rows == Rows::kAll || row.name.starts_with(kBegin) == (rows == Rows::kContainment);
}

// The rows of a group in the order in which they were measured, and what each does.
std::string table_of(const Results& results, const std::string& group, const std::string& what,
                     Rows rows = Rows::kAll) {
  std::vector<std::string> sizes;
  std::vector<const Row*> names;
  for (const Row& row : results.rows) {
    if (row.group != group || row.order != kGrid || !is_among(row, rows)) continue;
    if (sizes.empty() || sizes.back() != row.size) sizes.push_back(row.size);
    if (sizes.size() == 1) names.push_back(&row);
  }
  Cells header = {what};
  for (const std::string& size : sizes) header.push_back(spelt(size));
  header.push_back("note");
  std::vector<Cells> table;
  for (const Row* const name : names) {
    Cells cells = {rows == Rows::kContainment ? name->name.substr(kBegin.size()) : name->name};
    for (const std::string& size : sizes) cells.push_back(cell(row_of(results, group, size, name->name)));
    cells.push_back(name->note);
    table.push_back(std::move(cells));
  }
  return aligned_table(header, table, sizes.size() + 1);
}

}  // namespace

std::string uses_part(const Results& results, const std::string& folder) {
  if (!results.knows("uses", "collapse") || !results.knows("cones") || !results.knows("certificates")) return "";
  Page part("benchmarks/uses.md.in", folder);
  part.set({{"intervals", table_of(results, "uses", "ns per face", Rows::kOthers)},
            {"cones", table_of(results, "cones", "ns per face")},
            {"certificates", table_of(results, "certificates", "ns per face")},
            {"containment", table_of(results, "uses", "ns per point", Rows::kContainment)}});
  return part.markdown();
}

}  // namespace chronormal::benchmarks
