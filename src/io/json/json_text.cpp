#include "io/json/json_text.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "core/charconv.h"
#include "io/json/json_writer.h"

namespace chronormal::inline internal {
namespace {

constexpr std::string_view kBlanks = " \t\r\n";
// The largest number of blanks before an added value, which gets the same blanks as its sibling. Without a limit, a
// file with a megabyte of blanks would grow by a megabyte for every added value.
constexpr std::size_t kMostBlanks = 256;

std::size_t skip_blanks(std::string_view text, std::size_t at) {
  return std::min(text.find_first_not_of(kBlanks, at), text.size());
}

// Returns the offset behind the string whose opening quotation mark is at `at`.
std::size_t end_of_string(std::string_view text, std::size_t at) {
  for (++at; text[at] != '"'; ++at) {
    if (text[at] == '\\') ++at;
  }
  return at + 1;
}

std::size_t end_of_value(std::string_view text, std::size_t at) {
  if (text[at] == '"') return end_of_string(text, at);
  if (text[at] != '[' && text[at] != '{') return std::min(text.find_first_of(",]} \t\r\n", at), text.size());
  for (std::size_t depth = 0;;) {
    const char c = text[at];
    at = c == '"' ? end_of_string(text, at) : at + 1;
    if (c == '[' || c == '{') ++depth;
    if ((c == ']' || c == '}') && --depth == 0) return at;
  }
}

std::uint32_t hexadecimal(std::string_view digits) {
  std::uint32_t value = 0;
  (void)from_chars(digits.data(), digits.data() + digits.size(), value, 16);
  return value;
}

void append_utf8(std::string& text, std::uint32_t code) {
  const auto add = [&](std::uint32_t byte) { text += static_cast<char>(byte); };
  if (code < 0x80) return add(code);
  if (code < 0x800) {
    add(0xC0 | code >> 6);
  } else {
    if (code < 0x10000) {
      add(0xE0 | code >> 12);
    } else {
      add(0xF0 | code >> 18);
      add(0x80 | (code >> 12 & 0x3F));
    }
    add(0x80 | (code >> 6 & 0x3F));
  }
  add(0x80 | (code & 0x3F));
}

bool is_named(std::string_view quoted, std::string_view name) {
  if (quoted.find('\\') != std::string_view::npos) return decode_json_string(quoted) == name;
  return quoted.substr(1, quoted.size() - 2) == name;
}

// Returns the index for which a token of a JSON pointer stands. Returns nothing if the token is no number, or has a
// sign or leading zeros.
std::optional<std::size_t> to_index(std::string_view token) {
  std::size_t index = 0;
  const char* const end = token.data() + token.size();
  const auto [stop, code] = from_chars(token.data(), end, index);
  if (code != std::errc() || stop != end || (token.size() > 1 && token.front() == '0')) return std::nullopt;
  return index;
}

}  // namespace

// An item of an array or a member of an object.
struct JsonText::Member {
  std::string_view key;   // name with its quotation marks; empty in arrays
  std::string_view text;  // text of the value, either a part of the text of the node or an added text
  bool added = false, replaced = false;
  std::unique_ptr<Node> value;  // set if a pointer led to this value
};

struct JsonText::Node {
  explicit Node(std::string_view value) : text(value) {}

  // Splits an array or an object into its parts.
  void expand();
  [[nodiscard]] bool is_object() const noexcept { return text.front() == '{'; }
  [[nodiscard]] bool is_container() const noexcept { return is_object() || text.front() == '['; }

