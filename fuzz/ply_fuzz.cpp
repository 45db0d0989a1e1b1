// Fuzz target of the PLY reader: for any bytes, the result is an error with a place, or a valid mesh that is no larger
// than the bytes can describe.
#include "io/mesh/ply.h"
#include "mesh_invariants.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  chronormal::fuzz::check_mesh_invariants(chronormal::read_ply(bytes, "fuzz.ply"), size);
  chronormal::fuzz::check_mesh_invariants(chronormal::read_moving_ply(bytes, "fuzz.ply"), size);
  return 0;
}
