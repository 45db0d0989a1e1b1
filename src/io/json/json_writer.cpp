#include "io/json/json_writer.h"

#include <array>
#include <cassert>
#include <cmath>

#include "core/charconv.h"

namespace chronormal::inline internal {
namespace {

template <class Number>
std::string shortest(Number value) {
  assert(std::isfinite(value));
  std::array<char, 32> digits{};
  return {digits.data(), to_chars(digits.data(), digits.data() + digits.size(), value).ptr};
}

}  // namespace

std::string quote_json(std::string_view text) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string result = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (byte < 0x20) {
      result += "\\u00";
      result += kDigits[byte >> 4];
      result += kDigits[byte & 15];
    } else {
      result += c;
    }
  }
  result += '"';
  return result;
}

std::string json_number(float value) { return shortest(value); }

std::string json_number(double value) { return shortest(value); }

JsonObject& JsonObject::add(std::string_view name, std::string_view json) {
  if (!empty()) text_ += ',';
  text_.append(quote_json(name)).append(":").append(json);
  return *this;
}

}  // namespace chronormal::inline internal