  std::string_view text;
  bool changed = false, expanded = false;
  std::vector<Member> members;  // the parts; added members stand last
  std::size_t end_of_last = 1;  // offset in `text` at which members are added
  std::string_view blanks;      // blanks before the last member
  std::string_view colon = ":";
};

void JsonText::Node::expand() {
  if (std::exchange(expanded, true) || !is_container()) return;
  std::size_t from = 1, at = skip_blanks(text, 1);
  while (text[at] != ']' && text[at] != '}') {
    Member& member = members.emplace_back();
    blanks = text.substr(from, at - from);
    if (is_object()) {
      const std::size_t end = end_of_string(text, at);
      member.key = text.substr(at, end - at);
      at = skip_blanks(text, skip_blanks(text, end) + 1);
      colon = text.substr(end, at - end);
    }
    end_of_last = end_of_value(text, at);
    member.text = text.substr(at, end_of_last - at);
    at = skip_blanks(text, end_of_last);
    if (text[at] != ',') break;
    from = at + 1;
    at = skip_blanks(text, from);
  }
  if (blanks.size() > kMostBlanks) blanks = "";
  if (colon.size() > kMostBlanks) colon = ":";
}

std::string decode_json_string(std::string_view quoted) {
  std::string result;
  const std::size_t end = quoted.size() - 1;
  for (std::size_t i = 1; i < end; ++i) {
    if (quoted[i] != '\\') {
      result += quoted[i];
      continue;
    }
    constexpr std::string_view kLetters = "\"\\/bfnrt", kMeanings = "\"\\/\b\f\n\r\t";
    if (const std::size_t letter = kLetters.find(quoted[++i]); letter != std::string_view::npos) {
      result += kMeanings[letter];
      continue;
    }
    std::uint32_t code = hexadecimal(quoted.substr(i + 1, 4));
    i += 4;
    // Characters above U+FFFF are written as two codes, a surrogate pair.
    if (code >= 0xD800 && code < 0xDC00 && i + 6 < quoted.size()) {
      code = 0x10000 + ((code - 0xD800) << 10) + (hexadecimal(quoted.substr(i + 3, 4)) - 0xDC00);
      i += 6;
    }
    append_utf8(result, code);
  }
  return result;
}

std::optional<std::vector<std::string>> split_json_pointer(std::string_view pointer) {
  std::vector<std::string> tokens;
  if (!pointer.empty() && pointer.front() != '/') return std::nullopt;
  for (std::size_t i = 0; i < pointer.size(); ++i) {
    if (pointer[i] == '/') {
      tokens.emplace_back();
    } else if (pointer[i] != '~') {
      tokens.back() += pointer[i];
    } else {
      const char escaped = ++i < pointer.size() ? pointer[i] : ' ';
      if (escaped != '0' && escaped != '1') return std::nullopt;
      tokens.back() += escaped == '0' ? '~' : '/';
    }
  }
  return tokens;
}

std::string with_json_token(const std::string& pointer, std::string_view token) {
  std::string result = pointer + '/';
  for (const char c : token) {
    if (c == '~')
      result += "~0";
    else if (c == '/')
      result += "~1";
    else
      result += c;
  }
  return result;
}

std::size_t json_depth(std::string_view text) noexcept {
  std::size_t depth = 0, deepest = 0;
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    at = c == '"' ? end_of_string(text, at) : at + 1;
    if (c == '[' || c == '{') deepest = std::max(deepest, ++depth);
    if (c == ']' || c == '}') --depth;
  }
  return deepest;
}

JsonText::JsonText(std::string_view text) : text_(text) {
  const std::size_t begin = skip_blanks(text, text.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0);
  root_ = std::make_unique<Node>(text.substr(begin, end_of_value(text, begin) - begin));
}
JsonText::JsonText(JsonText&&) noexcept = default;
JsonText& JsonText::operator=(JsonText&&) noexcept = default;
JsonText::~JsonText() = default;

std::string_view JsonText::keep(std::string text) { return kept_.emplace_back(std::move(text)); }

JsonText::Member* JsonText::find_member(Node& node, const std::string& token) {
  node.expand();
  if (!node.is_container()) return nullptr;
  if (!node.is_object()) {
    const std::optional<std::size_t> index = to_index(token);
    return index && *index < node.members.size() ? &node.members[*index] : nullptr;
  }
  const auto found = std::find_if(node.members.rbegin(), node.members.rend(),
                                  [&](const Member& member) { return is_named(member.key, token); });
  return found == node.members.rend() ? nullptr : &*found;
}

std::optional<std::string_view> JsonText::find(std::string_view pointer) {
  const auto tokens = split_json_pointer(pointer);
  if (!tokens) return std::nullopt;
  Node* node = root_.get();
  for (const std::string& token : *tokens) {
    Member* const member = find_member(*node, token);
    if (member == nullptr) return std::nullopt;
    if (!member->value) member->value = std::make_unique<Node>(member->text);
    node = member->value.get();
  }
  return node->text;
}

std::vector<JsonMember> JsonText::members(std::string_view pointer) {
  std::vector<JsonMember> result;
  const std::optional<std::string_view> text = find(pointer);
  if (!text) return result;
  Node node(*text);
  node.expand();
  for (const Member& member : node.members)
    result.push_back({member.key.empty() ? std::string() : decode_json_string(member.key), member.text});
  return result;
}

void JsonText::add_member(Node& node, const std::string& token, std::string value) {
  Member member;
  if (node.is_object()) member.key = keep(quote_json(token));
  member.text = keep(std::move(value));
  member.added = true;
  node.members.push_back(std::move(member));
}

Status JsonText::set(std::string_view pointer, std::string value) { return change(pointer, std::move(value), false); }
Status JsonText::append(std::string_view pointer, std::string value) { return change(pointer, std::move(value), true); }

