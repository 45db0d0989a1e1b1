// What normals of blend shapes cost, where a run measured them.

#include <fmt/core.h>

#include <algorithm>

#include "benchmarks/sections.h"

namespace chronormal::benchmarks {

std::string blend_part(const Results& results, const std::string& folder) {
  std::string tables;
  for (const std::string& size : blend_sizes(results)) {
    Cells header = {fmt::format("active, {} vertices", spelt(size))};
    for (const std::string& way : blend_ways()) header.push_back(way);
    header.emplace_back("chosen: times recompute");
    std::vector<Cells> rows;
    for (const std::string& active : blend_actives()) {
      const auto row_of = [&](const std::string& way) {
        return results.find("blend", size, kGrid, blend_row(active, way));
      };
      Cells cells = {active};
      for (const std::string& way : blend_ways()) cells.push_back(cell(row_of(way)));
      cells.push_back(fmt::format("{:.1f}", row_of("recompute")->ns / row_of("chosen")->ns));
      rows.push_back(std::move(cells));
    }
    if (!tables.empty()) tables += '\n';
    tables += aligned_table(header, rows);
  }
  if (tables.empty()) return "";
  Page part("benchmarks/blend.md.in", folder);
  part.set("by_size", tables);
  return part.markdown();
}

}  // namespace chronormal::benchmarks
