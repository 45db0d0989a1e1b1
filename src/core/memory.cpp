// Allocates memory for arrays that are read or written from front to back, with huge pages for large arrays.
#include "core/memory.h"

#include <cassert>
#include <cstdlib>
#include <new>

#ifdef __linux__
#include <sys/mman.h>
#elif defined(_WIN32)
#include <malloc.h>
#endif

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kCacheLine = 64;
constexpr std::size_t kHugePage = std::size_t{2} << 20;
constexpr std::size_t kSmallestHuge = 4 * kHugePage;

}  // namespace

std::byte* allocate_aligned(std::size_t size) {
  const std::size_t alignment = size >= kSmallestHuge ? kHugePage : kCacheLine;
  if (size > std::size_t(-1) - alignment) throw std::bad_alloc();
  const std::size_t whole = (size + alignment - 1) / alignment * alignment;
#ifdef _WIN32
  void* const memory = ::_aligned_malloc(whole, alignment);
#else
  void* const memory = std::aligned_alloc(alignment, whole);
#endif
  if (memory == nullptr) throw std::bad_alloc();
#ifdef __linux__
  if (alignment == kHugePage) (void)madvise(memory, whole, MADV_HUGEPAGE);  // if the system refuses, pages stay small
#endif
  return static_cast<std::byte*>(memory);
}

void free_aligned(void* memory) noexcept {
#ifdef _WIN32
  ::_aligned_free(memory);
#else
  std::free(memory);
#endif
}

AlignedBytes::AlignedBytes(std::size_t size)
    : data_(size == 0 ? nullptr : allocate_aligned(size)), size_(size), capacity_(size) {}

void AlignedBytes::Free::operator()(std::byte* p) const noexcept { free_aligned(p); }

void AlignedBytes::resize(std::size_t size) noexcept {
  assert(size <= capacity_);
  size_ = size;
}

void AlignedBytes::release_rest() noexcept {
#ifdef __linux__
  if (capacity_ < kSmallestHuge) return;
  const std::size_t kept = (size_ + kHugePage - 1) / kHugePage * kHugePage;
  if (kept < capacity_) (void)madvise(data_.get() + kept, capacity_ - kept, MADV_DONTNEED);
#endif
}

}  // namespace chronormal::inline internal
