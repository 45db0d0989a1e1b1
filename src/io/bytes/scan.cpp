// Parses numbers. Plain decimal numbers take a fast path, and slower functions parse all others.
#include "io/bytes/scan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <system_error>

#include "core/bits.h"
#include "core/charconv.h"
#include "io/bytes/binary.h"

namespace chronormal::inline internal::scan {
namespace {

// Drops a plus sign, which std::from_chars does not accept.
std::string_view without_plus(std::string_view word) noexcept {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-' && word[1] != '+') word.remove_prefix(1);
  return word;
}

// Tells why std::from_chars found a number out of range. Returns true if the number is too large, and false if it is
// too small. Such a number is so far from 1 that the decimal exponent of its first nonzero digit decides: a positive
// exponent means too large.
bool is_large(std::string_view number) noexcept {
  constexpr std::int64_t kFar = std::int64_t{1} << 40;
  const std::size_t exponent_at = number.find_first_of("eE");
  std::int64_t exponent = 0;
  if (exponent_at != std::string_view::npos) {
    const std::string_view digits = without_plus(number.substr(exponent_at + 1));
    if (parse_integer(digits, exponent) == NumberFault::kTooLarge) exponent = digits.front() == '-' ? -kFar : kFar;
    if (exponent > kFar) exponent = kFar;
    if (exponent < -kFar) exponent = -kFar;
  }
  std::int64_t whole_digits = 0, zeros = 0;  // digits before the point, and zeros before the first nonzero digit
  bool after_point = false, significant = false;
  for (const char c : number.substr(0, exponent_at)) {
    if (c == '.') after_point = true;
    if (!is_digit(c)) continue;
    if (!after_point) ++whole_digits;
    significant = significant || c != '0';
    if (!significant) ++zeros;
  }
  return significant && whole_digits - zeros - 1 + exponent > 0;
}

}  // namespace

Status check_text(std::string_view bytes, const std::string& name) {
  constexpr std::size_t kPage = 4096;
  for (std::size_t at = bytes.find('\0'); at != std::string_view::npos; at = bytes.find('\0', at)) {
    const std::string_view page = bytes.substr(at, kPage);
    const std::size_t zeros = std::min(page.find_first_not_of('\0'), page.size());
    if (zeros == kPage)
      return invalid_input(binary::place(name, at),
                           "this is not a text file, or it is damaged, since thousands of zero bytes begin here; copy "
                           "or export the file again");
    at += zeros;
  }
  return Success{};
}

NumberFault parse_float(std::string_view word, float& value) noexcept {
  word = without_plus(word);
  const char* const last = word.data() + word.size();
  const auto [end, code] = from_chars(word.data(), last, value);
  if (code == std::errc::invalid_argument || end != last) return NumberFault::kNotANumber;
  if (code == std::errc::result_out_of_range) {
    if (is_large(word)) return NumberFault::kTooLarge;
    double wide = 0;
    const bool tiny = from_chars(word.data(), last, wide).ec == std::errc::result_out_of_range;
    value = tiny ? std::copysign(0.0F, word.front() == '-' ? -1.0F : 1.0F) : static_cast<float>(wide);
    return NumberFault::kNone;
  }
  if (std::isfinite(value)) return NumberFault::kNone;
  // A word with the letter n is nan, inf or infinity. Any other word here is a number in digits that is too large.
  const bool spelt = word.find_first_of("nN") != std::string_view::npos;
  return spelt ? NumberFault::kNotFinite : NumberFault::kTooLarge;
}

NumberFault parse_double(std::string_view word, double& value, double& last_digit) {
  float rounded = 0;
  const NumberFault fault = parse_float(word, rounded);
  if (fault != NumberFault::kNone) return fault;
  word = without_plus(word);
  // The float32 value stays if from_chars() finds the number too small for a double.
  value = double{rounded};
  double wide = 0;
  if (from_chars(word.data(), word.data() + word.size(), wide).ec == std::errc{}) value = wide;
  const std::size_t power = std::min(word.find_first_of("eE"), word.size()), point = word.substr(0, power).find('.');
  std::int64_t exponent = 0;
  if (power < word.size()) (void)parse_integer(word.substr(power + 1), exponent);
  if (point != std::string_view::npos) exponent -= static_cast<std::int64_t>(power - point - 1);
  const std::string power_of_ten = "1e" + std::to_string(exponent);
  last_digit = 0;
  (void)from_chars(power_of_ten.data(), power_of_ten.data() + power_of_ten.size(), last_digit);
  return NumberFault::kNone;
}

// Takes a plain number by the fast path. If w is an integer of at most 53 bits and p is at most 22, w / 10^p and w 10^p
// are correctly rounded doubles (Clinger 1990). Rounding such a double to float gives the right result, unless the
// double lies exactly in the middle between two floats, because the first rounding may have moved it there.
bool take_plain_float(std::string_view& line, float& value) noexcept {
  static constexpr double kPowers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                       1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  constexpr std::uint64_t kLargestExact = std::uint64_t{1} << 53;
  constexpr int kMostDigits = 19, kMostPower = 22;
  const char* at = line.data();
  const char* const end = at + line.size();
  while (at != end && is_blank(*at)) ++at;
  const bool negative = at != end && *at == '-';
  if (negative) ++at;
  std::uint64_t whole = 0;
  int digits = 0, power = 0;
  const auto take_digits = [&] {
    for (; at != end && is_digit(*at); ++at, ++digits) whole = 10 * whole + static_cast<std::uint64_t>(*at - '0');
  };
  take_digits();
  if (at != end && *at == '.') {
    ++at;
    const int before = digits;
    take_digits();
    power = before - digits;
  }
  if (digits == 0 || digits > kMostDigits || whole > kLargestExact) return false;
  if (at != end && (*at == 'e' || *at == 'E')) {
    ++at;
    const bool is_small = at != end && *at == '-';
    if (at != end && (*at == '-' || *at == '+')) ++at;
    int exponent = 0, exponent_digits = 0;
    for (; at != end && is_digit(*at) && exponent_digits < 4; ++at, ++exponent_digits)
      exponent = 10 * exponent + (*at - '0');
    if (exponent_digits == 0) return false;
    power += is_small ? -exponent : exponent;
  }
  if ((at != end && !is_blank(*at)) || power < -kMostPower || power > kMostPower) return false;
  double magnitude = static_cast<double>(whole);
  magnitude = power < 0 ? magnitude / kPowers[-power] : magnitude * kPowers[power];
  constexpr std::uint64_t kBelowFloat = (std::uint64_t{1} << 29) - 1, kMiddle = std::uint64_t{1} << 28;
  const bool is_normal =
      magnitude >= double{std::numeric_limits<float>::min()} && magnitude < double{std::numeric_limits<float>::max()};
  if (whole != 0 && (!is_normal || (bit_cast<std::uint64_t>(magnitude) & kBelowFloat) == kMiddle)) return false;
  value = static_cast<float>(negative ? -magnitude : magnitude);
  line.remove_prefix(static_cast<std::size_t>(at - line.data()));
  return true;
}

NumberFault parse_integer(std::string_view word, std::int64_t& value) noexcept {
  word = without_plus(word);
  const char* const last = word.data() + word.size();
  const auto [end, code] = from_chars(word.data(), last, value);
  if (code == std::errc::invalid_argument || end != last) return NumberFault::kNotANumber;
  return code == std::errc::result_out_of_range ? NumberFault::kTooLarge : NumberFault::kNone;
}

std::string quoted(std::string_view word) {
  constexpr std::size_t kLongest = 40;
  std::string text = "'";
  for (const char c : word.substr(0, kLongest)) text += c >= ' ' && c <= '~' ? c : '?';
  text += word.size() > kLongest ? "...'" : "'";
  return text;
}

std::string describe(NumberFault fault, std::string_view word) {
  if (word.empty()) return "a number is missing here; add it, or export the file again";
  switch (fault) {
    case NumberFault::kNotFinite:
      return quoted(word) + " is NaN or infinite; write a finite number";
    case NumberFault::kTooLarge:
      return quoted(word) + " is too large for float32; write a smaller number";
    case NumberFault::kNotANumber:
    case NumberFault::kNone:
      break;
  }
  return quoted(word) + " is not a valid number here; correct it, or export the file again";
}

}  // namespace chronormal::inline internal::scan
