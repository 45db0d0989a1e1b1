// Fuzz target of the reader of parts, which are the results of shards, and of the records of a journal. For any bytes,
// the result is an error with a message, or a result that can be printed.
#include "workflow/json/parts.h"

#include <string>
#include <vector>

#include "cache_invariants.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  // A line feed in the input separates two parts.
  const std::size_t line = bytes.find('\n');
  std::vector<chronormal::Part> parts = {{"first.json", bytes.substr(0, line)}};
  if (line != std::string::npos) parts.push_back({"second.json", bytes.substr(line + 1)});
  const auto merged = chronormal::merge_parts(parts);
  if (merged)
    chronormal::fuzz::require(merged.value().json.starts_with("{"), "a merge is one object");
  else
    chronormal::fuzz::require(!merged.error().message.empty(), "an error has a message");
  const auto compared = chronormal::read_compared_segment(bytes, "fuzz");
  if (!compared) chronormal::fuzz::check_error(compared.error());
  const auto measured = chronormal::read_measured_segment(bytes, "fuzz");
  if (!measured) chronormal::fuzz::check_error(measured.error());
  return 0;
}
