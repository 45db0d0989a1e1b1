// Fuzz target of the reader of Maya's point caches: for any bytes, the result is an error with a place, or a cache.
#include "io/cache/maya_cache.h"

#include "cache_invariants.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  chronormal::fuzz::check_cache_invariants(chronormal::read_maya_points(bytes, "fuzz.mc"), size);
  chronormal::fuzz::check_cache_invariants(chronormal::read_maya_points(bytes, "fuzz.mc", {1, 3, ""}), size);
  return 0;
}
