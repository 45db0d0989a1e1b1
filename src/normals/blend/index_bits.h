/// Sets of indices as bits: dense sets for computing, and sparse sets for storage.
#ifndef CHRONORMAL_NORMALS_BLEND_INDEX_BITS_H_
#define CHRONORMAL_NORMALS_BLEND_INDEX_BITS_H_

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "chronormal/core/views.h"

namespace chronormal::inline internal {

inline constexpr std::size_t kBitsOfWord = 64;

[[nodiscard]] constexpr std::size_t words_of(std::size_t count) noexcept {
  return (count + kBitsOfWord - 1) / kBitsOfWord;
}

/// A sparse set of indices: the 64-bit words of its bits that are not zero, and the numbers of these words.
struct SparseBits {
  std::vector<std::uint32_t> places;  ///< numbers of the words, ascending
  std::vector<std::uint64_t> masks;

  [[nodiscard]] std::size_t bytes() const noexcept {
    return places.capacity() * sizeof(std::uint32_t) + masks.capacity() * sizeof(std::uint64_t);
  }
};

class IndexBits {
 public:
  IndexBits() = default;
  explicit IndexBits(std::size_t count) : words_(words_of(count)) {}

  void clear() noexcept {
    for (std::uint64_t& word : words_) word = 0;
  }
  void set(std::size_t i) noexcept { words_[i / kBitsOfWord] |= std::uint64_t{1} << (i % kBitsOfWord); }
  [[nodiscard]] bool has(std::size_t i) const noexcept {
    return (words_[i / kBitsOfWord] >> (i % kBitsOfWord) & 1) != 0;
  }

  /// Adds the indices from 0 to count - 1.
  void fill(std::size_t count) noexcept {
    for (std::size_t i = 0; i < words_.size(); ++i) {
      const std::size_t first = i * kBitsOfWord, left = count > first ? count - first : 0;
      words_[i] |= left >= kBitsOfWord ? ~std::uint64_t{0} : (std::uint64_t{1} << left) - 1;
    }
  }

  void add(const IndexBits& bits) noexcept {
    for (std::size_t i = 0; i < words_.size(); ++i) words_[i] |= bits.words_[i];
  }
  void add(const SparseBits& bits) noexcept {
    for (std::size_t i = 0; i < bits.places.size(); ++i) words_[bits.places[i]] |= bits.masks[i];
  }
  /// Adds the indices that are in both of two sets.
  void add_common(const SparseBits& a, const SparseBits& b) noexcept {
    for (std::size_t i = 0, j = 0; i < a.places.size() && j < b.places.size();) {
      if (a.places[i] == b.places[j]) words_[a.places[i]] |= a.masks[i] & b.masks[j];
      const bool first = a.places[i] <= b.places[j], second = b.places[j] <= a.places[i];
      i += first ? 1 : 0;
      j += second ? 1 : 0;
    }
  }

  [[nodiscard]] std::size_t count() const noexcept {
    std::size_t sum = 0;
    for (const std::uint64_t word : words_) sum += static_cast<std::size_t>(std::popcount(word));
    return sum;
  }
  [[nodiscard]] SparseBits sparse() const {
    SparseBits result;
    std::size_t used = 0;
    for (const std::uint64_t word : words_) used += word != 0 ? 1 : 0;
    result.places.reserve(used);
    result.masks.reserve(used);
    for (std::size_t i = 0; i < words_.size(); ++i) {
      if (words_[i] == 0) continue;
      result.places.push_back(static_cast<std::uint32_t>(i));
      result.masks.push_back(words_[i]);
    }
    return result;
  }

  [[nodiscard]] std::span<std::uint64_t> words() noexcept { return words_; }
  [[nodiscard]] std::span<const std::uint64_t> words() const noexcept { return words_; }
  [[nodiscard]] std::size_t bytes() const noexcept { return words_.capacity() * sizeof(std::uint64_t); }

 private:
  std::vector<std::uint64_t> words_;
};

/// Calls body(index) for each set bit of a word, in ascending order. `place` is the number of the word.
template <class Body>
void for_bits(std::uint64_t word, std::size_t place, const Body& body) {
  for (; word != 0; word &= word - 1) body(place * kBitsOfWord + static_cast<std::size_t>(std::countr_zero(word)));
}

/// Calls body(index) for each set bit of a range of words, in ascending order.
template <class Body>
void for_bits(std::span<const std::uint64_t> words, IndexRange places, const Body& body) {
  for (std::size_t i = places.first; i < places.end(); ++i) for_bits(words[i], i, body);
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_BLEND_INDEX_BITS_H_
