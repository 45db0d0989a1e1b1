/// Texts for people and programs: words with counts, and names from files, which are made safe to print. Private.
#ifndef CHRONORMAL_CORE_TEXT_H_
#define CHRONORMAL_CORE_TEXT_H_

#include <cstddef>
#include <initializer_list>
#include <string>
#include <string_view>

namespace chronormal::inline internal {

/// Makes a name from a file safe to print, since a file may contain any bytes. Control characters, characters that
/// change the writing direction, and bytes that are not UTF-8 become \xNN. A text longer than `most` characters is cut
/// and ends in "...". 4 <= most
[[nodiscard]] std::string printable(std::string_view text, std::size_t most = static_cast<std::size_t>(-1));

/// Returns the text of a JSON document, in UTF-8, with unsafe characters as \uNNNN inside its strings. Line ends stay.
[[nodiscard]] std::string escaped_for_json(std::string_view document);

/// Returns 1234567 as "1,234,567".
[[nodiscard]] std::string grouped(std::size_t value);

/// Returns a count with its noun: "1 face", "1,234 faces".
[[nodiscard]] std::string counted(std::size_t count, const char* singular, const char* plural);

/// Returns a number in the way that people write it, for messages: 0.3 for 0.30000000000000004. It has six significant
/// digits, or as many as are needed to distinguish it from `others` in the same message. A number of up to eight
/// characters is not rounded.
[[nodiscard]] std::string rounded_text(double value, std::initializer_list<double> others = {});

/// Format a number. with_decimals: fixed point. with_digits: significant digits, without trailing zeros. Both return
/// "-" for infinity and NaN.
[[nodiscard]] std::string with_decimals(double value, int decimals);
[[nodiscard]] std::string with_digits(double value, int digits);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_CORE_TEXT_H_
