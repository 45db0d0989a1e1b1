// What everything costs, in tables and against the size of the mesh; and what the memory does.

#include <fmt/core.h>

#include <algorithm>

#include "benchmarks/sections.h"

namespace chronormal::benchmarks {
namespace {

void add_group(Page& page, const Results& results, const std::string& group) {
  Cells header = {fmt::format("ns per {}", group == "faces" ? "face" : "vertex")};
  for (const Column& column : columns()) header.push_back(column.title);
  std::vector<Cells> rows;
  const auto add_row = [&](const std::string& name, bool many_threads) {
    if (name == "recompute in float32" && !results.knows(group, name)) return;
    Cells cells = {name};
    for (const Column& column : columns()) {
      const Row* const row = results.find(group, column.size, column.order, name, many_threads);
      if (row != nullptr) cells[0] = row->name;
      cells.push_back(cell(row));
    }
    rows.push_back(std::move(cells));
  };
  for (const std::string& name : rivals_of(group)) add_row(name, false);
  add_row("interpolate positions", false);
  for (const std::string& name : ours()) add_row(name, false);
  if (std::any_of(results.rows.begin(), results.rows.end(), [](const Row& row) { return row.threads > 1; })) {
    for (const std::string& name : threaded()) add_row(name, true);
  }
  page.table(group, header, rows);
}

struct Curve {
  const char* title;
  std::vector<std::string> names;  // of faces, of vertices
  Colour colour;
  Mark mark;
};

Panel size_panel(const Results& results, const std::string& group, std::size_t which) {
  static const std::vector<Curve> curves = {
      {"VTK", {"VTK vtkPolyDataNormals", "VTK vtkTriangleMeshPointNormals"}, Colour::kPurple, Mark::kTriangle},
      {"CGAL", {"CGAL compute_face_normals", "CGAL compute_vertex_normals"}, Colour::kOrange, Mark::kOpenSquare},
      {"OpenMesh",
       {"OpenMesh update_face_normals", "OpenMesh calc_vertex_normal_correct"},
       Colour::kSky,
       Mark::kOpenDiamond},
      {"Eigen loop", {"Eigen loop", "Eigen loop"}, Colour::kGrey, Mark::kCross},
      {"plain C++ loop", {"plain C++ loop", "plain C++ loop"}, Colour::kBlack, Mark::kOpenTriangle},
      {"recompute", {"recompute", "recompute"}, Colour::kRed, Mark::kSquare},
      {"in float32", {"recompute in float32", "recompute in float32"}, Colour::kRed, Mark::kCircle},
      {"exact", {"exact to float3", "exact to float3"}, Colour::kBlue, Mark::kDisc},
      {"compact", {"compact to float3", "compact to float3"}, Colour::kGreen, Mark::kDiamond}};
  Panel panel;
  panel.title = group;
  panel.x = {"elements", 1e4, 2e7, true, {{15e3, "15 k"}, {45e3, "45 k"}, {1e6, "1 M"}, {1e7, "10 M"}}};
  panel.y = {fmt::format("ns per {}", group == "faces" ? "face" : "vertex"),
             0.1,
             20000,
             true,
             {{0.1, "0.1"}, {1, "1"}, {10, "10"}, {100, "100"}, {1000, "1000"}, {10000, "10000"}}};
  panel.legend = "top left maxrows 4";
  for (const Curve& curve : curves) {
    if (results.find(group, "15k", kGrid, curve.names[which]) == nullptr) continue;
    Series in_order{curve.title, {}, curve.colour, 2, false, curve.mark};
    for (const Column& column : columns()) {
      const Row* const row = results.find(group, column.size, column.order, curve.names[which]);
      if (row == nullptr) continue;
      if (column.order == kGrid) in_order.points.emplace_back(row->elements, row->ns);
    }
    const Row* const grid = results.find(group, "10M", kGrid, curve.names[which]);
    const Row* const shuffled = results.find(group, "10M", kShuffled, curve.names[which]);
    panel.series.push_back(in_order);
    if (grid != nullptr && shuffled != nullptr)
      panel.series.push_back({"",
                              {{grid->elements, grid->ns}, {1.4 * grid->elements, shuffled->ns}},
                              curve.colour,
                              1.5,
                              true,
                              curve.mark});
  }
  return panel;
}

}  // namespace

std::string nanoseconds(double ns) {
  return ns < 1 ? fmt::format("{:.3f}", ns) : ns < 10 ? fmt::format("{:.2f}", ns) : fmt::format("{:.0f}", ns);
}

std::string cell(const Row* row) {
  return row == nullptr ? "-" : fmt::format("{} ±{:.0f}", nanoseconds(row->ns), 100 * row->spread);
}

std::string emphasised(const std::string& text, bool good) { return good ? "**" + text + "**" : text; }

void add_costs(Page& page, const Results& results) {
  for (const char* group : {"faces", "vertices"}) add_group(page, results, group);
  Figure figure{fmt::format("benchmarks_{}_size", results.name), 1000, 480, 2, {}};
  figure.panels = {size_panel(results, "faces", 0), size_panel(results, "vertices", 1)};
  page.picture("sizes", figure);
  std::vector<double> spreads;
  for (const Row& row : results.rows) spreads.push_back(row.spread);
  page.set({{"spread_median", percent(quantile(spreads, 0.5), 1)}, {"spread_90", percent(quantile(spreads, 0.9), 1)}});
}

void add_memory(Page& page, const Results& results) {
  std::vector<Cells> rows;
  for (const Bandwidth& one : results.bandwidths) {
    const double kib = one.bytes / 1024;
    rows.push_back({kib < 10240 ? fmt::format("{} KiB", grouped(kib)) : fmt::format("{} MiB", grouped(kib / 1024)),
                    fmt::format("{:.1f}", one.read), fmt::format("{:.1f}", one.stream),
                    fmt::format("{:.1f}", one.copy)});
  }
  page.table("bandwidths", {"working set", "read, GB/s", "stream, GB/s", "of that copy"}, rows);
}

}  // namespace chronormal::benchmarks
