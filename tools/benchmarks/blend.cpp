// What normals of blend shapes cost, where a run measured them.

#include <fmt/core.h>

#include <algorithm>

#include "benchmarks/sections.h"

namespace chronormal::benchmarks {

namespace {

// A row for each number of active targets that was measured.
std::string table_of(const Results& results, const std::string& group, const std::string& size,
                     const std::vector<std::string>& actives, const std::string& targets) {
  const auto find = [&](const std::string& active, const std::string& way) {
    return results.find(group, size, kGrid, blend_row(active, way, targets));
  };
  std::vector<std::string> ways;
  for (const std::string& way : blend_ways()) {
    if (find(actives.front(), way) != nullptr) ways.push_back(way);
  }
  const std::string rival =
      find(actives.front(), "recompute in float32") != nullptr ? "recompute in float32" : "recompute";
  Cells header = {fmt::format("active of {}, {} vertices", targets, spelt(size))};
  header.insert(header.end(), ways.begin(), ways.end());
  header.push_back("chosen: times " + rival);
  std::vector<Cells> rows;
  for (const std::string& active : actives) {
    if (find(active, "chosen") == nullptr) continue;
    Cells cells = {active};
    for (const std::string& way : ways) cells.push_back(cell(find(active, way)));
    cells.push_back(fmt::format("{:.1f}", find(active, rival)->ns / find(active, "chosen")->ns));
    rows.push_back(std::move(cells));
  }
  return aligned_table(header, rows);
}

}  // namespace

std::string blend_part(const Results& results, const std::string& folder) {
  std::string tables;
  for (const std::string& size : blend_sizes(results)) {
    if (!tables.empty()) tables += '\n';
    tables += table_of(results, "blend", size, blend_actives(), "100");
    if (results.knows("dense blend"))
      tables += '\n' + table_of(results, "dense blend", size, dense_actives(), dense_actives().back());
  }
  if (tables.empty()) return "";
  Page part("benchmarks/blend.md.in", folder);
  part.set("by_size", tables);
  return part.markdown();
}

}  // namespace chronormal::benchmarks
