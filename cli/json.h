/// The results of commands as JSON, for programs: docs/cli.md has the fields.
#ifndef CLI_JSON_H_
#define CLI_JSON_H_

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace chronormal::cli {

using Json = nlohmann::ordered_json;  // fields stay in the order of the documentation

/// The object of a command with the fields that each begins with.
[[nodiscard]] Json json_of_command(const char* command);

/// The text, indented, with the end of its last line. Names in files need not be UTF-8; what is not becomes U+FFFD.
[[nodiscard]] std::string json_text(const Json& json);

template <class T>
[[nodiscard]] Json or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json();
}

}  // namespace chronormal::cli

#endif  // CLI_JSON_H_
