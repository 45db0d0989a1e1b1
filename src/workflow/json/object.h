/// What the JSON of all commands shares. Private to workflow and the program.
#ifndef CHRONORMAL_WORKFLOW_JSON_OBJECT_H_
#define CHRONORMAL_WORKFLOW_JSON_OBJECT_H_

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "chronormal/motion/paths.h"

namespace chronormal::inline internal {

using Json = nlohmann::ordered_json;  // fields stay in the order of the documentation

/// The object of a command with the fields that each begins with.
[[nodiscard]] Json json_of_command(const char* command, int schema = 1);

/// The text, indented, with the end of its last line. Names in files need not be UTF-8; what is not becomes U+FFFD.
[[nodiscard]] std::string json_text(const Json& json);

/// Puts objects into the text of one, in place of its empty list `name`, which must come before any other list of this
/// name. They are made one by one, so that a million of them never stand in memory. `is_indented` as json_text() does
/// it, for a list of the outermost object; or else all in one line.
[[nodiscard]] std::string with_items(std::string text, const std::string& name, std::size_t count,
                                     const std::function<Json(std::size_t)>& item, bool is_indented);

/// Writes which curves were cut into which pieces, and how far they bend; nothing where none were.
void put_path(Json& json, const std::optional<CutPath>& cut);

template <class T>
[[nodiscard]] Json or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json();
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_JSON_OBJECT_H_
