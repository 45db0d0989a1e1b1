/// Times many functions against each other, on a machine that has other work to do.
///
/// Google Benchmark runs the loops. Each function runs in short repetitions, and the repetitions of all functions are
/// in random order, so that a disturbance of the machine affects all functions alike.
#ifndef BENCH_MEASURE_TIMING_H_
#define BENCH_MEASURE_TIMING_H_

#include <functional>
#include <string>
#include <vector>

namespace chronormal::bench {

struct Effort {
  double repetition = 0.006;  ///< seconds of a repetition; slow functions take more
  double total = 0.5;         ///< seconds for a function in total; slow functions take more
  int most = 25;              ///< largest number of repetitions for a function
  int least = 3;
};
inline constexpr Effort kFullEffort{};
inline constexpr Effort kQuickEffort{0.001, 0.01, 5, 3};

struct Timed {
  std::function<void()> run;
  double seconds = 0;                    ///< seconds that an observed call took; 0 if none was observed
  std::vector<double> nanoseconds = {};  ///< nanoseconds of a call, one value for each repetition
};

/// Estimates from a few calls how many seconds one call of run() takes.
[[nodiscard]] double roughly_timed(const std::function<void()>& run);

/// Times all functions, and sets their `nanoseconds`.
void time_all(std::vector<Timed>& functions, const Effort& effort);

[[nodiscard]] double median(std::vector<double> values);
/// Returns the interquartile range of the values, divided by their median.
[[nodiscard]] double spread(std::vector<double> values);

}  // namespace chronormal::bench

#endif  // BENCH_MEASURE_TIMING_H_
