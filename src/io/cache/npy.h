/// A NumPy array: a header in Python syntax, and its elements. Private to io.
///
///     "\x93NUMPY"  version 1.0  uint16 length   {'descr': '<f4', 'fortran_order': False, 'shape': (2, 3, 3), }
///     elements
#ifndef CHRONORMAL_IO_CACHE_NPY_H_
#define CHRONORMAL_IO_CACHE_NPY_H_

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/core/result.h"

namespace chronormal::inline internal::npy {

enum class Kind : char { kFloat = 'f', kInteger = 'i', kUnsigned = 'u', kText = 'U', kBytes = 'S' };

/// The bytes with which every .npy file begins.
inline constexpr std::string_view kFirstWord("\x93NUMPY", 6);

/// The longest header that is read. NumPy's own default limit is 10,000 bytes.
constexpr std::size_t kLongestHeader = 65536;

struct Array {
  Kind kind{};
  /// bytes of an element: 1, 2, 4 or 8 for integers, 4 or 8 for floats, 1 or 4 for each character of text
  std::size_t item_size = 0;
  std::endian order = std::endian::little;
  bool is_fortran = false;
  std::vector<std::uint64_t> shape;
  std::size_t data_begin = 0;  ///< offset of the first element
  std::string_view data;       ///< the elements; set by the caller

  [[nodiscard]] std::uint64_t element_count() const noexcept {
    std::uint64_t count = 1;
    for (const std::uint64_t length : shape) count *= length;
    return count;
  }
  /// Returns the offset of the first byte after the last element.
  [[nodiscard]] std::uint64_t data_end() const noexcept { return data_begin + element_count() * item_size; }
  /// Return the element at index `item`. The array must have the kind that is named behind each function.
  [[nodiscard]] double real(std::size_t item) const noexcept;  ///< for kFloat
  /// Returns an element of a kind other than kFloat as the index of a vertex; 2^64 - 1 stands for a negative element.
  [[nodiscard]] std::uint64_t vertex(std::size_t item) const noexcept;
  [[nodiscard]] std::int64_t integer(std::size_t item) const noexcept;  ///< for kInteger

  /// Returns the shape and the type for messages: "(2, 3, 3) of '<f4'".
  [[nodiscard]] std::string text() const;
};

/// Reads an array that is a single string of ASCII ("<U7", "|S7"). `bytes` is the whole .npy file. Errors:
/// kInvalidInput at `place`.
[[nodiscard]] Result<std::string> read_text(std::string_view bytes, const std::string& place);

/// Returns a .npy file with a single string.
[[nodiscard]] std::string write_text(std::string_view text);

/// Reads the header of a .npy file of total_size bytes. `start` is the beginning of the file: all bytes, or the first
/// kLongestHeader + 12. If there is no error, the product of the sizes in `shape` does not overflow, and the elements
/// fill the bytes from data_begin to data_end() exactly. Bytes behind data_end() are refused unless more_may_follow is
/// true. Errors: kInvalidInput with `place`, and a message that says what is wrong.
[[nodiscard]] Result<Array> read_header(std::string_view start, std::uint64_t total_size, const std::string& place,
                                        bool more_may_follow = false);

/// Returns the header of an array in C order, padded so that the elements are aligned to 64 bytes.
[[nodiscard]] std::string write_header(std::string_view type, const std::vector<std::uint64_t>& shape);

}  // namespace chronormal::inline internal::npy

#endif  // CHRONORMAL_IO_CACHE_NPY_H_
