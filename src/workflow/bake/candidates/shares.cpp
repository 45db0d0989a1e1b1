#include "workflow/bake/candidates/shares.h"

#include <cmath>
#include <utility>

#include "workflow/bake/deltas/unit_targets.h"

namespace chronormal::inline internal {

std::vector<Share> shares_of(const RightNormals& rights, std::vector<VertexVectors> extras, Lengths lengths) {
  std::vector<Share> shares;
  if (lengths != Lengths::kUnit) {
    const double factor = weight_factor(lengths);
    for (std::size_t k = 0; k < extras.size(); ++k) {
      for (Vec3f& vector : extras[k].vectors) vector = static_cast<float>(1 / factor) * vector;
      shares.push_back({k, factor, false, std::move(extras[k])});
    }
  } else {
    for (std::size_t k = 0; k < extras.size(); ++k) {
      for (const double sign : {1.0, -1.0}) {
        Share share{k, sign, true, extras[k]};
        for (std::size_t n = 0; n < share.vectors.vertices.size(); ++n) {
          const BaseNormal base(rights.stored(share.vectors.vertices[n]));
          const Vec3d vector = (sign / base.length) * to_double(share.vectors.vectors[n]);
          share.vectors.vectors[n] = to_float(base.length * unit_delta(base.direction, vector));
        }
        shares.push_back(std::move(share));
      }
    }
  }
  return shares;
}

void take_shares(std::span<const Share> shares, std::size_t extras, std::vector<double>& values) {
  std::vector<double> result;
  for (std::size_t first = 0; first < values.size(); first += extras) {
    for (const Share& share : shares) {
      const double value = share.factor * values[first + share.of];
      result.push_back(share.above_zero ? std::fmax(value, 0) : value);
    }
  }
  values = std::move(result);
}

}  // namespace chronormal::inline internal
