/// Conversions of numbers from and to text, like <charconv>. Some standard libraries do not support floating point yet
/// (libc++ 13, which the wasm module uses): then fast_float reads and fmt writes the same characters. Private.
///
/// Libraries differ for numbers out of range: from_chars() returns result_out_of_range, or an infinite number or
/// 0. Callers must expect both.
#ifndef CHRONORMAL_CORE_CHARCONV_H_
#define CHRONORMAL_CORE_CHARCONV_H_

#include <charconv>

namespace chronormal::inline internal {

using std::from_chars;
using std::to_chars;

#ifndef __cpp_lib_to_chars
[[nodiscard]] std::from_chars_result from_chars(const char* first, const char* last, float& value) noexcept;
[[nodiscard]] std::from_chars_result from_chars(const char* first, const char* last, double& value) noexcept;
/// Writes the fewest digits that read back as the same number, in the shorter of both notations.
[[nodiscard]] std::to_chars_result to_chars(char* first, char* last, float value);
[[nodiscard]] std::to_chars_result to_chars(char* first, char* last, double value);
/// Writes `precision` digits: after the point, or in all if the format is `general`.
[[nodiscard]] std::to_chars_result to_chars(char* first, char* last, double value, std::chars_format format,
                                            int precision);
#endif

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_CORE_CHARCONV_H_
