/// Times many functions against each other, on a machine that has other work to do.
///
/// Google Benchmark runs the loops. Each function runs in short repetitions, and the repetitions of all functions are
/// in random order, so that a disturbance of the machine affects all of them alike.
#ifndef BENCH_MEASURE_TIMING_H_
#define BENCH_MEASURE_TIMING_H_

#include <functional>
#include <string>
#include <vector>

namespace chronormal::bench {

struct Effort {
  double repetition = 0.006;  ///< seconds per function; slow functions take more
  double total = 0.5;         ///< most repetitions per function
  int most = 25;              ///< estimated seconds per call; 0 if unknown
  int least = 3;
};
inline constexpr Effort kFullEffort{};
inline constexpr Effort kQuickEffort{0.001, 0.01, 5, 3};

struct Timed {
  std::function<void()> run;
  double seconds = 0;                    ///< time of an observed call; 0 if there was no such call
  std::vector<double> nanoseconds = {};  ///< per call, one value for each repetition
};

/// Estimates the seconds that a call takes, from a few calls.
[[nodiscard]] double roughly_timed(const std::function<void()>& run);

/// Sets `nanoseconds` of each function.
void time_all(std::vector<Timed>& functions, const Effort& effort);

[[nodiscard]] double median(std::vector<double> values);
/// Returns the interquartile range divided by the median.
[[nodiscard]] double spread(std::vector<double> values);

}  // namespace chronormal::bench

#endif  // BENCH_MEASURE_TIMING_H_
