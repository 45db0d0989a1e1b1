#include "measure/timing.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

namespace chronormal::bench {
namespace {

// Before a function is timed, calls of the function fill the caches: kWarmCalls calls if a call takes at most kShort
// seconds, and one call if a call takes at most kSlow seconds. (Data that barely exceed a cache reach a steady state
// only after several passes.) If a call takes more than kVerySlow seconds, the first rough timing counts as a result,
// and only one more call follows.
constexpr int kWarmCalls = 4;
constexpr double kShort = 0.012, kSlow = 0.15, kVerySlow = 3;

class Collector : public benchmark::BenchmarkReporter {
 public:
  explicit Collector(std::vector<Timed>& functions) : functions_(functions) {}
  bool ReportContext(const Context&) override { return true; }
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      if (run.run_type != Run::RT_Iteration) continue;
      if (run.error_occurred) throw std::runtime_error(run.error_message);
      functions_.at(std::stoul(run.run_name.function_name)).nanoseconds.push_back(run.GetAdjustedRealTime());
    }
  }

 private:
  std::vector<Timed>& functions_;
};

void initialize_once() {
  static const bool done = [] {
    std::string arguments[] = {"chronormal_bench", "--benchmark_enable_random_interleaving=true"};
    char* pointers[] = {arguments[0].data(), arguments[1].data(), nullptr};
    int count = 2;
    benchmark::Initialize(&count, pointers);
    return true;
  }();
  (void)done;
}

double sorted_quantile(const std::vector<double>& sorted, double share) {
  if (sorted.empty()) return 0;
  const double at = share * static_cast<double>(sorted.size() - 1);
  const std::size_t below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (at - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

}  // namespace

double roughly_timed(const std::function<void()>& run) {
  using Clock = std::chrono::steady_clock;
  double least = 0, total = 0;
  for (int call = 0; call < 20 && total < 0.01; ++call) {
    const Clock::time_point start = Clock::now();
    run();
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    least = call == 0 ? seconds : std::min(least, seconds);
    total += seconds;
  }
  return std::max(least, 1e-9);
}

void time_all(std::vector<Timed>& functions, const Effort& effort) {
  initialize_once();
  for (std::size_t i = 0; i < functions.size(); ++i) {
    const std::function<void()>& run = functions[i].run;
    const double seconds = functions[i].seconds > kSlow ? functions[i].seconds : roughly_timed(run);
    const double calls = std::max(1.0, std::ceil(effort.repetition / seconds));
    const int wanted = static_cast<int>(std::min<double>(effort.most, effort.total / (calls * seconds)));
    const int warm = seconds < kShort ? kWarmCalls : seconds < kSlow ? 1 : 0;
    benchmark::RegisterBenchmark(std::to_string(i).c_str(),
                                 [&run, warm](benchmark::State& state) {
                                   // Fills the caches with the data of this function, because the functions that ran
                                   // before have evicted them.
                                   for (int call = 0; call < warm; ++call) run();
                                   for ([[maybe_unused]] auto _ : state) run();
                                 })
        ->Iterations(static_cast<benchmark::IterationCount>(calls))
        ->Repetitions(seconds > kVerySlow ? 1 : std::max(effort.least, wanted))
        ->UseRealTime();
  }
  for (Timed& function : functions) {
    if (function.seconds > kVerySlow) function.nanoseconds.push_back(1e9 * function.seconds);
  }
  Collector collector(functions);
  if (!functions.empty()) benchmark::RunSpecifiedBenchmarks(&collector, nullptr, ".");
  benchmark::ClearRegisteredBenchmarks();
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return sorted_quantile(values, 0.5);
}

double spread(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const double middle = sorted_quantile(values, 0.5);
  return middle > 0 ? (sorted_quantile(values, 0.75) - sorted_quantile(values, 0.25)) / middle : 0;
}

}  // namespace chronormal::bench
