// Writes the parts of JSON that several commands share.
#include "core/text.h"
#include "workflow/json/object.h"

namespace chronormal::inline internal {

Json json_of_command(const char* command, int schema) {
  return {{"chronormal", CHRONORMAL_VERSION}, {"command", command}, {"schema", schema}};
}

// Returns an object as indented text with a final line end. Escapes the control characters from DEL on, which JSON
// allows but terminals may interpret. A reader of the JSON gets the same strings.
std::string json_text(const Json& json) {
  return escaped_for_json(json.dump(2, ' ', false, Json::error_handler_t::replace)) + '\n';
}

std::string with_items(std::string text, const std::string& name, std::size_t count,
                       const std::function<Json(std::size_t)>& item, bool is_indented) {
  // Finds the empty list by its text, which cannot occur inside a string because quotes are escaped there.
  const std::string list = '"' + name + (is_indented ? "\": []" : "\":[]"), margin(is_indented ? 4 : 0, ' ');
  const std::size_t at = text.find(list);
  if (at == std::string::npos || count == 0) return text;
  const std::string rest = text.substr(at + list.size() - 1);
  text.resize(at + list.size() - 1);
  for (std::size_t i = 0; i < count; ++i) {
    const std::string lines = item(i).dump(is_indented ? 2 : -1, ' ', false, Json::error_handler_t::replace);
    if (i > 0) text += ',';
    if (is_indented) text += '\n' + margin;
    for (const char c : is_indented ? escaped_for_json(lines) : lines) {
      text += c;
      if (is_indented && c == '\n') text += margin;
    }
  }
  if (is_indented) text += "\n  ";
  return text + rest;
}

void put_path(Json& json, const std::optional<CutPath>& cut) {
  if (!cut) return;
  json["path"] = path_name(cut->path.kind);
  json["bend"] = cut->bend;
  json["is_too_sparse"] = is_too_sparse(cut->bend);
  json["cut"] = {{"tolerance_degrees", cut->path.tolerance},
                 {"segments", cut->segments},
                 {"pieces", cut->pieces},
                 {"faces_beyond", cut->beyond},
                 {"rounding", cut->rounding}};
}

}  // namespace chronormal::inline internal
