/// Counts the heap memory that a part of a test allocates.
#ifndef CHRONORMAL_TESTS_SUPPORT_ALLOCATION_COUNTER_H_
#define CHRONORMAL_TESTS_SUPPORT_ALLOCATION_COUNTER_H_

#include <cstddef>

namespace chronormal::test {

/// Counts the memory that operator new gives to this thread during the counter's lifetime. A thread can have one
/// counter at a time.
class AllocationCounter {
 public:
  /// Returns false under a sanitizer, whose own operator new prevents counting.
  [[nodiscard]] static bool works() noexcept;

  AllocationCounter();
  AllocationCounter(const AllocationCounter&) = delete;
  AllocationCounter& operator=(const AllocationCounter&) = delete;
  ~AllocationCounter();

  [[nodiscard]] std::size_t allocations() const noexcept;
  /// Returns the most bytes that were in use at once, beyond those at the start.
  [[nodiscard]] std::size_t peak_bytes() const noexcept;
  /// Returns the bytes in use now; negative if more were freed than allocated.
  [[nodiscard]] std::ptrdiff_t bytes() const noexcept;
};

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_ALLOCATION_COUNTER_H_
