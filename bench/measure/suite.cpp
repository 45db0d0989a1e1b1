#include "measure/suite.h"

#include <fmt/core.h>
#include <regex.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <stdexcept>

namespace chronormal::bench {

struct Suite::Filter {
  regex_t expression;

  explicit Filter(const std::string& text) {
    if (regcomp(&expression, text.c_str(), REG_EXTENDED | REG_NOSUB) != 0)
      throw std::runtime_error(fmt::format("--filter: '{}' is no regular expression", text));
  }
  ~Filter() { regfree(&expression); }
  Filter(const Filter&) = delete;
  Filter& operator=(const Filter&) = delete;
};

Suite::Suite(SuiteOptions options) : options_(std::move(options)) {
  if (!options_.filter.empty()) filter_ = std::make_unique<Filter>(options_.filter);
}

Suite::~Suite() = default;

bool Suite::wants(const std::string& group, const Size& size, const std::string& name) const {
  if (!filter_) return true;
  const std::string path = fmt::format("{}/{}/{}/{}", group, size.name, size.order(), name);
  return regexec(&filter_->expression, path.c_str(), 0, nullptr, 0) == 0;
}

void Suite::say(const std::string& text) const {
  static const bool terminal = isatty(STDERR_FILENO) != 0;
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  if (terminal && text.empty())
    fmt::print(stderr, "\r\033[K");
  else if (terminal)
    fmt::print(stderr, "\r\033[K{:4.0f} s  {}", seconds, text);
  else if (!text.empty())
    fmt::print(stderr, "{:4.0f} s  {}\n", seconds, text);
  std::fflush(stderr);
}

void Suite::run(const std::string& group, const Size& size, std::size_t element_count, const Oracle& oracle,
                std::vector<Case> cases) {
  if (cases.empty()) return;
  std::vector<Row> rows;
  std::vector<Timed> functions;
  for (const Case& one : cases) {
    Row row{group, one.name, one.library, one.note, size.name, size.order()};
    row.elements = element_count, row.threads = one.threads, row.evaluations = one.evaluations;
    row.limit = one.limit, row.verified_elements = one.checks.empty() ? 0 : oracle.elements().size();
    const auto start = std::chrono::steady_clock::now();
    one.run();
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    for (const Check& check : one.checks) {
      const std::vector<Vector> exact = check.expected ? check.expected(oracle) : oracle.normals(check.t, one.rule);
      const double error = oracle.errors(exact, check.normal_of).max();
      row.verified_error = std::max(row.verified_error, error);
      if (!(error <= one.limit))
        throw std::runtime_error(fmt::format("{}, {}, {}: '{}' is wrong: off by {:.3g} rad at t = {:g}, limit {:.3g}",
                                             group, size.name, size.order(), one.name, error, check.t, one.limit));
    }
    if (one.bytes_read + one.bytes_written > 0 && one.threads == 1) meter_.want(one.bytes_read + one.bytes_written);
    rows.push_back(row);
    functions.push_back({one.run, seconds});
  }

  say(fmt::format("{}, {}, {}: timing {} functions", group, size.name, size.order(), functions.size()));
  meter_.append(functions);
  time_all(functions, options_.quick ? kQuickEffort : kFullEffort);
  meter_.take(functions, cases.size());
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const Case& one = cases[i];
    Row& row = rows[i];
    std::vector<double> times = functions[i].nanoseconds;
    if (times.empty()) throw std::runtime_error(fmt::format("'{}' was not timed", one.name));
    const double each = static_cast<double>(element_count * one.evaluations);
    const double run_ns = median(times);
    row.median_ns = run_ns / each;
    row.least_ns = *std::min_element(times.begin(), times.end()) / each;
    row.spread = spread(times);
    row.repetitions = times.size();
    const double read = static_cast<double>(one.bytes_read), written = static_cast<double>(one.bytes_written);
    row.bytes_read = read / each;
    row.bytes_written = written / each;
    const Bandwidth memory = meter_.at(one.bytes_read + one.bytes_written);
    if (read + written > 0 && one.threads == 1 && memory.bytes != 0)
      row.share_of_bandwidth =
          // The bandwidth that the fastest run of the case needs, as a share of the largest bandwidth of the memory.
          std::max(read / memory.read, (read + written) / memory.stream) / (row.least_ns * each);
    rows_.push_back(std::move(row));
  }
}

}  // namespace chronormal::bench
