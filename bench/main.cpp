// Measures the speed of every path, which is a way to compute normals (chronormal_bench, ./run bench). Compares the
// paths with the speed of this machine's memory and with libraries that people use today. docs/benchmarks.md is made
// from the output of the option --json.

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <charconv>
#include <cstdio>
#include <exception>
#include <fstream>
#include <iostream>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "chronormal/core/parallel.h"
#include "groups/groups.h"
#include "measure/machine.h"
#include "measure/report.h"
#include "paths/rivals.h"

namespace chronormal::bench {
namespace {

constexpr std::size_t kShuffledFrom = 10000000, kSchemesUpTo = 1500000, kBlendUpTo = 100000, kUsesUpTo = 1500000,
                      kCertifiedUpTo = 100000, kMost = 50000000;

// Parses a size such as "15k" or "10M".
Size parse_size(const std::string& text) {
  std::size_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  const std::string unit(rest, end);
  if (error == std::errc{} && value <= kMost) value *= unit == "k" ? 1000u : unit == "M" ? 1000000u : 1u;
  if (error != std::errc{} || (!unit.empty() && unit != "k" && unit != "M") || value < 100 || value > kMost)
    throw CLI::ValidationError("--sizes", fmt::format("'{}' is no number of elements from 100 to 50M", text));
  return {text, value, false};
}

std::vector<Size> parse_sizes(const std::string& list) {
  std::vector<Size> sizes;
  std::istringstream stream(list);
  for (std::string text; std::getline(stream, text, ',');) sizes.push_back(parse_size(text));
  if (sizes.empty()) throw CLI::ValidationError("--sizes", "names no size");
  return sizes;
}

// Throws an error before the measurements if the file `json` cannot be written, so that ten minutes of work are not
// lost.
void check_writable(const std::string& json) {
  if (json.empty() || json == "-") return;
  if (!std::ofstream(json, std::ios::binary | std::ios::app))
    throw std::runtime_error(fmt::format("{}: cannot be written", json));
}

Report measure(const SuiteOptions& options, const std::vector<Size>& sizes) {
  Suite suite(options);
  Report report;
  report.quick = options.quick;
  report.machine = describe_machine();
  report.rivals = rival_versions();
  for (const char* const rival : {"CGAL", "Eigen", "OpenMesh", "VTK"}) {
    if (report.rivals.count(rival) == 0) suite.say(fmt::format("built without {}: its rows are missing", rival));
  }
  for (const bool shuffled : {false, true}) {
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      Size size = sizes[i];
      // Small meshes fit into a cache, where their order does not matter, so they are not measured in random order.
      if (shuffled && size.elements < kShuffledFrom && i + 1 < sizes.size()) continue;
      size.shuffled = shuffled;
      run_faces(suite, size);
      run_vertices(suite, size);
      if (!shuffled && size.elements <= kSchemesUpTo) run_schemes(suite, size);
      if (!shuffled && size.elements <= kBlendUpTo) run_blend(suite, size);
      if (!shuffled && size.elements <= kUsesUpTo) {
        run_uses(suite, size);
        run_cones(suite, size);
        run_containment(suite, size);
      }
      if (!shuffled && size.elements <= kCertifiedUpTo) run_certificates(suite, size);
    }
  }
  run_meshes(suite);
  report.accuracies = measure_accuracy(suite);
  if (suite.wants("quality", {"twist", 0, false}, "schemes")) {
    suite.say("quality of schemes");
    report.qualities = scheme_qualities();
  }
  report.machine.emplace_back("prefetch", chosen_prefetch());
  report.rows = suite.rows();
  report.bandwidths = suite.bandwidths();
  suite.say("");
  return report;
}

void write(const Report& report, const std::string& json) {
  if (json != "-") {
    fmt::print("{}", tables_of(report));
    if (json.empty()) return;
  }
  const std::string text = json_of(report);
  if (json == "-") {
    fmt::print("{}", text);
  } else if (!(std::ofstream(json, std::ios::binary) << text).flush()) {
    throw std::runtime_error(fmt::format("{}: cannot be written", json));
  }
}

int run(int argc, char** argv) {
  CLI::App app("How fast every path is, against memory and against other libraries.", "./run bench");
  SuiteOptions options;
  std::string sizes = "15k,45k,1M,10M", json;
  options.threads = std::max(1u, std::thread::hardware_concurrency());
  app.add_flag("--quick", options.quick, "few and short repetitions");
  app.add_option("--sizes", sizes, "numbers of elements, separated by commas")->capture_default_str();
  app.add_option("--filter", options.filter, "only what this matches: GROUP/SIZE/ORDER/NAME, a POSIX expression");
  app.add_option("--threads", options.threads, "of the rows on many threads")->check(CLI::Range(1, 64));
  app.add_option("--json", json, "a file for the rows as JSON, or - for standard output");
  try {
    app.parse(argc, argv);
    const std::vector<Size> all = parse_sizes(sizes);
    check_writable(json);
    std::optional<ThreadLimit> limit;
    if (options.threads != std::thread::hardware_concurrency()) limit.emplace(options.threads);
    write(measure(options, all), json);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const std::exception& error) {
    fmt::print(stderr, "chronormal_bench: {}\n", error.what());
    return 1;
  }
  return 0;
}

}  // namespace
}  // namespace chronormal::bench

int main(int argc, char** argv) {
  chronormal::bench::restart_with_huge_pages(argv);
  return chronormal::bench::run(argc, argv);
}
