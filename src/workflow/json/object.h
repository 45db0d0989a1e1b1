/// Declares helpers for the JSON of all commands. Private to workflow and the program.
#ifndef CHRONORMAL_WORKFLOW_JSON_OBJECT_H_
#define CHRONORMAL_WORKFLOW_JSON_OBJECT_H_

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "chronormal/motion/paths.h"

namespace chronormal::inline internal {

using Json = nlohmann::ordered_json;  // keeps fields in the order of the documentation

/// Returns an object with only those fields with which the JSON of every command begins.
[[nodiscard]] Json json_of_command(const char* command, int schema = 1);

/// Returns a JSON value as indented text, with a final line end. Names in files need not be UTF-8, so invalid bytes
/// become U+FFFD.
[[nodiscard]] std::string json_text(const Json& json);

/// Inserts `count` objects, which item(i) returns, into a JSON text in place of its empty list `name`. This list must
/// come before any other list of that name. The objects are created one by one, so that a million objects are never in
/// memory together. If is_indented is true, the list must be a member of the outermost object, and is formatted as by
/// json_text(). Otherwise all objects are on one line.
[[nodiscard]] std::string with_items(std::string text, const std::string& name, std::size_t count,
                                     const std::function<Json(std::size_t)>& item, bool is_indented);

/// Writes into `json` how the curved paths of vertices were cut: the kind of path, the number of straight pieces, and
/// how much the paths bend (CutPath::bend). Writes nothing if no path was cut.
void put_path(Json& json, const std::optional<CutPath>& cut);

template <class T>
[[nodiscard]] Json or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json();
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_JSON_OBJECT_H_
