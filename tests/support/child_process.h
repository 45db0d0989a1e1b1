/// A piece of a test in a process of its own: what it costs is measured, and what it breaks is not the test program.
#ifndef CHRONORMAL_TESTS_SUPPORT_CHILD_PROCESS_H_
#define CHRONORMAL_TESTS_SUPPORT_CHILD_PROCESS_H_

#include <cstddef>
#include <functional>
#include <string>

namespace chronormal::test {

struct ChildRun {
  bool finished = false;        ///< false where it crashed, was killed, or threw
  std::string text;             ///< what the work returned, or why it did not finish
  double seconds = 0;           ///< of processors
  std::size_t peak_growth = 0;  ///< bytes of resident memory at the peak, above those at the start
};

/// Whether a sanitizer watches: then memory is not what the program itself takes.
[[nodiscard]] bool is_sanitized();

/// Does the work in a forked process that is stopped after most_seconds of a processor, and, unless a sanitizer
/// watches, may not take a GiB of address space more than it has at the start.
/// `prepare` runs before that in the same process: what it brings into memory, such as the program's own pages, is no growth.
[[nodiscard]] ChildRun run_in_child(unsigned most_seconds, const std::function<std::string()>& work,
                                    const std::function<void()>& prepare = {});

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_CHILD_PROCESS_H_
