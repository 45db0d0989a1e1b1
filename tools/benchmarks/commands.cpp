// Writes what commands of the program take on a large sequence. A machine on which nobody measured that gets no such part.

#include <fmt/core.h>

#include <algorithm>

#include "benchmarks/sections.h"

namespace chronormal::benchmarks {

std::string commands_part(const Results& results, const std::string& folder) {
  if (!results.commands) return "";
  const Commands& commands = *results.commands;
  std::vector<Cells> rows;
  for (const CommandInput& input : commands.inputs) {
    const auto reading = std::find_if(input.rows.begin(), input.rows.end(),
                                      [](const CommandRow& row) { return row.name == "reading it as a motion"; });
    require(reading != input.rows.end() && reading->cpu > 0, "reading takes time");
    for (const CommandRow& row : input.rows)
      rows.push_back({fmt::format("{}, {:.0f} MB: {}", input.title, input.bytes / 1e6, row.name),
                      fmt::format("{:.2f}", row.wall), fmt::format("{:.2f}", row.cpu),
                      fmt::format("{:.2f}", row.cpu / reading->cpu)});
  }
  std::vector<Cells> readers;
  for (const ObjReader& reader : commands.readers)
    readers.push_back({reader.name, fmt::format("{:.0f}", reader.cpu_ms),
                       fmt::format("{:.2f}", reader.cpu_ms / commands.readers.front().cpu_ms)});
  Page part("benchmarks/commands.md.in", folder);
  part.set({{"vertices", grouped(commands.vertices)},
            {"faces", grouped(commands.faces)},
            {"keyframes", fmt::format("{:.0f}", commands.keyframes)},
            {"table", aligned_table({"", "seconds", "of processors", "times reading"}, rows)},
            {"obj_megabytes", fmt::format("{:.0f}", commands.obj_bytes / 1e6)},
            {"readers", aligned_table({"", "ms", "times the loop"}, readers)}});
  return part.markdown();
}

}  // namespace chronormal::benchmarks
