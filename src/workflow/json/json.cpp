// Writes the parts that the JSON of several commands has in common.
#include "core/text.h"
#include "workflow/json/object.h"

namespace chronormal::inline internal {

Json json_of_command(const char* command, int schema) {
  return {{"chronormal", CHRONORMAL_VERSION}, {"command", command}, {"schema", schema}};
}

// Control characters that JSON lets stand are those from DEL on, inside of texts: as escapes they are the same texts.
std::string json_text(const Json& json) {
  return escaped_for_json(json.dump(2, ' ', false, Json::error_handler_t::replace)) + '\n';
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
