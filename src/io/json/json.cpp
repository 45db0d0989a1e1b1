#include "io/json/json.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <system_error>

#include "core/charconv.h"
#include "io/bytes/binary.h"
#include "io/json/json_text.h"

namespace chronormal::inline internal {
namespace {

// Returns true if a text is a number as JSON writes numbers.
bool is_number(std::string_view text) {
  const auto skip_digits = [&] {
    const std::size_t count = std::min(text.find_first_not_of("0123456789"), text.size());
    text.remove_prefix(count);
    return count;
  };
  if (text.starts_with('-')) text.remove_prefix(1);
  const bool begins_with_zero = text.starts_with('0');
  const std::size_t digits = skip_digits();
  if (digits == 0 || (begins_with_zero && digits > 1)) return false;
  if (text.starts_with('.')) {
    text.remove_prefix(1);
    if (skip_digits() == 0) return false;
  }
  if (text.starts_with('e') || text.starts_with('E')) {
    text.remove_prefix(1);
    if (text.starts_with('+') || text.starts_with('-')) text.remove_prefix(1);
    if (skip_digits() == 0) return false;
  }
  return text.empty();
}

// Returns true if a number is too large for double. Returns false for a number that is too small for double, which
// becomes 0.
bool overflows(std::string_view number) {
  constexpr std::size_t kMostDigits = 308;  // the largest double has one digit more
  const std::size_t exponent_at = std::min(number.find_first_of("eE"), number.size());
  if (exponent_at == number.size() && number.size() <= kMostDigits) return false;
  double value = 0;
  const auto [stop, code] = from_chars(number.data(), number.data() + number.size(), value);
  if (code == std::errc()) return std::isinf(value);
  if (code != std::errc::result_out_of_range) return false;
  // from_chars() tells only that the number is out of range. The decimal exponent of its first nonzero digit tells if
  // the number is too large or too small. This exponent is the written exponent plus the place of the digit relative to
  // the decimal point.
  const std::string_view mantissa = number.substr(0, exponent_at);
  const auto first = static_cast<std::ptrdiff_t>(mantissa.find_first_of("123456789"));
  const auto point = static_cast<std::ptrdiff_t>(std::min(mantissa.find('.'), mantissa.size()));
  std::string_view digits = number.substr(std::min(exponent_at + 1, number.size()));
  if (digits.starts_with('+')) digits.remove_prefix(1);
  std::int64_t exponent = 0;
  if (!digits.empty() && from_chars(digits.data(), digits.data() + digits.size(), exponent).ec != std::errc())
    return digits.front() != '-';
  // Clamping the exponent avoids overflow. An exponent so far from 0 outweighs any number of digits that a text can
  // have.
  constexpr std::int64_t kFar = std::int64_t{1} << 40;
  return std::clamp(exponent, -kFar, kFar) + (point - first) > 0;
}

// The result of a scan of the text, which is made before the tree of values is built.
struct Scan {
  std::size_t too_deep = std::string_view::npos;  // offset of the first byte that is nested deeper than allowed
  struct Number {
    std::size_t begin, end;
    std::size_t nulls;  // number of nulls in the text before this number
  };
  std::vector<Number> too_large;  // numbers that are too large for double
};

Scan scan_json(std::string_view text) {
  Scan result;
  std::size_t depth = 0, nulls = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') {
      for (++i; i < text.size() && text[i] != '"'; ++i) {
        if (text[i] == '\\') ++i;
      }
    } else if (c == '[' || c == '{') {
      if (++depth > kDeepestJson) {
        result.too_deep = i;
        return result;
      }
    } else if ((c == ']' || c == '}') && depth > 0) {
      --depth;
    } else if (c == 'n') {
      ++nulls;
    } else if (c == '-' || (c >= '0' && c <= '9')) {
      const std::size_t end = std::min(text.find_first_not_of("0123456789+-.eE", i), text.size());
      const std::string_view number = text.substr(i, end - i);
      if (overflows(number) && is_number(number)) result.too_large.push_back({i, end, nulls++});
      i = end - 1;
    }
  }
  return result;
}

// Builds the tree of values while the parser goes through the text. The builder leaves out the items that JsonItems
// takes. (The library's own parser with a callback is slow: at the end of every object it goes through all siblings.)
class TreeBuilder : public nlohmann::json_sax<nlohmann::json> {
 public:
  // Makes a builder. In the text, each number that is too large for double was replaced by null. `infinities` has these
  // numbers. The builder finds the place of each number by counting the nulls before it.
  TreeBuilder(const JsonItems& items, const std::vector<Scan::Number>& infinities)
      : items_(items), infinities_(infinities) {}

  [[nodiscard]] nlohmann::json take_root() { return std::move(root_); }
  [[nodiscard]] std::size_t error_at() const noexcept { return error_at_; }
  [[nodiscard]] const std::string& error_message() const noexcept { return error_message_; }

