#include "core/text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/charconv.h"

namespace chronormal::inline internal {
namespace {

// Reads the first character of a text in UTF-8 (RFC 3629) and returns its number of bytes. Returns 0 if the text does
// not begin with valid UTF-8.
std::size_t length_of_character(std::string_view text, std::uint32_t& character) {
  const auto byte = [text](std::size_t i) { return static_cast<std::uint32_t>(static_cast<unsigned char>(text[i])); };
  const std::uint32_t first = byte(0);
  std::size_t length = 0;
  std::uint32_t smallest = 0;
  if (first < 0x80) {
    character = first;
    return 1;
  }
  if (first >> 5U == 0x6) {
    length = 2;
    smallest = 0x80;
  } else if (first >> 4U == 0xE) {
    length = 3;
    smallest = 0x800;
  } else if (first >> 3U == 0x1E) {
    length = 4;
    smallest = 0x10000;
  }
  if (length == 0 || text.size() < length) return 0;
  character = first & (0x7FU >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if (byte(i) >> 6U != 0x2) return 0;
    character = character << 6U | (byte(i) & 0x3FU);
  }
  const bool is_surrogate = character >= 0xD800 && character <= 0xDFFF;
  return character < smallest || character > 0x10FFFF || is_surrogate ? 0 : length;
}

bool is_safe(std::uint32_t c) {
  const bool controls = c < 0x20 || (c >= 0x7F && c <= 0x9F);
  const bool breaks_lines = c == 0x2028 || c == 0x2029;
  const bool turns = c == 0x61C || (c >= 0x200B && c <= 0x200F) || (c >= 0x202A && c <= 0x202E) ||
                     (c >= 0x2066 && c <= 0x2069) || c == 0xFEFF;
  return !controls && !breaks_lines && !turns;
}

std::string hexadecimal(std::uint32_t value, std::size_t digits) {
  std::string text(digits, '0');
  for (std::size_t i = digits; i-- > 0; value >>= 4U) text[i] = "0123456789abcdef"[value & 0xFU];
  return text;
}

// Returns the number of characters, not of bytes, of a text in UTF-8.
std::size_t characters_of(std::string_view text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

std::string digits_of(double value, std::chars_format format, int precision) {
  if (!std::isfinite(value)) return "-";
  std::array<char, 400> text{};  // the largest double has 309 digits before the point
  return {text.data(), to_chars(text.data(), text.data() + text.size(), value, format, precision).ptr};
}

}  // namespace

std::string printable(std::string_view text, std::size_t most) {
  std::vector<std::string> pieces;
  for (std::size_t at = 0; at < text.size();) {
    std::uint32_t character = 0;
    const std::size_t length = length_of_character(text.substr(at), character);
    const bool keep = length > 0 && is_safe(character);
    std::string piece(keep ? text.substr(at, length) : "");
    for (std::size_t i = 0; !keep && i < (length == 0 ? 1 : length); ++i)
      piece += "\\x" + hexadecimal(static_cast<unsigned char>(text[at + i]), 2);
    pieces.push_back(std::move(piece));
    at += length == 0 ? 1 : length;
  }
  std::size_t width = 0;
  for (const std::string& piece : pieces) width += characters_of(piece);
  if (width > most) {
    while (!pieces.empty() && width + 3 > most) {
      width -= characters_of(pieces.back());
      pieces.pop_back();
    }
    pieces.emplace_back("...");
  }
  std::string result;
  for (const std::string& piece : pieces) result += piece;
  return result;
}

std::string escaped_for_json(std::string_view document) {
  std::string result;
  for (std::size_t at = 0; at < document.size();) {
    std::uint32_t character = 0;
    const std::size_t length = length_of_character(document.substr(at), character);
    if (length > 1 && !is_safe(character))
      result += "\\u" + hexadecimal(character, 4);
    else if (length == 1 && character == 0x7F)
      result += "\\u007f";
    else
      result += document.substr(at, std::max<std::size_t>(length, 1));
    at += std::max<std::size_t>(length, 1);
  }
  return result;
}

std::string grouped(std::uint64_t value) {
  std::string digits = std::to_string(value);
  for (std::size_t i = digits.size(); i > 3;) {
    i -= 3;
    digits.insert(i, 1, ',');
  }
  return digits;
}

std::string counted(std::uint64_t count, std::string_view singular, std::string_view plural) {
  return grouped(count).append(1, ' ').append(count == 1 ? singular : plural);
}

std::string with_decimals(double value, int decimals) { return digits_of(value, std::chars_format::fixed, decimals); }

std::string with_digits(double value, int digits) { return digits_of(value, std::chars_format::general, digits); }

std::string with_degrees(std::string angle) {
  const bool is_one = angle == "1";
  return std::move(angle) + (is_one ? " degree" : " degrees");
}

std::string rounded_text(double value, std::initializer_list<double> others) {
  constexpr int kFewest = 6, kAll = 17;  // kAll digits tell any two doubles apart
  constexpr std::size_t kShort = 8;
  std::array<char, 32> shortest{};
  const auto end = to_chars(shortest.data(), shortest.data() + shortest.size(), value).ptr;
  const std::string text(shortest.data(), end);
  if (!std::isfinite(value) || text.size() <= kShort) return text;
  for (int digits = kFewest; digits < kAll; ++digits) {
    std::string rounded = with_digits(value, digits);
    const auto is_same = [&](double other) { return other != value && with_digits(other, digits) == rounded; };
    if (std::none_of(others.begin(), others.end(), is_same)) return rounded;
  }
  return text;
}

}  // namespace chronormal::inline internal
