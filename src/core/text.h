/// Makes texts for people and programs: counts with their nouns, numbers, and names from files that are safe to print.
#ifndef CHRONORMAL_CORE_TEXT_H_
#define CHRONORMAL_CORE_TEXT_H_

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>

namespace chronormal::inline internal {

/// Makes a name from a file safe to print, since a file may contain any bytes. Control characters, characters that
/// change the writing direction, and bytes that are not UTF-8 become \xNN. A text longer than `most` characters is cut
/// and ends in "...". Precondition: `most` is at least 4.
[[nodiscard]] std::string printable(std::string_view text, std::size_t most = static_cast<std::size_t>(-1));

/// Returns the text of a JSON document in UTF-8, in which unsafe characters inside strings are written as \uNNNN. Line
/// ends outside of strings stay.
[[nodiscard]] std::string escaped_for_json(std::string_view document);

/// Returns a number with commas between groups of three digits: 1234567 becomes "1,234,567".
[[nodiscard]] std::string grouped(std::uint64_t value);

/// Returns a count with its noun in the right number: "1 face", "1,234 faces".
[[nodiscard]] std::string counted(std::uint64_t count, std::string_view singular, std::string_view plural);

/// Returns a number for messages in the way that people write it: 0.3 for 0.30000000000000004. The text has six
/// significant digits, or as many as are needed to tell the number from the numbers `others` in the same message. A
/// number that takes up to eight characters is not rounded.
[[nodiscard]] std::string rounded_text(double value, std::initializer_list<double> others = {});

/// Format a number. with_decimals() writes a fixed number of digits after the point. with_digits() writes significant
/// digits, without trailing zeros. Both return "-" for infinity and NaN.
[[nodiscard]] std::string with_decimals(double value, int decimals);
[[nodiscard]] std::string with_digits(double value, int digits);

/// Returns the text of an angle with its unit in the right number: "1 degree", "0.5 degrees", "1.00 degrees".
[[nodiscard]] std::string with_degrees(std::string angle);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_CORE_TEXT_H_
