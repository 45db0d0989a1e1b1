/// Time as this process has used it: what a test may limit, since a neighbour on the machine does not count.
#ifndef CHRONORMAL_TESTS_SUPPORT_CPU_TIME_H_
#define CHRONORMAL_TESTS_SUPPORT_CPU_TIME_H_

#include <sys/resource.h>

namespace chronormal::test {

/// Seconds of processors, of all threads, and of the system on their behalf.
[[nodiscard]] inline double cpu_seconds(const rusage& usage) {
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// A clock that starts when it is made. Processes that were started since then count once they have ended.
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

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_CPU_TIME_H_
