// Fuzz target of the reader of NumPy archives: for any bytes, the result is an error with a place, or a valid motion.
#include "io/cache/npz.h"

#include "cache_invariants.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  // Data compressed by deflate expands at most 1033-fold, so a byte gives at most that many positions.
  chronormal::fuzz::check_motion_invariants(chronormal::read_npz(bytes, "fuzz.npz"), size, 1033);
  return 0;
}
