// What normals of blend shapes cost, where a run measured them.

#include <fmt/core.h>

#include <algorithm>

#include "benchmarks/sections.h"

namespace chronormal::benchmarks {
namespace {

const Row& row_of(const Results& results, const std::string& size, const std::string& active, const std::string& way) {
  return *results.find("blend", size, kGrid, blend_row(active, way));
}

}  // namespace

void write_blend(Page& page, const Results& results) {
  const std::vector<std::string> sizes = blend_sizes(results);
  if (sizes.empty()) return;
  page.subheading("Blend shapes");
  page.text(
      "Vertices under 100 targets that each move a fortieth of the grid, half of them around the same few places, at "
      "weights of which some are not zero: nanoseconds per vertex of the whole mesh, for one weight vector. *Chosen* "
      "is what `BlendNormals` does: the terms of the active targets, or where these are many, positions and normals "
      "anew, of the touched part or of the whole mesh; the next two columns are made to take the one way or the "
      "other. "
      "All three are exact to 1e-6 rad. *Recompute* and the plain loop blend float32 positions and compute the normals "
      "of the whole mesh. The *linear sum* is what engines do, a normal delta for each target: it is not exact, "
      "whatever it costs.");
  for (const std::string& size : sizes) {
    std::vector<std::string> header = {fmt::format("active, {} vertices", spelt(size))};
    for (const std::string& way : blend_ways()) header.push_back(way);
    header.emplace_back("chosen: times recompute");
    std::vector<std::vector<std::string>> rows;
    for (const std::string& active : blend_actives()) {
      std::vector<std::string> cells = {active};
      for (const std::string& way : blend_ways()) {
        const Row& row = row_of(results, size, active, way);
        cells.push_back(fmt::format("{} ±{:.0f}", nanoseconds(row.ns), 100 * row.spread));
      }
      cells.push_back(fmt::format(
          "{:.1f}", row_of(results, size, active, "recompute").ns / row_of(results, size, active, "chosen").ns));
      rows.push_back(std::move(cells));
    }
    page.table(header, rows);
  }
}

}  // namespace chronormal::benchmarks