  bool null() override {
    if (next_infinity_ == infinities_.size() || null_count_++ != infinities_[next_infinity_].nulls) return add(nullptr);
    ++next_infinity_;
    return add(std::numeric_limits<double>::infinity());
  }
  bool boolean(bool value) override { return add(value); }
  bool number_integer(number_integer_t value) override { return add(value); }
  bool number_unsigned(number_unsigned_t value) override { return add(value); }
  bool number_float(number_float_t value, const string_t&) override { return add(value); }
  bool string(string_t& value) override { return add(std::move(value)); }
  bool binary(binary_t& value) override { return add(std::move(value)); }
  bool start_object(std::size_t) override { return open(nlohmann::json::object()); }
  bool start_array(std::size_t) override { return open(nlohmann::json::array()); }
  bool end_array() override { return close(); }

  bool key(string_t& name) override {
    if (stack_.size() == 1) inside_items_ = name == items_.key;
    member_ = &(*stack_.back())[std::move(name)];
    return true;
  }
  bool end_object() override {
    const bool is_item = stack_.size() == 3 && inside_items_ && stack_[1]->is_array();
    close();
    if (!is_item) return true;
    auto& siblings = stack_.back()->get_ref<nlohmann::json::array_t&>();
    items_.take(item_count_++, siblings.back());
    siblings.pop_back();
    return true;
  }
  bool parse_error(std::size_t position, const std::string&, const nlohmann::json::exception& exception) override {
    error_at_ = position > 0 ? position - 1 : 0;
    // The message of the library repeats the place of the error. Only the part after the last ": " is kept.
    std::string_view message = exception.what();
    if (const std::size_t colon = message.rfind(": "); colon != std::string_view::npos)
      message.remove_prefix(colon + 2);
    error_message_ = std::string("the JSON is not valid: ").append(message);
    return false;
  }

 private:
  // Puts a value into the innermost open array, sets it as the current member of the innermost open object, or makes it
  // the root. Returns the address of the value in the tree.
  nlohmann::json* put(nlohmann::json&& value) {
    if (stack_.empty()) {
      root_ = std::move(value);
      return &root_;
    }
    if (stack_.back()->is_array())
      return &stack_.back()->get_ref<nlohmann::json::array_t&>().emplace_back(std::move(value));
    *member_ = std::move(value);
    return member_;
  }
  bool add(nlohmann::json&& value) {
    put(std::move(value));
    return true;
  }
  bool open(nlohmann::json&& value) {
    stack_.push_back(put(std::move(value)));
    return true;
  }
  bool close() {
    stack_.pop_back();
    return true;
  }

  const JsonItems& items_;
  const std::vector<Scan::Number>& infinities_;
  std::size_t null_count_ = 0, next_infinity_ = 0;
  nlohmann::json root_;
  std::vector<nlohmann::json*> stack_;  // the open arrays and objects; their addresses do not change
  nlohmann::json* member_ = nullptr;    // the current member of the innermost object
  bool inside_items_ = false;
  std::size_t item_count_ = 0, error_at_ = 0;
  std::string error_message_;
};

std::string article(const nlohmann::json& value) {
  const std::string type = value.type_name();
  return (type == "array" || type == "object" ? "an " : type == "null" ? "" : "a ") + type;
}

}  // namespace

Result<nlohmann::json> parse_json(std::string_view text, const std::string& name, std::size_t offset,
                                  const JsonItems& items) {
  if (text.starts_with(kByteOrderMark)) {
    text.remove_prefix(kByteOrderMark.size());
    offset += kByteOrderMark.size();
  }
  // The library would skip a second byte order mark, which JSON does not allow.
  if (text.starts_with(kByteOrderMark))
    return invalid_input(binary::place(name, offset),
                         "the JSON is not valid: it has a second byte order mark; remove one of the two");
  // JSON never contains a zero byte. A sparse file may have a terabyte of zero bytes, and the parser would look at each
  // of them, so only the first one is kept.
  if (const std::size_t zero = text.find('\0'); zero != std::string_view::npos) text = text.substr(0, zero + 1);
  const Scan scan = scan_json(text);
  if (scan.too_deep != std::string_view::npos)
    return invalid_input(
        binary::place(name, offset + scan.too_deep),
        "arrays and objects are nested deeper than " + std::to_string(kDeepestJson) + " levels; nest them less");
  // The library refuses numbers that are too large for double, so null replaces them here. The shortest such number is
  // 1e309, so there is always room for "null".
  std::string replaced;
  if (!scan.too_large.empty()) {
    replaced = text;
    for (const Scan::Number& number : scan.too_large) {
      constexpr std::string_view kNull = "null";
      std::fill(replaced.begin() + static_cast<std::ptrdiff_t>(number.begin),
                replaced.begin() + static_cast<std::ptrdiff_t>(number.end), ' ');
      replaced.replace(number.begin, kNull.size(), kNull);
    }
    text = replaced;
  }
  TreeBuilder builder(items, scan.too_large);
  if (nlohmann::json::sax_parse(text.begin(), text.end(), &builder)) return builder.take_root();
  return invalid_input(binary::place(name, offset + builder.error_at()), builder.error_message());
}

