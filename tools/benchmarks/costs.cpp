// What everything costs, in tables and against the size of the mesh; and what the memory does.

#include <fmt/core.h>

#include <algorithm>

#include "benchmarks/sections.h"

namespace chronormal::benchmarks {
namespace {

std::string cell(const Row* row) {
  return row == nullptr ? "-" : fmt::format("{} ±{:.0f}", nanoseconds(row->ns), 100 * row->spread);
}

std::vector<std::string> header(const std::string& first) {
  std::vector<std::string> titles = {first};
  for (const Column& column : columns()) titles.push_back(column.title);
  return titles;
}

std::vector<std::string> table_row(const Results& results, const std::string& group, const std::string& name,
                                   bool many_threads) {
  std::vector<std::string> cells = {name};
  std::string note;
  for (const Column& column : columns()) {
    const Row* const row = results.find(group, column.size, column.order, name, many_threads);
    if (row != nullptr) cells[0] = row->name;
    cells.push_back(cell(row));
  }
  return cells;
}

void write_group(Page& page, const Results& results, const std::string& group) {
  page.subheading(group == "faces" ? "Faces" : "Vertices");
  std::vector<std::vector<std::string>> rows;
  for (const std::string& name : rivals_of(group)) rows.push_back(table_row(results, group, name, false));
  rows.push_back(table_row(results, group, "interpolate positions", false));
  for (const std::string& name : ours()) rows.push_back(table_row(results, group, name, false));
  for (const std::string& name : threaded()) {
    if (std::any_of(results.rows.begin(), results.rows.end(), [](const Row& row) { return row.threads > 1; }))
      rows.push_back(table_row(results, group, name, true));
  }
  page.table(header(fmt::format("ns per {}", group == "faces" ? "face" : "vertex")), rows);
  if (group == "vertices") {
    page.text(
        "CGAL's is another normal than a sum ([weightings](weightings.md#1-rules)), OpenMesh's `update_normals` and "
        "`vtkPolyDataNormals` give every face the same weight, and all others weigh by area. OpenMesh's "
        "`update_vertex_normals` is given the unit normals of faces. CGAL is left out where it takes minutes.");
  }
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

void write_costs(Page& page, const Results& results) {
  for (const char* group : {"faces", "vertices"}) write_group(page, results, group);
  Figure figure{fmt::format("benchmarks_{}_size", results.name), 1000, 480, 2, {}};
  figure.panels = {size_panel(results, "faces", 0), size_panel(results, "vertices", 1)};
  page.picture(figure,
               "Nanoseconds per element against the number of elements, on logarithmic axes, for faces and for "
               "vertices; dashed to the shuffled mesh");
  std::vector<double> spreads;
  for (const Row& row : results.rows) spreads.push_back(row.spread);
  page.text(fmt::format(
      "Dashed lines lead to the shuffled mesh of the same size. The distance between the quartiles is {} of the "
      "median for half of all rows, and at most {} for nine of ten.",
      percent(quantile(spreads, 0.5), 1), percent(quantile(spreads, 0.9), 1)));
}

void write_memory(Page& page, const Results& results) {
  page.subheading("Memory");
  page.text(
      "Bandwidth of one thread at the working sets of the rows above, the best of several ways: reading (with and "
      "without prefetch), and streaming (copy and triad, with ordinary stores, with those past the caches, and with "
      "prefetch; all bytes count).");
  std::vector<std::vector<std::string>> rows;
  for (const Bandwidth& one : results.bandwidths) {
    const double kib = one.bytes / 1024;
    rows.push_back({kib < 10240 ? fmt::format("{} KiB", grouped(kib)) : fmt::format("{} MiB", grouped(kib / 1024)),
                    fmt::format("{:.1f}", one.read), fmt::format("{:.1f}", one.stream),
                    fmt::format("{:.1f}", one.copy)});
  }
  page.table({"working set", "read, GB/s", "stream, GB/s", "of that copy"}, rows);
}

}  // namespace chronormal::benchmarks
