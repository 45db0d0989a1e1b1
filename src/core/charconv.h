/// Conversions of numbers from and to text, like <charconv>. Some standard libraries do not support floating point yet
/// (libc++ 13, which the wasm module uses): then fast_float reads and fmt writes the same characters. Private.
///
/// Libraries differ for numbers out of range: from_chars() returns result_out_of_range, or an infinite number or
/// 0. Callers must expect both.
#ifndef CHRONORMAL_CORE_CHARCONV_H_
#define CHRONORMAL_CORE_CHARCONV_H_

#include <charconv>
#include <concepts>

namespace chronormal::inline internal {

#ifdef __cpp_lib_to_chars
using std::from_chars;
using std::to_chars;
#else
// Leaves only integers to the standard library. Its names are not imported, since it may have some of the functions for
// floating point.
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
/// Writes the fewest digits from which the same number is read back, in scientific or fixed notation, whichever is
/// shorter.
[[nodiscard]] std::to_chars_result to_chars(char* first, char* last, float value);
[[nodiscard]] std::to_chars_result to_chars(char* first, char* last, double value);
/// Writes `precision` digits: after the point, or in all if the format is `general`.
[[nodiscard]] std::to_chars_result to_chars(char* first, char* last, double value, std::chars_format format,
                                            int precision);
#endif

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_CORE_CHARCONV_H_