std::string JsonComplaint::place(const std::string& pointer) const {
  return pointer.empty() ? name_ : std::string(name_).append(", ").append(pointer);
}

const nlohmann::json* JsonView::find(const char* key) const {
  if (!value_->is_object()) return nullptr;
  const auto found = value_->find(key);
  return found == value_->end() ? nullptr : &*found;
}

std::string JsonView::pointer(std::string_view key) const { return with_json_token(pointer_, key); }

std::string JsonView::pointer(std::size_t index) const { return pointer(std::to_string(index)); }

bool JsonView::is_object() const {
  if (!value_->is_object()) complain("the value must be an object, not " + article(*value_));
  return value_->is_object();
}

std::vector<std::string> JsonView::keys() const {
  std::vector<std::string> result;
  for (const auto& member : value_->items()) result.push_back(member.key());
  return result;
}

std::optional<JsonView> JsonView::object(const char* key) const {
  const nlohmann::json* const value = find(key);
  if (value == nullptr) return std::nullopt;
  JsonView view = member(key, *value);
  if (!view.is_object()) return std::nullopt;
  return view;
}

std::optional<JsonView> JsonView::array(const char* key) const {
  const nlohmann::json* const value = find(key);
  if (value == nullptr) return std::nullopt;
  if (!value->is_array()) {
    complain(key, "the value must be an array, not " + article(*value));
    return std::nullopt;
  }
  if (value->empty()) {
    complain(key, "the array is empty; remove it, or give it at least one item");
    return std::nullopt;
  }
  return member(key, *value);
}

std::optional<std::size_t> JsonView::as_count(std::size_t most) const {
  constexpr double kLargestExact = 9007199254740992;  // 2^53
  std::size_t result = 0;
  if (value_->is_number_unsigned()) {
    result = value_->get<std::size_t>();
  } else if (value_->is_number_float()) {
    const double number = value_->get<double>();
    if (std::isinf(number)) {
      complain("the number is too large for a double; use a smaller number");
      return std::nullopt;
    }
    if (!(number >= 0 && number <= kLargestExact && number == std::floor(number))) {
      complain("the value must be a whole number, not " + value_->dump());
      return std::nullopt;
    }
    result = static_cast<std::size_t>(number);
  } else if (value_->is_number()) {
    complain("the value must not be negative");
    return std::nullopt;
  } else {
    complain("the value must be a whole number, not " + article(*value_));
    return std::nullopt;
  }
  if (result > most) {
    complain(std::to_string(result) + " is too large; use a value of at most " + std::to_string(most));
    return std::nullopt;
  }
  return result;
}

std::optional<std::size_t> JsonView::find_count(const char* key, std::size_t most) const {
  const nlohmann::json* const value = find(key);
  if (value == nullptr) return std::nullopt;
  return member(key, *value).as_count(most);
}

std::size_t JsonView::count(const char* key, std::size_t most, std::size_t fallback) const {
  return find_count(key, most).value_or(fallback);
}

std::size_t JsonView::required_count(const char* key, std::size_t most) const {
  if (!has(key)) complain(std::string(key).append(" is missing"));
  return count(key, most, 0);
}

std::optional<std::size_t> JsonView::as_index(std::size_t count, const char* what) const {
  const std::optional<std::size_t> index = as_count(~std::size_t{0});
  if (!index) return std::nullopt;
  if (*index < count) return index;
  complain("the index is " + std::to_string(*index) + ", but must be less than the number of " + what + ", which is " +
           std::to_string(count));
  return std::nullopt;
}

std::optional<std::size_t> JsonView::find_index(const char* key, std::size_t count, const char* what) const {
  const nlohmann::json* const value = find(key);
  if (value == nullptr) return std::nullopt;
  return member(key, *value).as_index(count, what);
}

std::optional<std::size_t> JsonView::required_index(const char* key, std::size_t count, const char* what) const {
  if (!has(key)) complain(std::string(key).append(" is missing"));
  return find_index(key, count, what);
}

bool JsonView::flag(const char* key) const {
  const nlohmann::json* const value = find(key);
  if (value == nullptr) return false;
  if (!value->is_boolean()) complain(key, "the value must be true or false, not " + article(*value));
  return value->is_boolean() && value->get<bool>();
}

std::string JsonView::as_text() const {
  if (value_->is_string()) return value_->get<std::string>();
  complain("the value must be a string, not " + article(*value_));
  return "";
}

std::string JsonView::text(const char* key) const {
  const nlohmann::json* const value = find(key);
  return value == nullptr ? "" : member(key, *value).as_text();
}

std::string JsonView::required_text(const char* key) const {
  if (!has(key)) complain(std::string(key).append(" is missing"));
  return text(key);
}

double JsonView::as_number() const {
  if (value_->is_number()) {
    const double number = value_->get<double>();
    if (std::isinf(number)) complain("the number is too large for a double; use a smaller number");
    return number;
  }
  complain("the value must be a number, not " + article(*value_));
  return 0;
}

}  // namespace chronormal::inline internal
