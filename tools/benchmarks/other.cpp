// Writes what unit normals cost on meshes other than the torus and what the model of costs says of that, and what a frame
// costs, by the number of frames in a segment.

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "benchmarks/sections.h"

namespace chronormal::benchmarks {
namespace {

struct Way {
  const char *title, *prepare, *evaluate;
  Colour colour;
  Mark mark;
};

constexpr std::array<Way, 4> kWays = {
    Way{"recompute", "", "recompute", Colour::kRed, Mark::kSquare},
    Way{"recompute in float32", "", "recompute in float32", Colour::kOrange, Mark::kCircle},
    Way{"exact", "prepare exact", "exact to float3", Colour::kBlue, Mark::kDisc},
    Way{"compact", "prepare compact", "compact to float3", Colour::kGreen, Mark::kDiamond}};

// The nanoseconds that a frame takes where a segment has so many frames; 0: not measured.
double of_a_frame(const Results& results, const std::string& group, const std::string& size, const Way& way,
                  int frames) {
  const Row* const evaluate = results.find(group, size, kGrid, way.evaluate);
  if (evaluate == nullptr) return 0;
  if (*way.prepare == 0) return evaluate->ns;
  const Row* const prepare = results.find(group, size, kGrid, way.prepare);
  return prepare == nullptr ? 0 : prepare->ns / frames + evaluate->ns;
}

Panel frames_panel(const Results& results, const std::string& title, const std::string& group,
                   const std::string& size) {
  constexpr int kMost = 24;
  Panel panel;
  panel.title = title;
  panel.x = {"frames of a segment", 0, kMost, false, {}};
  double highest = 0;
  for (const Way& way : kWays) {
    Series series{way.title, {}, way.colour, 2, false, way.mark};
    for (int frames = 1; frames <= kMost; ++frames) {
      const double ns = of_a_frame(results, group, size, way, frames);
      if (ns == 0) continue;
      series.points.emplace_back(frames, ns);
      highest = std::max(highest, frames > 1 ? ns : 0);
    }
    if (!series.points.empty()) panel.series.push_back(std::move(series));
  }
  panel.y = {"ns per vertex and frame", 0, highest, false, {}};
  panel.legend = "top right";
  return panel;
}

// The number of frames in a segment from which on curves are faster than a rival.
std::string ahead_from(const Results& results, const std::string& group, const std::string& size, const Way& curves,
                       const Way& rival) {
  for (int frames = 1; frames <= 999; ++frames) {
    const double ours = of_a_frame(results, group, size, curves, frames);
    const double theirs = of_a_frame(results, group, size, rival, frames);
    if (ours == 0 || theirs == 0) return "-";
    if (ours <= theirs) return fmt::format("{}", frames);
  }
  return "never";
}

}  // namespace

std::string meshes_part(const Results& results, const std::string& folder) {
  std::string tables;
  for (const std::string group : {"faces of meshes", "vertices of meshes"}) {
    Cells header = {fmt::format("ns per {}", group.starts_with("faces") ? "face" : "vertex")};
    std::vector<std::string> meshes;
    for (const std::string& mesh : other_meshes()) {
      if (results.find(group, mesh, kGrid, "recompute") == nullptr) continue;
      meshes.push_back(mesh);
      header.push_back(mesh);
    }
    if (meshes.empty()) return "";
    std::vector<Cells> rows;
    for (const std::string& path : paths_on_meshes()) {
      Cells cells = {path};
      for (const std::string& mesh : meshes) cells.push_back(cell(results.find(group, mesh, kGrid, path)));
      rows.push_back(std::move(cells));
    }
    if (!tables.empty()) tables += '\n';
    tables += aligned_table(header, rows);
  }
  Page part("benchmarks/meshes.md.in", folder);
  part.set("tables", tables);
  return part.markdown();
}

std::string frames_part(const Results& results, const std::string& folder) {
  struct Mesh {
    std::string title, group, size;
  };
  std::vector<Mesh> meshes = {{"vertices of the grid, 45 k", "vertices", "45k"}};
  for (const std::string& mesh : other_meshes()) meshes.push_back({"vertices of " + mesh, "vertices of meshes", mesh});
  if (!results.knows("vertices", "recompute in float32")) return "";
  Page part("benchmarks/frames.md.in", folder);
  std::vector<Cells> rows;
  for (const Mesh& mesh : meshes) {
    if (results.find(mesh.group, mesh.size, kGrid, "recompute in float32") == nullptr) continue;
    const auto from = [&](const Way& curves, const Way& rival) {
      return ahead_from(results, mesh.group, mesh.size, curves, rival);
    };
    rows.push_back({mesh.title, from(kWays[2], kWays[0]), from(kWays[3], kWays[0]), from(kWays[2], kWays[1]),
                    from(kWays[3], kWays[1])});
  }
  part.table("ahead",
             {"curves are ahead from frame", "exact: recompute", "compact: recompute", "exact: in float32",
              "compact: in float32"},
             rows);
  Figure figure{fmt::format("benchmarks_{}_frames", results.name), 1000, 480, 2, {}};
  figure.panels = {frames_panel(results, meshes[0].title, meshes[0].group, meshes[0].size)};
  const bool has_dance = results.find("vertices of meshes", "dance", kGrid, "recompute") != nullptr;
  const std::string other = has_dance ? "dance" : "varied";
  if (results.find("vertices of meshes", other, kGrid, "recompute") != nullptr)
    figure.panels.push_back(frames_panel(results, "vertices of " + other, "vertices of meshes", other));
  part.picture("curve", figure);
  return part.markdown();
}

}  // namespace chronormal::benchmarks
