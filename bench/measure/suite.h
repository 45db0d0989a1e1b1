/// Runs groups of cases, which are functions to be timed. A suite compares the result of each case with the oracle,
/// then times all cases in random order, together with the speed of memory, and makes a row of the table for each case.
#ifndef BENCH_MEASURE_SUITE_H_
#define BENCH_MEASURE_SUITE_H_

#include <chrono>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "measure/oracle.h"
#include "measure/timing.h"
#include "memory/bandwidth.h"

namespace chronormal::bench {

struct Size {
  std::string name;  ///< as on the command line: 15k, 1M
  std::size_t elements = 0;
  bool shuffled = false;

  [[nodiscard]] std::string order() const { return shuffled ? "shuffled" : "grid"; }
};

/// A check of one result of a case: the normals that the case has computed for one t are compared with the oracle.
struct Check {
  double t = 0;
  std::function<Vector(std::size_t element)> normal_of;
  /// A function that returns the expected result for the elements of the oracle. If the function is empty, the exact
  /// normals are expected.
  std::function<std::vector<Vector>(const Oracle&)> expected = {};
};

struct Case {
  std::string name;
  std::string library = {};  ///< name and version of the library; empty for chronormal
  std::string note = {};     ///< a remark on what is timed or compared, or empty
  std::size_t threads = 1;
  std::size_t evaluations = 1;  ///< number of evaluations of each element in a run
  std::function<void()> run = {};
  std::vector<Check> checks = {};
  double limit = 0;  ///< largest allowed error in radians
  Rule rule = Rule::kArea;
  std::size_t bytes_read = 0;     ///< lower bound for a run; 0 if unknown
  std::size_t bytes_written = 0;  ///< lower bound for a run; 0 if unknown
};

struct Row {
  std::string group, name, library, note, size, order;
  std::size_t elements = 0, threads = 1, evaluations = 1;
  /// The median and the least time of a run, in nanoseconds for each element and evaluation. `spread` is the
  /// interquartile range of the times divided by their median.
  double median_ns = 0, least_ns = 0, spread = 0;
  std::size_t repetitions = 0;
  double bytes_read = 0, bytes_written = 0;  ///< for each element and evaluation
  double share_of_bandwidth = 0;             ///< time that the memory needs, divided by least_ns; 0 if unknown
  double verified_error = 0, limit = 0;      ///< in radians
  std::size_t verified_elements = 0;
};

struct SuiteOptions {
  bool quick = false;
  /// A POSIX regular expression that selects cases by their names, "GROUP/SIZE/ORDER/NAME". If the expression is empty,
  /// all cases run.
  std::string filter;
  std::size_t threads = 2;
};

class Suite {
 public:
  explicit Suite(SuiteOptions options);
  ~Suite();
  Suite(const Suite&) = delete;
  Suite& operator=(const Suite&) = delete;

  [[nodiscard]] const SuiteOptions& options() const { return options_; }
  [[nodiscard]] bool wants(const std::string& group, const Size& size, const std::string& name) const;

  /// Verifies and times cases. Throws std::runtime_error if the error of a result exceeds its limit.
  void run(const std::string& group, const Size& size, std::size_t element_count, const Oracle& oracle,
           std::vector<Case> cases);

  /// Prints the current step to standard error, with the seconds since the start.
  void say(const std::string& text) const;

  [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }
  [[nodiscard]] std::vector<Bandwidth> bandwidths() const { return meter_.all(); }

 private:
  struct Filter;

  SuiteOptions options_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::unique_ptr<Filter> filter_;
  std::vector<Row> rows_;
  BandwidthMeter meter_;
};

/// A list of the cases of one group and size that the user asked for. Other cases are not even prepared.
class CaseList {
 public:
  CaseList(const Suite& suite, std::string group, Size size)
      : suite_(suite), group_(std::move(group)), size_(std::move(size)) {}

  void add(const std::string& name, const std::function<Case()>& make) {
    if (!suite_.wants(group_, size_, name)) return;
    suite_.say(group_ + ", " + size_.name + ", " + size_.order() + ": " + name);
    cases_.push_back(make());
    cases_.back().name = name;
  }
  [[nodiscard]] bool wants(const std::string& name) const { return suite_.wants(group_, size_, name); }
  [[nodiscard]] std::vector<Case> take() { return std::move(cases_); }
  [[nodiscard]] const Suite& suite() const { return suite_; }
  [[nodiscard]] const Size& size() const { return size_; }

 private:
  const Suite& suite_;
  std::string group_;
  Size size_;
  std::vector<Case> cases_;
};

/// The time t of every verification. Products with t must be rounded, since t is not a short binary fraction.
inline constexpr float kTime = 0.3f;

}  // namespace chronormal::bench

#endif  // BENCH_MEASURE_SUITE_H_
