// Fuzz target of the reader of NumPy archives: whatever the bytes are, the result is an error with a place, or a valid
// motion.
#include "io/cache/npz.h"

#include "cache_invariants.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  chronormal::fuzz::check_motion_invariants(chronormal::read_npz(bytes, "fuzz.npz"), size, 1033);  // deflate
  return 0;
}
