/// Changes to JSON text that leave every byte between them as it is. Private to io.
///
/// A value is found by its JSON pointer (RFC 6901), and what takes its place is spliced into the text, so that numbers,
/// blanks and the order of members elsewhere stay as somebody wrote them:
///
///     JsonText json(R"({ "a": [1, 2], "n": 1e400 })");
///     json.append("/a", "3");
///     json.set("/b/c", "true");                         // b is made
///     join(json.pieces());                              // { "a": [1, 2, 3], "n": 1e400, "b": {"c":true} }
///
/// Names     may be escaped in the text ("a" is "\u0061"); of members with the same name, the last counts.
/// Order     each change works on what those before it made: a value that was set or appended can be changed again.
/// Style     what is added takes the blanks of the last sibling, so that an indented list stays one.
/// Cost      containers are taken apart once, when the first pointer leads through them.
#ifndef CHRONORMAL_IO_JSON_JSON_TEXT_H_
#define CHRONORMAL_IO_JSON_JSON_TEXT_H_

#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/core/result.h"

namespace chronormal::inline internal {

/// What some editors write before the text of a file: U+FEFF in UTF-8. JSON does not know it.
inline constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

/// The text of a string: "\u00e9" without its quotation marks, in UTF-8. quoted must be a valid JSON string.
[[nodiscard]] std::string decode_json_string(std::string_view quoted);

/// The names in a pointer; nothing where it is none.
[[nodiscard]] std::optional<std::vector<std::string>> split_json_pointer(std::string_view pointer);

/// The pointer to a member of what a pointer leads to.
[[nodiscard]] std::string with_json_token(const std::string& pointer, std::string_view name);

/// How deep the arrays and objects of valid JSON are nested; 0 for a number.
[[nodiscard]] std::size_t json_depth(std::string_view text) noexcept;

/// A member of an object, or an item of an array, whose name is empty.
struct JsonMember {
  std::string name;
  std::string_view value;
};

class JsonText {
 public:
  /// text must be JSON that parse_json() accepts, a byte order mark included, and must outlive this.
  explicit JsonText(std::string_view text);
  JsonText(JsonText&&) noexcept;
  JsonText& operator=(JsonText&&) noexcept;
  JsonText(const JsonText&) = delete;
  JsonText& operator=(const JsonText&) = delete;
  ~JsonText();

  /// The text of a value; nothing where there is none.
  /// Precondition: nothing was changed
  [[nodiscard]] std::optional<std::string_view> find(std::string_view pointer);
  /// The members of an object or the items of an array, in their order; none for other values or where there is none.
  /// Precondition: nothing was changed
  [[nodiscard]] std::vector<JsonMember> members(std::string_view pointer);

  /// Replaces a value, or adds it as a member; objects that are missing on the way are made. value must be JSON.
  /// Errors: kInvalidInput with the pointer as the place, where it is no pointer, leads through what is neither object
  /// nor array, or to an item that an array does not have; then nothing is changed.
  [[nodiscard]] Status set(std::string_view pointer, std::string value);
  /// Adds a value to the end of an array, which is made where it is missing. Errors: as above; the value is no array.
  [[nodiscard]] Status append(std::string_view pointer, std::string value);

  /// What was replaced or added, sorted: the outermost of what was added together.
  [[nodiscard]] std::vector<std::string> pointers() const;
  /// The text with its changes, in pieces that live as long as this and the source.
  [[nodiscard]] std::vector<std::string_view> pieces() const;

 private:
  struct Node;
  struct Member;

  [[nodiscard]] Member* find_member(Node& node, const std::string& token);
  static void add_pointers(const Node& node, const std::string& prefix, std::vector<std::string>& result);
  static void add_pieces(const Node& node, std::vector<std::string_view>& result);
  void add_member(Node& node, const std::string& token, std::string value);
  [[nodiscard]] Status change(std::string_view pointer, std::string value, bool append);
  [[nodiscard]] std::string_view keep(std::string text);

  std::string_view text_;
  std::unique_ptr<Node> root_;
  std::deque<std::string> kept_;  // text of changes; they stay where they are
};

/// Pieces of a text as one.
[[nodiscard]] std::string join(const std::vector<std::string_view>& pieces);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_JSON_JSON_TEXT_H_
