#include "workflow/bake/candidates/shares.h"

#include <cmath>
#include <utility>

#include "workflow/bake/deltas/unit_targets.h"

namespace chronormal::inline internal {

namespace {

// Multiplies vectors, and makes N + E as long as N where that is asked for; the part of E along N stays where it is asked
// for, too.
void shorten(const RightNormals& rights, double factor, bool is_unit, bool keeps_along, VertexVectors& vectors) {
  for (std::size_t n = 0; n < vectors.vertices.size(); ++n) {
    Vec3f& vector = vectors.vectors[n];
    if (!is_unit) {
      vector = static_cast<float>(factor) * vector;
      continue;
    }
    const BaseNormal base(rights.stored(vectors.vertices[n]));
    const Vec3d part = (factor / base.length) * to_double(vector);
    const Vec3d along = keeps_along ? dot(part, base.direction) * base.direction : Vec3d{};
    vector = to_float(base.length * (unit_delta(base.direction, part) + along));
  }
}

}  // namespace

std::vector<Share> shares_of(const RightNormals& rights, std::vector<VertexVectors> extras, Lengths lengths,
                             const ShortShares& how) {
  std::vector<Share> shares;
  const double factor = weight_factor(lengths);
  for (std::size_t k = 0; k < extras.size(); ++k) {
    if (lengths == Lengths::kUnit) {
      for (const double sign : {1.0, -1.0}) {
        Share share{k, sign, true, extras[k]};
        shorten(rights, sign, true, false, share.vectors);
        shares.push_back(std::move(share));
      }
      continue;
    }
    shorten(rights, 1 / factor, how.are_units, how.keep_along, extras[k]);
    shares.push_back({k, factor, false, std::move(extras[k])});
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