Status JsonText::change(std::string_view pointer, std::string value, bool append) {
  const auto error = [&](std::string message) { return invalid_input(std::string(pointer), std::move(message)); };
  const auto tokens = split_json_pointer(pointer);
  if (!tokens) return error("this is not a JSON pointer; write one like /meshes/0/extras");
  if (tokens->empty() && !append)
    return error("the whole document cannot be replaced; point to a member of it, such as /meshes/0/extras");
  value.erase(0, skip_blanks(value, 0));
  value.resize(value.find_last_not_of(kBlanks) + 1);

  std::vector<Node*> way = {root_.get()};
  Member* last = nullptr;
  for (std::size_t i = 0; i < tokens->size(); ++i) {
    Node& node = *way.back();
    const std::string& token = (*tokens)[i];
    if (!node.is_container())
      return error("only an object or an array can have a member '" + token +
                   "', and this value is neither; correct the pointer");
    last = find_member(node, token);
    if (last != nullptr) {
      if (!last->value) last->value = std::make_unique<Node>(last->text);
      way.push_back(last->value.get());
      continue;
    }
    if (!node.is_object())
      return error("the array has " + std::to_string(node.members.size()) +
                   (node.members.size() == 1 ? " item, and no item " : " items, and no item ") + token +
                   "; point to an item that exists");
    // If objects on the way to the value are missing, they are added together with the value as one text.
    std::string made = append ? std::string("[").append(value).append("]") : std::move(value);
    for (std::size_t k = tokens->size() - 1; k > i; --k) made = JsonObject().add((*tokens)[k], made).text();
    add_member(node, token, std::move(made));
    for (Node* const changed : way) changed->changed = true;
    return Success{};
  }

  Node& node = *way.back();
  if (append) {
    if (node.text.front() != '[')
      return error("a value can only be added to an array, but the pointer leads to another value; point to an array");
    node.expand();
    add_member(node, "", std::move(value));
  } else {
    node = Node(keep(std::move(value)));
    last->replaced = true;
  }
  for (Node* const changed : way) changed->changed = true;
  return Success{};
}

void JsonText::add_pointers(const Node& node, const std::string& prefix, std::vector<std::string>& result) {
  for (std::size_t i = 0; i < node.members.size(); ++i) {
    const Member& member = node.members[i];
    const bool is_inside = member.value && member.value->changed;
    if (!member.added && !member.replaced && !is_inside) continue;
    const std::string pointer =
        with_json_token(prefix, node.is_object() ? decode_json_string(member.key) : std::to_string(i));
    if (member.added || member.replaced)
      result.push_back(pointer);
    else
      add_pointers(*member.value, pointer, result);
  }
}

std::vector<std::string> JsonText::pointers() const {
  std::vector<std::string> result;
  add_pointers(*root_, "", result);
  std::sort(result.begin(), result.end());
  return result;
}

void JsonText::add_pieces(const Node& node, std::vector<std::string_view>& result) {
  if (!node.expanded) return result.push_back(node.text);
  std::size_t at = 0;
  const auto copy_up_to = [&](std::size_t end) {
    if (end > at) result.push_back(node.text.substr(at, end - at));
    at = end;
  };
  bool is_first = true;
  for (const Member& member : node.members) {
    const bool is_changed = member.value && member.value->changed;
    if (member.added) {
      copy_up_to(node.end_of_last);
      if (!is_first) result.push_back(",");
      result.push_back(node.blanks);
      if (!member.key.empty()) result.insert(result.end(), {member.key, node.colon});
    } else if (is_changed) {
      copy_up_to(static_cast<std::size_t>(member.text.data() - node.text.data()));
      at += member.text.size();
    }
    if (is_changed)
      add_pieces(*member.value, result);
    else if (member.added)
      result.push_back(member.text);
    is_first = false;
  }
  copy_up_to(node.text.size());
}

std::vector<std::string_view> JsonText::pieces() const {
  // The root itself may have been replaced. Only the blanks around the root are then kept of the old text.
  std::vector<std::string_view> result;
  const std::size_t begin = skip_blanks(text_, text_.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0);
  result.push_back(text_.substr(0, begin));
  add_pieces(*root_, result);
  result.push_back(text_.substr(end_of_value(text_, begin)));
  std::erase(result, std::string_view());
  return result;
}

std::string join(const std::vector<std::string_view>& pieces) {
  std::string result;
  std::size_t size = 0;
  for (const std::string_view piece : pieces) size += piece.size();
  result.reserve(size);
  for (const std::string_view piece : pieces) result += piece;
  return result;
}

}  // namespace chronormal::inline internal
