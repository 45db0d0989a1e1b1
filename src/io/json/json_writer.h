/// Writes strings, numbers and objects as JSON text, for values that are spliced into a file. Private to io and
/// workflow.
///
///     edit.append("/meshes/0/primitives/0/targets", JsonObject().add("POSITION", 7).add("NORMAL", 9).text());
///
/// Whole documents are built as nlohmann::ordered_json instead. Such a tree does not suit splicing: it does not keep
/// the digits of a number, such as 4.0, and it would hold a data URI of a gigabyte that is written only once.
#ifndef CHRONORMAL_IO_JSON_JSON_WRITER_H_
#define CHRONORMAL_IO_JSON_JSON_WRITER_H_

#include <cstddef>
#include <string>
#include <string_view>

namespace chronormal::inline internal {

/// Returns a text in UTF-8 as a JSON string.
[[nodiscard]] std::string quote_json(std::string_view text);

/// Returns a finite number as JSON, with the fewest digits from which the same float or double is read back.
[[nodiscard]] std::string json_number(float value);
[[nodiscard]] std::string json_number(double value);

/// A builder of a JSON object, member by member.
class JsonObject {
 public:
  /// Adds a member whose value is given as JSON.
  JsonObject& add(std::string_view name, std::string_view json);
  JsonObject& add(std::string_view name, std::size_t value) { return add(name, std::to_string(value)); }

  [[nodiscard]] bool empty() const noexcept { return text_.size() == 1; }
  [[nodiscard]] std::string text() const { return text_ + '}'; }

 private:
  std::string text_ = "{";
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_JSON_JSON_WRITER_H_
