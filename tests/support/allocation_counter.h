/// Counts the heap memory that a part of a test allocates, so that the test can limit it.
#ifndef CHRONORMAL_TESTS_SUPPORT_ALLOCATION_COUNTER_H_
#define CHRONORMAL_TESTS_SUPPORT_ALLOCATION_COUNTER_H_

#include <cstddef>

namespace chronormal::test {

/// Counts the memory that operator new gives to this thread as long as the counter lives. A thread can have only one
/// counter at a time.
class AllocationCounter {
 public:
  /// Returns false under a sanitizer, whose operator new replaces the operator new that counts.
  [[nodiscard]] static bool works() noexcept;

  AllocationCounter();
  AllocationCounter(const AllocationCounter&) = delete;
  AllocationCounter& operator=(const AllocationCounter&) = delete;
  ~AllocationCounter();

  [[nodiscard]] std::size_t allocations() const noexcept;
  /// Returns the largest number of bytes that were in use at once, beyond the bytes in use at the start.
  [[nodiscard]] std::size_t peak_bytes() const noexcept;
  /// Returns the number of bytes in use now, beyond the bytes in use at the start. The number is negative if more bytes
  /// were freed than allocated.
  [[nodiscard]] std::ptrdiff_t bytes() const noexcept;
};

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_ALLOCATION_COUNTER_H_
