/// Converts numbers from and to text, like <charconv>. Some standard libraries cannot convert floating-point numbers
/// yet (libc++ 13, which the wasm module uses). With such a library, fast_float reads numbers, and fmt writes the same
/// characters as <charconv>.
///
/// For numbers out of range, libraries differ: from_chars() returns result_out_of_range, or an infinite number or 0.
/// Callers must expect all of these.
#ifndef CHRONORMAL_CORE_CHARCONV_H_
#define CHRONORMAL_CORE_CHARCONV_H_

#include <charconv>
#include <concepts>

namespace chronormal::inline internal {

#ifdef __cpp_lib_to_chars
using std::from_chars;
using std::to_chars;
#else
// Reads an integer by the standard library. The names of std are not imported, since std may have some of the functions
// for floating-point numbers.
template <std::integral T>
[[nodiscard]] std::from_chars_result from_chars(const char* first, const char* last, T& value, int base = 10) {
  return std::from_chars(first, last, value, base);
}
template <std::integral T>
[[nodiscard]] std::to_chars_result to_chars(char* first, char* last, T value, int base = 10) {
  return std::to_chars(first, last, value, base);
}
[[nodiscard]] std::from_chars_result from_chars(const char* first, const char* last, float& value) noexcept;
[[nodiscard]] std::from_chars_result from_chars(const char* first, const char* last, double& value) noexcept;
/// Write a number with the fewest digits from which the same number is read back. The text has scientific or fixed
/// notation, whichever is shorter.
[[nodiscard]] std::to_chars_result to_chars(char* first, char* last, float value);
[[nodiscard]] std::to_chars_result to_chars(char* first, char* last, double value);
/// Writes a number with `precision` digits after the point, or with `precision` digits in total if the format is
/// `general`.
[[nodiscard]] std::to_chars_result to_chars(char* first, char* last, double value, std::chars_format format,
                                            int precision);
#endif

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_CORE_CHARCONV_H_
