#include "core/memory.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <new>
#include <utility>

#include "chronormal/core/vec3.h"
#include "tests/support/child_process.h"

namespace chronormal::memory_test {
namespace {

constexpr std::size_t kLargest = std::numeric_limits<std::size_t>::max();
constexpr std::size_t kMebibyte = std::size_t{1} << 20;

std::uintptr_t address(const void* p) { return reinterpret_cast<std::uintptr_t>(p); }

TEST(AlignedBytes, are_aligned_to_cache_lines_and_from_4_MiB_on_to_huge_pages) {
  for (const std::size_t size : {std::size_t{1}, std::size_t{63}, std::size_t{64}, std::size_t{65}, 8 * kMebibyte - 1,
                                 8 * kMebibyte, 8 * kMebibyte + 1, 9 * kMebibyte + 7}) {
    AlignedBytes bytes(size);
    ASSERT_NE(bytes.data(), nullptr);
    EXPECT_EQ(bytes.size(), size);
    EXPECT_EQ(bytes.capacity(), size);
    const std::size_t alignment = size >= 8 * kMebibyte ? 2 * kMebibyte : 64;
    EXPECT_EQ(address(bytes.data()) % alignment, 0u) << size;
    std::memset(bytes.data(), 0x5A, size);  // checks that the whole block is writable
    EXPECT_EQ(bytes.data()[size - 1], std::byte{0x5A});
  }
}

TEST(AlignedBytes, none_are_no_trouble) {
  const AlignedBytes none, zero(0);
  EXPECT_EQ(none.data(), nullptr);
  EXPECT_EQ(zero.data(), nullptr);
  EXPECT_EQ(none.size() + zero.size() + none.capacity() + zero.capacity(), 0u);
}

TEST(AlignedBytes, a_new_size_moves_and_changes_nothing) {
  for (const std::size_t size : {std::size_t{1000}, 9 * kMebibyte}) {
    AlignedBytes bytes(size);
    for (std::size_t i = 0; i < size; ++i) bytes.data()[i] = static_cast<std::byte>(i * 7);
    const std::byte* const before = bytes.data();
    for (const std::size_t smaller : {size - 1, size / 2, std::size_t{1}, std::size_t{0}, size}) {
      bytes.resize(smaller);
      EXPECT_EQ(bytes.size(), smaller);
      EXPECT_EQ(bytes.capacity(), size);
      EXPECT_EQ(bytes.data(), before);
    }
    for (std::size_t i = 0; i < size; ++i) ASSERT_EQ(bytes.data()[i], static_cast<std::byte>(i * 7)) << i;
  }
}

TEST(AlignedBytes, what_is_released_lies_above_all_bytes_that_are_kept) {
  constexpr std::size_t kCapacity = 12 * kMebibyte;
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, 2 * kMebibyte, 5 * kMebibyte + 1234, kCapacity}) {
    AlignedBytes bytes(kCapacity);
    std::memset(bytes.data(), 0x5A, kCapacity);
    bytes.resize(size);
    bytes.release_rest();
    std::size_t lost = 0;
    for (std::size_t i = 0; i < size; ++i) lost += bytes.data()[i] == std::byte{0x5A} ? 0U : 1U;
    EXPECT_EQ(lost, 0U) << size << " bytes are kept";
#ifdef __linux__  // on Linux, a released page reads as zero
    EXPECT_EQ(bytes.data()[kCapacity - 1], size == kCapacity ? std::byte{0x5A} : std::byte{0}) << size;
#endif
  }
}

TEST(AlignedBytes, moved_from_are_none) {
  AlignedBytes from(100);
  const std::byte* const data = from.data();
  AlignedBytes to(std::move(from));
  EXPECT_EQ(to.data(), data);
  EXPECT_EQ(to.size(), 100u);
  EXPECT_EQ(from.data(), nullptr);  // NOLINT(bugprone-use-after-move): what this test is about
  EXPECT_EQ(from.size() + from.capacity(), 0u);
  to = AlignedBytes(7);
  EXPECT_EQ(to.size(), 7u);
  EXPECT_EQ(to.capacity(), 7u);
}

TEST(AlignedBytes, more_than_there_can_be_throws) {
  if (test::is_sanitized()) GTEST_SKIP() << "the address sanitizer ends the program at such sizes";
  for (const std::size_t size : {kLargest, kLargest - 1, kLargest - 62, kLargest - 63, kLargest - 64,
                                 kLargest - 2 * kMebibyte, kLargest / 2, kLargest / 2 + 1})
    EXPECT_THROW(AlignedBytes{size}, std::bad_alloc) << size;
}

TEST(AlignedArray, holds_count_values) {
  AlignedArray<Vec3d> values(1001);
  EXPECT_EQ(values.size(), 1001u);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = {1.0 * static_cast<double>(i), 2, 3};
  const AlignedArray<Vec3d>& same = values;
  EXPECT_EQ(same[1000].x, 1000);
  EXPECT_EQ(same.data() + 1000, &same[1000]);
  EXPECT_EQ(AlignedArray<float>().size(), 0u);
}

TEST(AlignedArray, more_than_there_can_be_throws) {
  if (test::is_sanitized()) GTEST_SKIP() << "the address sanitizer ends the program at such sizes";
  // 2^61 doubles take 2^64 bytes, which overflows std::size_t to 0. The size of one more double overflows to 8.
  for (const std::size_t count : {std::size_t{1} << 61, (std::size_t{1} << 61) + 1, kLargest, kLargest / 8})
    EXPECT_THROW(AlignedArray<double>{count}, std::bad_alloc) << count;
}

}  // namespace
}  // namespace chronormal::memory_test
