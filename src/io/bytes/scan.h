/// Splits text into lines, words and numbers, for the readers of all text formats. Private to io.
#ifndef CHRONORMAL_IO_BYTES_SCAN_H_
#define CHRONORMAL_IO_BYTES_SCAN_H_

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "chronormal/core/result.h"
#include "core/charconv.h"

namespace chronormal::inline internal::scan {

/// Returns true for a blank inside a line. CR counts as a blank, so lines that end in CRLF need no special case.
[[nodiscard]] constexpr bool is_blank(char c) noexcept {
  return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

[[nodiscard]] constexpr bool is_digit(char c) noexcept { return c >= '0' && c <= '9'; }

/// Checks that bytes may be text: a text has no 4096 zero bytes in a row. Sparse files have zero bytes wherever nothing
/// was ever written, and may seem to be a terabyte long, so sparse files must be refused before line ends are searched.
/// Errors: kInvalidInput with the place "NAME, byte N".
[[nodiscard]] Status check_text(std::string_view bytes, const std::string& name);

/// An iterator over the lines of a text, without their line ends. Lines are counted from 1.
class Lines {
 public:
  /// Begins at the first line. `separator` ends a line: '\n' (which also handles CRLF) or '\r'.
  Lines(std::string_view text, char separator) noexcept : text_(text), separator_(separator) {}

  /// Moves to the next line; returns false at the end of the text.
  [[nodiscard]] bool next() noexcept {
    if (position_ >= text_.size()) return false;
    const std::size_t end = text_.find(separator_, position_);
    line_ = text_.substr(position_, end == std::string_view::npos ? end : end - position_);
    position_ = end == std::string_view::npos ? text_.size() : end + 1;
    ++number_;
    return true;
  }

  [[nodiscard]] std::string_view line() const noexcept { return line_; }
  [[nodiscard]] std::size_t number() const noexcept { return number_; }
  /// Returns the offset of the first byte behind the line and its line end.
  [[nodiscard]] std::size_t position() const noexcept { return position_; }

 private:
  std::string_view text_;
  std::string_view line_;
  std::size_t position_ = 0;
  std::size_t number_ = 0;
  char separator_;
};

/// Takes the next word off the front of a line; returns an empty word at the end of the line.
[[nodiscard]] inline std::string_view take_word(std::string_view& line) noexcept {
  std::size_t first = 0;
  while (first < line.size() && is_blank(line[first])) ++first;
  std::size_t end = first;
  while (end < line.size() && !is_blank(line[end])) ++end;
  const std::string_view word = line.substr(first, end - first);
  line.remove_prefix(end);
  return word;
}

enum class NumberFault { kNone, kNotANumber, kNotFinite, kTooLarge };

/// Reads the whole word as a float32, rounded to nearest. A number that is too small becomes a denormal or 0.
[[nodiscard]] NumberFault parse_float(std::string_view word, float& value) noexcept;

/// Reads the whole word as a double in the range of float32. `last_digit` gets the value of a 1 in the place of the
/// word's last decimal digit: 0.001 for "1.250".
[[nodiscard]] NumberFault parse_double(std::string_view word, double& value, double& last_digit);

/// Takes the next word off a line if the word is a decimal number without an exponent, and short enough to be converted
/// exactly by a division or multiplication of two doubles. The result equals that of parse_float(), but takes less
/// time. For any other word, returns false and leaves the line unchanged.
[[nodiscard]] bool take_plain_float(std::string_view& line, float& value) noexcept;

/// Reads the whole word as an integer.
[[nodiscard]] NumberFault parse_integer(std::string_view word, std::int64_t& value) noexcept;

/// Returns a word in quotes for a message. Long words are cut short, and control characters are removed.
[[nodiscard]] std::string quoted(std::string_view word);

/// Returns the reason why a word did not parse: "'abc' is not a number".
[[nodiscard]] std::string describe(NumberFault fault, std::string_view word);

/// Appends a number with the fewest digits from which the same number is read back.
template <class Number>
void append_number(std::string& text, Number number) {
  char digits[32];
  text.append(digits, to_chars(digits, digits + sizeof digits, number).ptr);
}

}  // namespace chronormal::inline internal::scan

#endif  // CHRONORMAL_IO_BYTES_SCAN_H_
