/// Runs a part of a test in a child process. The time and the memory of this part can then be measured, and a crash
/// does not end the test program.
#ifndef CHRONORMAL_TESTS_SUPPORT_CHILD_PROCESS_H_
#define CHRONORMAL_TESTS_SUPPORT_CHILD_PROCESS_H_

#include <cstddef>
#include <functional>
#include <string>

namespace chronormal::test {

struct ChildRun {
  bool finished = false;        ///< false if the process crashed, was killed, or threw an exception
  std::string text;             ///< result of the work, or the reason why it did not finish
  double seconds = 0;           ///< processor time
  std::size_t peak_growth = 0;  ///< bytes of resident memory at the peak, minus those at the start
};

/// Tells whether a sanitizer is active. Sanitizers need additional memory and time.
[[nodiscard]] bool is_sanitized();

/// Runs work() in a forked process, which is stopped after most_seconds of processor time. Unless a sanitizer is
/// active, the address space of the process may grow by at most 1 GiB. `prepare` runs first in the forked process.
/// Memory that `prepare` touches, such as the pages of the program, does not count as growth.
[[nodiscard]] ChildRun run_in_child(unsigned most_seconds, const std::function<std::string()>& work,
                                    const std::function<void()>& prepare = {});

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_CHILD_PROCESS_H_
