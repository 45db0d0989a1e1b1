// Fuzz target of the glTF reader: for any bytes, every function that reads returns an error with a place, or a result
// that satisfies its contract.
#include "chronormal/io/gltf_document.h"

#include <cstdint>
#include <string>
#include <string_view>

#include "gltf_invariants.h"
#include "mesh_invariants.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kMostBytes = std::size_t{1} << 20;
  const std::string name = "fuzz.gltf";
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const chronormal::Result<chronormal::GltfDocument> document = chronormal::GltfDocument::read(bytes, name);
  const chronormal::fuzz::GltfReading reading = chronormal::fuzz::read_all_of(document, name, kMostBytes);
  chronormal::fuzz::require(reading.broken.empty(), reading.broken.c_str());
  return 0;
}
