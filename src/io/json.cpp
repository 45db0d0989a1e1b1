#include "io/json.h"

#include <cmath>

#include "io/binary.h"

namespace chronormal {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

// The byte at which text is nested deeper than allowed; npos if it is not. Brackets inside strings do not count.
std::size_t find_too_deep(std::string_view text) {
  std::size_t depth = 0;
  bool inside_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (inside_string) {
      if (c == '\\')
        ++i;
      else if (c == '"')
        inside_string = false;
    } else if (c == '"') {
      inside_string = true;
    } else if (c == '[' || c == '{') {
      if (++depth > kDeepestJson) return i;
    } else if ((c == ']' || c == '}') && depth > 0) {
      --depth;
    }
  }
  return std::string_view::npos;
}

// Builds the tree as the parser walks the text, without the items that are taken. (The library's own parser with a
// callback walks over all siblings at the end of every object.)
class TreeBuilder : public nlohmann::json_sax<nlohmann::json> {
 public:
  explicit TreeBuilder(const JsonItems& items) : items_(items) {}

  [[nodiscard]] nlohmann::json take_root() { return std::move(root_); }
  [[nodiscard]] std::size_t error_at() const noexcept { return error_at_; }
  [[nodiscard]] const std::string& error_message() const noexcept { return error_message_; }

  bool null() override { return add(nullptr); }
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
    // The library's text repeats the place; what it says after the last ": " is enough.
    std::string_view message = exception.what();
    if (const std::size_t colon = message.rfind(": "); colon != std::string_view::npos)
      message.remove_prefix(colon + 2);
    error_message_ = dynamic_cast<const nlohmann::json::out_of_range*>(&exception) != nullptr
                         ? "the number is too large"
                         : std::string("this is no JSON: ").append(message);
    return false;
  }

 private:
  // Puts a value where the walk stands: into an array, a member or the root.
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
  nlohmann::json root_;
  std::vector<nlohmann::json*> stack_;  // the arrays and objects that are open; their places do not move meanwhile
  nlohmann::json* member_ = nullptr;    // of the innermost object
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
  if (const std::size_t at = find_too_deep(text); at != std::string_view::npos)
    return invalid_input(binary::place(name, offset + at),
                         "arrays and objects are nested deeper than " + std::to_string(kDeepestJson) + " levels");
  TreeBuilder builder(items);
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

std::string JsonView::pointer(std::string_view key) const {
  std::string result = pointer_;
  result += '/';
  for (const char c : key) {
    if (c == '~')
      result += "~0";
    else if (c == '/')
      result += "~1";
    else
      result += c;
  }
  return result;
}

std::string JsonView::pointer(std::size_t index) const { return pointer(std::to_string(index)); }

bool JsonView::is_object() const {
  if (!value_->is_object()) complain("this must be an object, not " + article(*value_));
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
    complain(key, "this must be an array, not " + article(*value));
    return std::nullopt;
  }
  if (value->empty()) {
    complain(key, "the array is empty; glTF asks for one item or more, or for none of this name");
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
    if (!(number >= 0 && number <= kLargestExact && number == std::floor(number))) {
      complain("this must be a whole number, not " + value_->dump());
      return std::nullopt;
    }
    result = static_cast<std::size_t>(number);
  } else if (value_->is_number()) {
    complain("this must not be negative");
    return std::nullopt;
  } else {
    complain("this must be a whole number, not " + article(*value_));
    return std::nullopt;
  }
  if (result > most) {
    complain(std::to_string(result) + " is too large; the most is " + std::to_string(most));
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
  if (!has(key)) complain(std::string("there is no ").append(key));
  return count(key, most, 0);
}

std::optional<std::size_t> JsonView::as_index(std::size_t count, const char* what) const {
  const std::optional<std::size_t> index = as_count(~std::size_t{0});
  if (!index) return std::nullopt;
  if (*index < count) return index;
  complain("there is no " + std::to_string(*index) + " among the " + std::to_string(count) + " " + what);
  return std::nullopt;
}

std::optional<std::size_t> JsonView::find_index(const char* key, std::size_t count, const char* what) const {
  const nlohmann::json* const value = find(key);
  if (value == nullptr) return std::nullopt;
  return member(key, *value).as_index(count, what);
}

std::optional<std::size_t> JsonView::required_index(const char* key, std::size_t count, const char* what) const {
  if (!has(key)) complain(std::string("there is no ").append(key));
  return find_index(key, count, what);
}

bool JsonView::flag(const char* key) const {
  const nlohmann::json* const value = find(key);
  if (value == nullptr) return false;
  if (!value->is_boolean()) complain(key, "this must be true or false, not " + article(*value));
  return value->is_boolean() && value->get<bool>();
}

std::string JsonView::as_text() const {
  if (value_->is_string()) return value_->get<std::string>();
  complain("this must be a string, not " + article(*value_));
  return "";
}

std::string JsonView::text(const char* key) const {
  const nlohmann::json* const value = find(key);
  return value == nullptr ? "" : member(key, *value).as_text();
}

std::string JsonView::required_text(const char* key) const {
  if (!has(key)) complain(std::string("there is no ").append(key));
  return text(key);
}

double JsonView::as_number() const {
  if (value_->is_number()) return value_->get<double>();
  complain("this must be a number, not " + article(*value_));
  return 0;
}

}  // namespace chronormal
