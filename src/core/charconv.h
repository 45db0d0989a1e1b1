/// Numbers from text and to text, as <charconv> has them, also where the standard library has none for floating point
/// yet (libc++ 13, with which the wasm module is built): then the first comes from fast_float and the second from fmt,
/// with the same characters. Private.
///
/// Where a number is out of range, from_chars() of some libraries returns result_out_of_range, and that of others an
/// infinite number or 0: callers expect both.
#ifndef CHRONORMAL_CORE_CHARCONV_H_
#define CHRONORMAL_CORE_CHARCONV_H_

#include <charconv>

namespace chronormal::inline internal {

using std::from_chars;
using std::to_chars;

#ifndef __cpp_lib_to_chars
[[nodiscard]] std::from_chars_result from_chars(const char* first, const char* last, float& value) noexcept;
[[nodiscard]] std::from_chars_result from_chars(const char* first, const char* last, double& value) noexcept;
/// The fewest digits that read back as the same number, in the shorter of both notations.
[[nodiscard]] std::to_chars_result to_chars(char* first, char* last, float value);
[[nodiscard]] std::to_chars_result to_chars(char* first, char* last, double value);
/// So many digits: after the point, or of the format `general` in all.
[[nodiscard]] std::to_chars_result to_chars(char* first, char* last, double value, std::chars_format format,
                                            int precision);
#endif

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_CORE_CHARCONV_H_
