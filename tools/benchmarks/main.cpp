// chronormal_benchmarks RESULTS FOLDER: writes FOLDER/benchmarks.md and FOLDER/pictures/benchmarks_*.svg from all
// RESULTS/*.json (tools/make_benchmarks). Fails where a file lacks a row that the page needs.

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <stdexcept>

#include "benchmarks/sections.h"
#include "chronormal/io/output.h"

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
    const std::vector<std::string> missing = missing_rows(all.back());
    for (const std::string& row : missing) fmt::print(stderr, "{}: missing: {}\n", path.string(), row);
    if (!missing.empty())
      throw std::runtime_error(fmt::format("{}: {} rows are missing", path.string(), missing.size()));
  }
  return all;
}

void write_head(Page& page) {
  page.line("# Benchmarks\n");
  page.text(
      "What unit normals at a time t cost: ours, those of other libraries, and what the memory of the machine allows, "
      "all in one run. Every figure is out of `bench/results/*.json`, a file for each machine, from which a command "
      "writes this page and its pictures; a test runs it again and compares, and fails where a rival is missing:");
  page.line("    ./run bench --json bench/results/NAME.json && tools/make_benchmarks\n");
  page.heading("How it is measured");
  page.bullet(
      "The meshes are closed grids on a torus, with six faces around every vertex. Between two keyframes they are "
      "turned by 60 degrees, stretched, and twisted by up to a radian. *Shuffled* means that vertices and faces are in "
      "a random order. Sizes count faces in tables of faces, and vertices in those of vertices.");
  page.bullet(
      "Each function is verified before it is timed, against normals in double that share no code with it (all "
      "elements, 4,096 at random where there are more than 100,000), and the run ends where one is wrong.");
  page.bullet(
      "Nanoseconds are per element and evaluation, on one thread where nothing else is said: the median over "
      "repetitions, which alternate at random between all functions of a table; and behind ± the distance between "
      "their quartiles in percent of it. All large arrays are in huge pages, also those of the libraries.");
  page.bullet(
      "The plain loop and the one with Eigen interpolate the positions and compute normals. Libraries find the "
      "positions of that t in their own structure, and only their computation is timed; what *interpolate positions* "
      "takes would come on top. What of them is made of headers (all but VTK, which is Debian's build) is compiled "
      "like "
      "the rest of the program, with -O3 for every x86-64; our kernels choose their instructions at run time.");
  page.bullet(
      "`exact` are float32 curves (tolerance 1e-6 rad), `compact` those of tolerance 1e-3 rad (a twentieth of a "
      "degree). "
      "`float3` is an array (n, 3), `planes` three arrays, `octahedral` and `rgb10a2` are four bytes. `recompute` is "
      "the best that we can do without preparing anything, to the same 1e-6 rad. `prepare` uses the memory of the "
      "preparation before, as a "
      "program does that goes through many segments.");
  page.bullet(
      "*Share of memory* is the time that the memory needs for it at least over the shortest time that was measured: "
      "the "
      "larger of bytes read over the read bandwidth and all bytes over the streaming bandwidth, both the best that "
      "were "
      "measured beside it, with as many bytes. The mixture of reads and writes is another one than that of copies, so "
      "that more than 100 % are "
      "possible.");
  page.bullet(
      "The *bare loops* make no normals. They read and write what an evaluation does, in the same order, or only write "
      "as many results as for many t, one array after the other, and compute next to nothing; the fastest of several "
      "ways to do it counts. On two cores of a virtual machine they also show what its host allows: whether both share "
      "a cache and the way to the memory may change from minute to minute.");
}

void write_page(const fs::path& results, const std::string& folder) {
  Page page(folder);
  write_head(page);
  page.line("");
  for (const Results& machine : all_results(results)) {
    page.heading(fmt::format("{}: {}", machine.name, machine.machine_value("cpu")));
    std::string facts;
    const auto add = [&facts](const std::string& words, const std::string& value) {
      facts += fmt::format("{}{} {}", facts.empty() ? "" : "; ", words, value);
    };
    for (const auto& [name, value] : machine.machine) {
      std::string words = name;
      std::replace(words.begin(), words.end(), '_', ' ');
      if (name != "cpu") add(words, value);
    }
    for (const auto& [name, version] : machine.rivals) add(name, version);
    page.text(fmt::format("{}.{}", facts,
                          machine.quick ? " **A quick run, with few and short repetitions: rough figures.**" : ""));
    write_costs(page, machine);
    write_aims(page, machine);
    write_memory(page, machine);
    write_schemes(page, machine);
    write_blend(page, machine);
    write_accuracy(page, machine);
  }
  std::string markdown = page.markdown();
  while (markdown.ends_with("\n\n")) markdown.pop_back();
  const Status written = write_output(fmt::format("{}/benchmarks.md", folder), markdown, true);
  if (!written) throw std::runtime_error(written.error().text());
}

}  // namespace
}  // namespace chronormal::benchmarks

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: chronormal_benchmarks RESULTS FOLDER\n");
    return 2;
  }
  try {
    chronormal::benchmarks::write_page(argv[1], argv[2]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "chronormal_benchmarks: %s\n", error.what());
    return 1;
  }
  return 0;
}
