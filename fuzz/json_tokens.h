/// Splits JSON text into tokens, to check that an edit changes only one place. The tests use this header too.
#ifndef CHRONORMAL_FUZZ_JSON_TOKENS_H_
#define CHRONORMAL_FUZZ_JSON_TOKENS_H_

#include <algorithm>
#include <cstddef>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace chronormal::fuzz {

inline constexpr char kHidden = '\x01';

/// A bracket, a comma, a colon, a name or a scalar, with the blanks before it. `pointer` is the JSON pointer of the
/// value that the token belongs to. Brackets belong to their own value; commas, names and colons belong to the value
/// after them. If an object has a name twice, the pointer of the earlier member has kHidden in front of the name.
struct JsonToken {
  std::string pointer;
  std::string_view text;
  bool is_value = false;  ///< a part of the value: no comma, name or colon
};

class JsonTokens {
 public:
  /// Splits a document into tokens. ok() is false if the document is not JSON.
  explicit JsonTokens(std::string_view text) : text_(text) {
    if (text.starts_with("\xEF\xBB\xBF")) at_ = 3;
    ok_ = read_value("");
    skip_blanks();
    ok_ = ok_ && at_ == text_.size();
  }
  [[nodiscard]] bool ok() const noexcept { return ok_; }
  [[nodiscard]] const std::vector<JsonToken>& all() const noexcept { return tokens_; }

  /// Returns the text of the value at a pointer without the blanks around it, or "" if there is none.
  [[nodiscard]] std::string value(const std::string& pointer) const {
    const auto of_it = [&](const JsonToken& token) { return token.is_value && token.pointer == pointer; };
    const auto first = std::find_if(tokens_.begin(), tokens_.end(), of_it);
    if (first == tokens_.end()) return "";
    const auto last = std::find_if(tokens_.rbegin(), tokens_.rend(), of_it);
    const char* begin = first->text.data();
    while (is_blank(*begin)) ++begin;
    return {begin, last->text.data() + last->text.size()};
  }

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }
  void skip_blanks() {
    while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
  }
  [[nodiscard]] char next() {
    skip_blanks();
    return at_ < text_.size() ? text_[at_] : '\0';
  }
  void add(std::size_t from, const std::string& pointer, bool is_value) {
    tokens_.push_back({pointer, text_.substr(from, at_ - from), is_value});
  }
  // Reads a bracket, a comma or a colon.
  bool read_mark(char mark, const std::string& pointer, bool is_value) {
    const std::size_t from = at_;
    if (next() != mark) return false;
    ++at_;
    add(from, pointer, is_value);
    return true;
  }
  bool read_scalar(const std::string& pointer, bool is_value) {
    const std::size_t from = at_;
    if (next() == '"') {
      for (++at_; at_ < text_.size() && text_[at_] != '"'; ++at_) {
        if (text_[at_] == '\\') ++at_;
      }
      if (++at_ > text_.size()) return false;
    } else {
      const std::size_t begin = at_;
      while (at_ < text_.size() && !is_blank(text_[at_]) && text_.find_first_of(",:[]{}\"", at_) != at_) ++at_;
      if (at_ == begin) return false;
    }
    add(from, pointer, is_value);
    return true;
  }
  static std::string child(const std::string& pointer, const std::string& name) {
    std::string result = pointer + '/';
    for (const char c : name) result += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
    return result;
  }
  // Returns the name of the member that begins here. Does not add its tokens to the list, so the member can be read
  // again.
  std::string peek_name() {
    const std::size_t from = at_, count = tokens_.size();
    if (next() == ',') ++at_;
    const bool found = next() == '"' && read_scalar("", false);
    const std::string_view quoted = found ? tokens_.back().text : std::string_view();
    at_ = from;
    tokens_.resize(count);
    const nlohmann::json name = nlohmann::json::parse(quoted, nullptr, false);
    return name.is_string() ? name.get<std::string>() : std::string();
  }

  bool read_value(const std::string& pointer) {
    if (next() != '[' && text_.find_first_of("{", at_) != at_) return read_scalar(pointer, true);
    return text_[at_] == '[' ? read_array(pointer) : read_object(pointer);
  }
  bool read_array(const std::string& pointer) {
    if (!read_mark('[', pointer, true)) return false;
    for (std::size_t i = 0; next() != ']'; ++i) {
      const std::string item = child(pointer, std::to_string(i));
      if ((i > 0 && !read_mark(',', item, false)) || !read_value(item)) return false;
    }
    return read_mark(']', pointer, true);
  }
  bool read_object(const std::string& pointer) {
    if (!read_mark('{', pointer, true)) return false;
    struct Range {
      std::size_t begin, end;
    };
    std::map<std::string, Range> members;
    for (bool is_first = true; next() != '}'; is_first = false) {
      const std::string name = peek_name(), member = child(pointer, name);
      const std::size_t begin = tokens_.size();
      if (!is_first && !read_mark(',', member, false)) return false;
      if (next() != '"' || !read_scalar(member, false) || !read_mark(':', member, false) || !read_value(member))
        return false;
      if (const auto hidden = members.find(name); hidden != members.end()) {
        for (std::size_t i = hidden->second.begin; i < hidden->second.end; ++i)
          tokens_[i].pointer.insert(pointer.size() + 1, 1, kHidden);
      }
      members[name] = {begin, tokens_.size()};
    }
    return read_mark('}', pointer, true);
  }

  std::string_view text_;
  std::size_t at_ = 0;
  bool ok_ = false;
  std::vector<JsonToken> tokens_;
};

/// Returns the first difference between two documents outside the values at the pointers, or "" if there is no such
/// difference. Also compares the name, the colon and the comma before a replaced value, but not those before an added
/// value.
[[nodiscard]] inline std::string difference_beside(const JsonTokens& before, const JsonTokens& after,
                                                   const std::vector<std::string>& pointers) {
  if (!before.ok() || !after.ok()) return before.ok() ? "the result is no JSON" : "the source is no JSON";
  const auto kept = [&](const JsonTokens& tokens) {
    std::vector<std::string_view> result;
    for (const JsonToken& token : tokens.all()) {
      const bool is_inside = std::any_of(pointers.begin(), pointers.end(), [&](const std::string& pointer) {
        if (!token.pointer.starts_with(pointer)) return false;
        if (token.pointer.size() > pointer.size()) return token.pointer[pointer.size()] == '/';
        return token.is_value || before.value(pointer).empty();
      });
      if (!is_inside) result.push_back(token.text);
    }
    return result;
  };
  const std::vector<std::string_view> left = kept(before), right = kept(after);
  for (std::size_t i = 0; i < std::min(left.size(), right.size()); ++i) {
    if (left[i] != right[i]) return std::string("'").append(left[i]).append("' became '").append(right[i]).append("'");
  }
  if (left.size() != right.size()) return "the numbers of tokens differ";
  return "";
}

}  // namespace chronormal::fuzz

#endif  // CHRONORMAL_FUZZ_JSON_TOKENS_H_
