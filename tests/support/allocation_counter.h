/// How much memory the code of a test takes from the heap.
#ifndef CHRONORMAL_TESTS_SUPPORT_ALLOCATION_COUNTER_H_
#define CHRONORMAL_TESTS_SUPPORT_ALLOCATION_COUNTER_H_

#include <cstddef>

namespace chronormal::test {

/// Counts what operator new gives to this thread while it lives. One at a time on a thread.
class AllocationCounter {
 public:
  /// False under a sanitizer, which has an operator new of its own: then nothing is counted.
  [[nodiscard]] static bool works() noexcept;

  AllocationCounter();
  AllocationCounter(const AllocationCounter&) = delete;
  AllocationCounter& operator=(const AllocationCounter&) = delete;
  ~AllocationCounter();

  [[nodiscard]] std::size_t allocations() const noexcept;
  /// The most bytes that were in use at once, beyond those of the start.
  [[nodiscard]] std::size_t peak_bytes() const noexcept;
  /// Those in use now; negative where more was given back than taken.
  [[nodiscard]] std::ptrdiff_t bytes() const noexcept;
};

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_ALLOCATION_COUNTER_H_
