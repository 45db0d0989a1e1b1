// Fuzz target of the reader of the XML files that describe Maya's caches: for any bytes, the result is an error with a
// place, or a consistent description.
#include "io/cache/maya_cache.h"

#include "cache_invariants.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const auto result = chronormal::read_maya_description(bytes, "fuzz.xml");
  if (!result) {
    chronormal::fuzz::check_error(result.error());
    return 0;
  }
  chronormal::fuzz::require(result.value().ticks_per_frame > 0, "a frame has ticks");
  for (const auto& channel : result.value().channels)
    chronormal::fuzz::require(!channel.is_regular || channel.step > 0, "a regular channel has a step");
  return 0;
}
