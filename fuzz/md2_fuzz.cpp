// Fuzz target of the reader of MD2: for any bytes, the result is an error with a place, or a valid motion.
#include "io/cache/md2.h"

#include "cache_invariants.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  chronormal::fuzz::check_motion_invariants(chronormal::read_md2(bytes, "fuzz.md2"), size, 1);
  return 0;
}
