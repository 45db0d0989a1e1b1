#include "tests/support/allocation_counter.h"

#include <malloc.h>

#include <algorithm>
#include <cstdlib>
#include <new>

namespace chronormal::test {
namespace {

struct Counts {
  bool is_on = false;
  std::size_t allocations = 0;
  std::ptrdiff_t bytes = 0, peak = 0;
};

thread_local Counts counts;

}  // namespace

AllocationCounter::AllocationCounter() { counts = {true, 0, 0, 0}; }
AllocationCounter::~AllocationCounter() { counts.is_on = false; }
std::size_t AllocationCounter::allocations() const noexcept { return counts.allocations; }
std::size_t AllocationCounter::peak_bytes() const noexcept { return static_cast<std::size_t>(counts.peak); }
std::ptrdiff_t AllocationCounter::bytes() const noexcept { return counts.bytes; }

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define CHRONORMAL_SANITIZED
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#define CHRONORMAL_SANITIZED
#endif
#endif

#ifdef CHRONORMAL_SANITIZED

bool AllocationCounter::works() noexcept { return false; }

}  // namespace chronormal::test

#else

bool AllocationCounter::works() noexcept { return true; }

static void* counted(void* memory) {
  if (memory == nullptr) throw std::bad_alloc();
  if (counts.is_on) {
    ++counts.allocations;
    counts.bytes += static_cast<std::ptrdiff_t>(::malloc_usable_size(memory));
    counts.peak = std::max(counts.peak, counts.bytes);
  }
  return memory;
}

static void release(void* memory) noexcept {
  if (counts.is_on) counts.bytes -= static_cast<std::ptrdiff_t>(::malloc_usable_size(memory));
  std::free(memory);
}

}  // namespace chronormal::test

// The forms of operator new and operator delete below count memory. The other forms, which the standard library
// defines, call these forms.
void* operator new(std::size_t size) { return chronormal::test::counted(std::malloc(std::max<std::size_t>(size, 1))); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  const auto step = static_cast<std::size_t>(alignment);
  return chronormal::test::counted(std::aligned_alloc(step, (std::max<std::size_t>(size, 1) + step - 1) / step * step));
}
void operator delete(void* memory) noexcept { chronormal::test::release(memory); }
void operator delete(void* memory, std::size_t) noexcept { chronormal::test::release(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { chronormal::test::release(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { chronormal::test::release(memory); }

#endif
