/// Measures the processor time of this process. Other programs on the machine do not affect this time, so tests can
/// limit it.
#ifndef CHRONORMAL_TESTS_SUPPORT_CPU_TIME_H_
#define CHRONORMAL_TESTS_SUPPORT_CPU_TIME_H_

#include <gtest/gtest.h>

#include <sys/resource.h>

#include <algorithm>
#include <limits>

#include "tests/support/child_process.h"

namespace chronormal::test {

/// Returns the processor time in `usage`, in seconds: the time in the program plus the time in the system, over all
/// threads.
[[nodiscard]] inline double cpu_seconds(const rusage& usage) {
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// A clock that measures processor time from its construction on. The time of a child process counts once the process
/// has ended.
class CpuClock {
 public:
  [[nodiscard]] double seconds() const { return now() - start_; }

 private:
  [[nodiscard]] static double now() {
    rusage own{}, children{};
    getrusage(RUSAGE_SELF, &own);
    getrusage(RUSAGE_CHILDREN, &children);
    return cpu_seconds(own) + cpu_seconds(children);
  }
  double start_ = now();
};

/// Expects that `many()` takes at most `limit` times as long as `few()`, plus `once` seconds. Runs both functions
/// alternately, at most ten times, until the shortest time of each fulfils this condition. A busy machine can only
/// lengthen times, so a test fails only if all ten attempts were too slow. Does nothing under sanitizers, whose
/// additional work grows differently.
template <class Few, class Many>
void expect_growth(double limit, double once, const Few& few, const Many& many) {
  if (is_sanitized()) return;
  constexpr int kMostTries = 10;
  const auto seconds = [](const auto& work) {
    const CpuClock clock;
    work();
    return clock.seconds();
  };
  double of_few = std::numeric_limits<double>::infinity(), of_many = of_few;
  for (int i = 0; i < kMostTries && (i == 0 || of_many > limit * of_few + once); ++i) {
    of_few = std::min(of_few, seconds(few));
    of_many = std::min(of_many, seconds(many));
  }
  EXPECT_LE(of_many, limit * of_few + once);
}

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_CPU_TIME_H_
