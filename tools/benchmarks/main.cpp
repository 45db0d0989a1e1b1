// chronormal_benchmarks RESULTS FOLDER: writes FOLDER/benchmarks.md and FOLDER/pictures/benchmarks_*.svg from all
// RESULTS/*.json and RESULTS/commands/*.json (tools/make_benchmarks). Fails where a file lacks a row that the page needs.

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <stdexcept>

#include "benchmarks/sections.h"

namespace chronormal::benchmarks {
namespace {

namespace fs = std::filesystem;

std::vector<Results> all_results(const fs::path& folder) {
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".json") paths.push_back(entry.path());
  }
  if (paths.empty()) throw std::runtime_error(fmt::format("{}: no results (./run bench --json)", folder.string()));
  std::sort(paths.begin(), paths.end());
  std::vector<Results> all;
  for (const fs::path& path : paths) {
    all.push_back(read_results(path));
    const fs::path of_commands = folder / "commands" / path.filename();
    if (fs::exists(of_commands)) all.back().commands = read_commands(of_commands);
    const std::vector<std::string> missing = missing_rows(all.back());
    for (const std::string& row : missing) fmt::print(stderr, "{}: missing: {}\n", path.string(), row);
    if (!missing.empty())
      throw std::runtime_error(fmt::format("{}: {} rows are missing", path.string(), missing.size()));
  }
  return all;
}

std::string machine_part(const Results& results, const std::string& folder) {
  std::string facts;
  const auto add = [&facts](const std::string& words, const std::string& value) {
    facts += fmt::format("{}{} {}", facts.empty() ? "" : "; ", words, value);
  };
  for (const auto& [name, value] : results.machine) {
    std::string words = name;
    std::replace(words.begin(), words.end(), '_', ' ');
    if (name != "cpu") add(words, value);
  }
  for (const auto& [name, version] : results.rivals) add(name, version);
  Page part("benchmarks/machine.md.in", folder);
  part.set(
      {{"name", results.name},
       {"cpu", results.machine_value("cpu")},
       {"facts", facts},
       {"quick", results.quick ? " **Repetitions were few and short in this quick run; its figures are rough.**" : ""},
       {"meshes", meshes_part(results, folder)},
       {"frames", frames_part(results, folder)},
       {"blend", blend_part(results, folder)},
       {"commands", commands_part(results, folder)},
       {"uses", uses_part(results, folder)}});
  add_costs(part, results);
  add_aims(part, results, folder);
  add_memory(part, results);
  add_schemes(part, results);
  add_accuracy(part, results);
  return part.markdown();
}

void write_page(const fs::path& results, const std::string& folder) {
  const std::vector<Results> all = all_results(results);
  std::string machines;
  for (const Results& machine : all) {
    if (!machines.empty()) machines += '\n';
    machines += machine_part(machine, folder);
  }
  Page page("benchmarks/benchmarks.md.in", folder);
  page.set({{"side_by_side", side_by_side(all)}, {"machines", machines}});
  page.write("benchmarks.md");
}

}  // namespace
}  // namespace chronormal::benchmarks

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: chronormal_benchmarks RESULTS FOLDER\n");
    return 2;
  }
  return chronormal::pages::run("chronormal_benchmarks", [&] { chronormal::benchmarks::write_page(argv[1], argv[2]); });
}
