#include "cli/json.h"

#include "cli/version.h"

namespace chronormal::cli {

Json json_of_command(const char* command) { return {{"chronormal", kVersion}, {"command", command}, {"schema", 1}}; }

std::string json_text(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n'; }

}  // namespace chronormal::cli
