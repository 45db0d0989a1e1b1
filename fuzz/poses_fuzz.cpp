// Fuzz target of the reader of poses: for any bytes, the result is an error with a place, or poses with finite weights.
#include "chronormal/io/input.h"

#include <cmath>

#include "cache_invariants.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const auto result = chronormal::parse_poses(bytes, "fuzz.json");
  if (!result) {
    chronormal::fuzz::check_error(result.error());
    return 0;
  }
  chronormal::fuzz::require(!result.value().empty(), "there is a pose");
  for (const chronormal::RigPose& pose : result.value()) {
    chronormal::fuzz::require(pose.named.empty() || pose.in_order.empty(), "weights have names or an order");
    for (const double weight : pose.in_order) chronormal::fuzz::require(std::isfinite(weight), "weights are finite");
    for (const auto& named : pose.named) chronormal::fuzz::require(std::isfinite(named.weight), "weights are finite");
  }
  return 0;
}
