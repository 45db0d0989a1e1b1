/// Memory for arrays that are read or written from front to back. The memory is aligned to cache lines, and has huge
/// pages for large arrays.
#ifndef CHRONORMAL_CORE_MEMORY_H_
#define CHRONORMAL_CORE_MEMORY_H_

#include <cstddef>
#include <memory>
#include <type_traits>
#include <utility>

namespace chronormal::inline internal {

/// The smallest number of bytes, read and written in one pass, for which results are written to memory past the caches.
/// All arrays of results must then be aligned to 64 bytes. For recompute and the schemes, the arrays must also be
/// packed, without gaps. In a shared cache of 32 MiB, such results would evict data that is read next, and would be
/// evicted before anybody reads them. Measurements on a machine with such a cache, with and without a reader
/// afterwards, show that writing past the caches is faster from 20 to 30 MiB on.
inline constexpr std::size_t kStreamFrom = std::size_t{24} << 20;

/// Allocates `size` bytes with the alignment of AlignedBytes. The caller frees the memory with free_aligned(). Throws
/// std::bad_alloc.
[[nodiscard]] std::byte* allocate_aligned(std::size_t size);
void free_aligned(void* memory) noexcept;

/// Uninitialised bytes, aligned to 64 bytes. Arrays of 8 MiB or more are aligned to 2 MiB and, on Linux, marked for
/// huge pages, with which few translations of addresses miss the TLB. Pages that are never written cost no memory.
class AlignedBytes {
 public:
  AlignedBytes() = default;
  /// Allocates `size` bytes. Throws std::bad_alloc.
  explicit AlignedBytes(std::size_t size);
  AlignedBytes(AlignedBytes&& other) noexcept { *this = std::move(other); }
  AlignedBytes& operator=(AlignedBytes&& other) noexcept {
    data_ = std::move(other.data_);
    size_ = std::exchange(other.size_, 0);
    capacity_ = std::exchange(other.capacity_, 0);
    return *this;
  }

  /// Sets the size, without touching or moving the bytes. Precondition: size is not larger than capacity().
  void resize(std::size_t size) noexcept;
  /// Returns the memory behind the first size() bytes to the system if this memory is in huge pages. The caller may
  /// still use this memory.
  void release_rest() noexcept;

  [[nodiscard]] std::byte* data() noexcept { return data_.get(); }
  [[nodiscard]] const std::byte* data() const noexcept { return data_.get(); }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  /// Returns the largest possible size, which is the size that the object was made with.
  [[nodiscard]] std::size_t capacity() const noexcept { return capacity_; }

 private:
  struct Free {
    void operator()(std::byte* p) const noexcept;
  };
  std::unique_ptr<std::byte, Free> data_;
  std::size_t size_ = 0, capacity_ = 0;
};

/// An array of uninitialised values of a trivial type.
template <class T>
class AlignedArray {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  AlignedArray() = default;
  /// Allocates `count` values. Throws std::bad_alloc, also if count * sizeof(T) exceeds the range of std::size_t.
  explicit AlignedArray(std::size_t count);

  [[nodiscard]] T* data() noexcept { return reinterpret_cast<T*>(bytes_.data()); }
  [[nodiscard]] const T* data() const noexcept { return reinterpret_cast<const T*>(bytes_.data()); }
  [[nodiscard]] std::size_t size() const noexcept { return bytes_.size() / sizeof(T); }
  [[nodiscard]] T& operator[](std::size_t i) noexcept { return data()[i]; }
  [[nodiscard]] const T& operator[](std::size_t i) const noexcept { return data()[i]; }

 private:
  AlignedBytes bytes_;
};

/// An allocator with which a std::vector takes memory from AlignedBytes, for arrays that are read or written from front
/// to back.
template <class T>
struct AlignedAllocator {
  using value_type = T;

  AlignedAllocator() = default;
  template <class U>
  explicit AlignedAllocator(const AlignedAllocator<U>& /*other*/) noexcept {}

  [[nodiscard]] T* allocate(std::size_t count) {
    return reinterpret_cast<T*>(
        allocate_aligned(count > std::size_t(-1) / sizeof(T) ? std::size_t(-1) : count * sizeof(T)));
  }
  void deallocate(T* p, std::size_t /*count*/) noexcept { free_aligned(p); }

  friend bool operator==(const AlignedAllocator&, const AlignedAllocator&) = default;
};

template <class T>
AlignedArray<T>::AlignedArray(std::size_t count)
    : bytes_(count > std::size_t(-1) / sizeof(T) ? std::size_t(-1) : count * sizeof(T)) {}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_CORE_MEMORY_H_
