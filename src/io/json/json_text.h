/// Changes values in JSON text, and leaves every byte between the changes as it is. Private to io.
///
/// A value is found by its JSON pointer (RFC 6901), and its replacement is spliced into the text, so that numbers,
/// blanks and the order of members elsewhere do not change:
///
///     JsonText json(R"({ "a": [1, 2], "n": 1e400 })");
///     json.append("/a", "3");
///     json.set("/b/c", "true");                         // b is added
///     join(json.pieces());                              // { "a": [1, 2, 3], "n": 1e400, "b": {"c":true} }
///
/// Names     may be escaped in the text ("a" is "\u0061"); if several members have the same name, the last one is used.
/// Order     each change works on the result of earlier changes: a value that was set can be changed again.
/// Style     an added value gets the same blanks as the last sibling, so that an indented list stays indented.
/// Cost      an array or object is split into parts once, when a pointer first leads through it.
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

/// The byte order mark that some editors write at the start of a file: U+FEFF in UTF-8. JSON does not allow it.
inline constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

/// Returns the text, in UTF-8, for which a JSON string stands. The string must be valid, and is passed without its
/// quotation marks: "\u00e9".
[[nodiscard]] std::string decode_json_string(std::string_view quoted);

/// Returns the names and indices in a JSON pointer as text, without escapes. Returns nothing if the pointer is not
/// valid.
[[nodiscard]] std::optional<std::vector<std::string>> split_json_pointer(std::string_view pointer);

/// Returns the JSON pointer to the member `name` of the value at `pointer`.
[[nodiscard]] std::string with_json_token(const std::string& pointer, std::string_view name);

/// Returns the number of levels to which the arrays and objects of valid JSON are nested, for example 0 for a number.
[[nodiscard]] std::size_t json_depth(std::string_view text) noexcept;

/// A member of an object, or an item of an array. The name of an item is empty.
struct JsonMember {
  std::string name;
  std::string_view value;
};

class JsonText {
 public:
  /// Takes a text, which must be JSON that parse_json() accepts, possibly with a byte order mark. The text must outlive
  /// this object.
  explicit JsonText(std::string_view text);
  JsonText(JsonText&&) noexcept;
  JsonText& operator=(JsonText&&) noexcept;
  JsonText(const JsonText&) = delete;
  JsonText& operator=(const JsonText&) = delete;
  ~JsonText();

  /// Returns the text of the value at a pointer, or nothing if there is no such value. Must be called before any
  /// change.
  [[nodiscard]] std::optional<std::string_view> find(std::string_view pointer);
  /// Returns the members of an object or the items of an array, in their order. Returns none for other values, or if
  /// the pointer leads to no value. Must be called before any change.
  [[nodiscard]] std::vector<JsonMember> members(std::string_view pointer);

  /// Replaces the value at a pointer. If there is no such value, adds it as a member, together with missing objects on
  /// the way. `value` must be JSON. Errors, after which the text is unchanged: kInvalidInput, with the pointer as the
  /// place, if the pointer is not valid, leads through a value that is neither object nor array, or leads to an item
  /// that an array does not have.
  [[nodiscard]] Status set(std::string_view pointer, std::string value);
  /// Appends a value to an array. Adds the array if it is missing. Errors: those of set(); kInvalidInput if the
  /// existing value is not an array.
  [[nodiscard]] Status append(std::string_view pointer, std::string value);

  /// Returns the pointers of all replaced and added values, sorted. If one call added several levels, only the pointer
  /// of the outermost level is returned.
  [[nodiscard]] std::vector<std::string> pointers() const;
  /// Returns the changed text in pieces, which are valid as long as this object and the source text live.
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
  std::deque<std::string> kept_;  // texts of changes; their addresses do not change
};

[[nodiscard]] std::string join(const std::vector<std::string_view>& pieces);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_JSON_JSON_TEXT_H_
