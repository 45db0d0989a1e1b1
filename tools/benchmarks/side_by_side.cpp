// Writes the same rows of all machines beside each other.

#include <fmt/core.h>

#include "benchmarks/sections.h"

namespace chronormal::benchmarks {

std::string side_by_side(const std::vector<Results>& machines) {
  Cells header = {"ns per element"};
  for (const Results& machine : machines)
    header.push_back(fmt::format("{}, {}", machine.name, machine.machine_value("instruction_set")));
  std::vector<Cells> rows;
  for (const std::string group : {"faces", "vertices"}) {
    for (const std::string size : {"15k", "10M"}) {
      for (const std::string path : {"plain C++ loop", "recompute in float32", "recompute", "prepare exact",
                                     "prepare compact", "exact to float3", "compact to float3", "bare loop as exact"}) {
        Cells cells = {fmt::format("{}, {}: {}", group, spelt(size), path)};
        for (const Results& machine : machines) cells.push_back(cell(machine.find(group, size, kGrid, path)));
        rows.push_back(std::move(cells));
      }
    }
  }
  return aligned_table(header, rows);
}

}  // namespace chronormal::benchmarks
