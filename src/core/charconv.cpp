#include "core/charconv.h"

#ifndef __cpp_lib_to_chars
// The next part is for the two files that tools/two_files.py makes. These files are built without fmt, and format
// numbers only for messages.
#ifdef CHRONORMAL_ALONE

#include <cstdio>
#include <cstdlib>

namespace chronormal::inline internal {
namespace {

std::to_chars_result print(char* first, char* last, const char* format, int precision, double value) {
  const auto room = static_cast<std::size_t>(last - first);
  const int count = std::snprintf(first, room, format, precision, value);
  if (count < 0 || static_cast<std::size_t>(count) >= room) return {last, std::errc::value_too_large};
  return {first + count, std::errc()};
}

}  // namespace

std::to_chars_result to_chars(char* first, char* last, double value) {
  std::to_chars_result result{};
  for (int digits = 1; digits <= 17; ++digits) {
    result = print(first, last, "%.*g", digits, value);
    if (result.ec != std::errc() || std::strtod(first, nullptr) == value) break;
  }
  return result;
}
std::to_chars_result to_chars(char* first, char* last, double value, std::chars_format format, int precision) {
  return print(first, last, format == std::chars_format::fixed ? "%.*f" : "%.*g", precision, value);
}

}  // namespace chronormal::inline internal

#else

#include <fast_float/fast_float.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

namespace chronormal::inline internal {
namespace {

template <class Number>
std::from_chars_result read(const char* first, const char* last, Number& value) noexcept {
  const fast_float::from_chars_result result = fast_float::from_chars(first, last, value);
  return {result.ptr, result.ec};
}

std::to_chars_result put(char* first, char* last, std::string_view text) {
  if (text.size() > static_cast<std::size_t>(last - first)) return {last, std::errc::value_too_large};
  return {std::copy(text.begin(), text.end(), first), std::errc()};
}

// Formats a number like std::to_chars(): in scientific or fixed notation, whichever is shorter, or in fixed notation if
// both texts have the same length. fmt provides only the digits, and this function places the point and the exponent.
template <class Number>
std::to_chars_result shortest(char* first, char* last, Number value) {
  const std::string found = fmt::format("{}", value);
  if (!std::isfinite(value) || value == 0)
    return put(first, last, value == 0 ? (std::signbit(value) ? "-0" : "0") : found);
  const std::string sign = std::signbit(value) ? "-" : "";
  const std::string_view number = std::string_view(found).substr(sign.size());
  const std::size_t e = std::min(number.find('e'), number.size());
  const std::string_view mantissa = number.substr(0, e);
  const std::size_t point = std::min(mantissa.find('.'), mantissa.size());
  std::string digits(mantissa.substr(0, point));
  if (point < mantissa.size()) digits += mantissa.substr(point + 1);
  // The number is 0.DIGITS times 10^before_point.
  int before_point = static_cast<int>(point) + (e < number.size() ? std::atoi(number.data() + e + 1) : 0);
  const std::size_t zeros = digits.find_first_not_of('0');
  before_point -= static_cast<int>(zeros);
  digits.erase(0, zeros);
  digits.erase(digits.find_last_not_of('0') + 1);

  const int count = static_cast<int>(digits.size()), exponent = before_point - 1;
  std::string scientific = digits.substr(0, 1);
  if (count > 1) scientific += '.' + digits.substr(1);
  scientific += fmt::format("e{}{:02}", exponent < 0 ? '-' : '+', std::abs(exponent));
  std::string fixed;
  if (before_point <= 0) {
    fixed = "0." + std::string(static_cast<std::size_t>(-before_point), '0') + digits;
  } else if (before_point >= count) {
    // The number is an integer with more digits than are needed to tell this number from others. All digits are
    // printed, without zeros in place of the last digits.
    fixed = fmt::format("{:.0f}", value).substr(sign.size());
  } else {
    fixed = digits.substr(0, static_cast<std::size_t>(before_point)) + '.' +
            digits.substr(static_cast<std::size_t>(before_point));
  }
  return put(first, last, sign + (fixed.size() <= scientific.size() ? fixed : scientific));
}

}  // namespace

std::from_chars_result from_chars(const char* first, const char* last, float& value) noexcept {
  return read(first, last, value);
}
std::from_chars_result from_chars(const char* first, const char* last, double& value) noexcept {
  return read(first, last, value);
}
std::to_chars_result to_chars(char* first, char* last, float value) { return shortest(first, last, value); }
std::to_chars_result to_chars(char* first, char* last, double value) { return shortest(first, last, value); }
std::to_chars_result to_chars(char* first, char* last, double value, std::chars_format format, int precision) {
  if (format == std::chars_format::fixed) return put(first, last, fmt::format("{:.{}f}", value, precision));
  if (format == std::chars_format::general) return put(first, last, fmt::format("{:.{}g}", value, precision));
  return put(first, last, fmt::format("{:.{}e}", value, precision));
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ALONE
#endif
