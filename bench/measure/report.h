/// Prints the results of a run: tables for people, and one JSON object for tools/make_page benchmarks.
#ifndef BENCH_MEASURE_REPORT_H_
#define BENCH_MEASURE_REPORT_H_

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "groups/groups.h"

namespace chronormal::bench {

struct Report {
  bool quick = false;
  std::vector<std::pair<std::string, std::string>> machine;
  /// The names of the libraries that are compared with ours, and their versions.
  std::map<std::string, std::string> rivals;
  std::vector<Bandwidth> bandwidths;
  std::vector<Row> rows;
  std::vector<SchemeQuality> qualities;
  std::vector<Accuracy> accuracies;
};

[[nodiscard]] std::string tables_of(const Report& report);
/// Returns the report as JSON. Numbers have four significant digits, because further digits would be noise.
[[nodiscard]] std::string json_of(const Report& report);

}  // namespace chronormal::bench

#endif  // BENCH_MEASURE_REPORT_H_
