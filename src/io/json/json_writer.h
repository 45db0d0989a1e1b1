/// Writes JSON as text, for values that are spliced into a file: strings, numbers and objects. Private to io and
/// workflow.
///
///     edit.append("/meshes/0/primitives/0/targets", JsonObject().add("POSITION", 7).add("NORMAL", 9).text());
///
/// A whole document is an nlohmann::ordered_json instead. That cannot hold what must stay as it is: a number that
/// somebody wrote as 4.0, or a data URI of a gigabyte that is needed once.
#ifndef CHRONORMAL_IO_JSON_JSON_WRITER_H_
#define CHRONORMAL_IO_JSON_JSON_WRITER_H_

#include <cstddef>
#include <string>
#include <string_view>

namespace chronormal::inline internal {

/// Returns a string as JSON. text must be UTF-8.
[[nodiscard]] std::string quote_json(std::string_view text);

/// Returns a number as JSON: the fewest digits that read back to the same float, or to the same double. The number must
/// be finite
[[nodiscard]] std::string json_number(float value);
[[nodiscard]] std::string json_number(double value);

/// Builds an object, member by member.
class JsonObject {
 public:
  /// Adds a member whose value is JSON already.
  JsonObject& add(std::string_view name, std::string_view json);
  JsonObject& add(std::string_view name, std::size_t value) { return add(name, std::to_string(value)); }

  [[nodiscard]] bool empty() const noexcept { return text_.size() == 1; }
  [[nodiscard]] std::string text() const { return text_ + '}'; }

 private:
  std::string text_ = "{";
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_JSON_JSON_WRITER_H_
