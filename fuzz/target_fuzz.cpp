// Fuzz target of the reader of MakeHuman targets, plain or compressed by gzip: for any bytes, the result is an error
// with a place, or deltas whose vertices exist in the base mesh.
#include "io/mesh/make_human_target.h"

#include <cmath>
#include <vector>

#include "cache_invariants.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kVertices = 200;
  std::vector<float> base(3 * kVertices);
  for (std::size_t i = 0; i < base.size(); ++i) base[i] = i % 7 == 0 ? 3e38F : static_cast<float>(i);
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const auto result = chronormal::read_make_human_target(
      bytes, "fuzz.target", chronormal::VectorView<const float>::packed(base.data(), kVertices));
  if (!result) {
    chronormal::fuzz::check_error(result.error());
    return 0;
  }
  const auto& [vertices, deltas] = result.value();
  chronormal::fuzz::require(deltas.size() == 3 * vertices.size(), "every vertex has a delta");
  std::vector<bool> is_listed(kVertices);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    chronormal::fuzz::require(vertices[i] < kVertices, "vertices are those of the base");
    chronormal::fuzz::require(!is_listed[vertices[i]], "no vertex comes twice");
    is_listed[vertices[i]] = true;
    for (std::size_t axis = 0; axis < 3; ++axis)
      chronormal::fuzz::require(std::isfinite(base[3 * vertices[i] + axis] + deltas[3 * i + axis]), "sums are finite");
  }
  return 0;
}
