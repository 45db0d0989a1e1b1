#include "workflow/bake/forms/opposite_targets.h"

#include <array>
#include <cmath>
#include <utility>

#include "workflow/bake/forms/unit_targets.h"

namespace chronormal::inline internal {
namespace {

// Differences of unit normals: how long they may be, and by what they are brought down at most.
constexpr double kLongestOpposite = 1, kMostOpposite = 8;
}  // namespace

void split_into_opposites(const RightNormals& rights, std::vector<ExtraWeight>& weights,
                          std::vector<VertexVectors>& extras) {
  std::vector<ExtraWeight> new_weights;
  std::vector<VertexVectors> new_extras;
  for (std::size_t k = 0; k < extras.size(); ++k) {
    const auto& [vertices, vectors] = extras[k];
    double longest = 0;
    for (std::size_t n = 0; n < vertices.size(); ++n)
      longest = std::fmax(longest, length(to_double(vectors[n])) / BaseNormal(rights.stored(vertices[n])).length);
    double scale = 1;
    while (scale < kMostOpposite && longest > kLongestOpposite * scale) scale *= 2;
    std::array<VertexVectors, 2> parts;
    for (std::size_t n = 0; n < vertices.size(); ++n) {
      const BaseNormal base(rights.stored(vertices[n]));
      const Vec3d vector = (1 / (scale * base.length)) * to_double(vectors[n]);
      auto both = opposite_units(base.direction, vector);
      // What goes along the base normal has no room where that is an axis, and turns least.
      if (!both) both = opposite_units(base.direction, vector - dot(vector, base.direction) * base.direction);
      if (!both) continue;
      for (std::size_t part = 0; part < 2; ++part) {
        parts[part].vertices.push_back(vertices[n]);
        parts[part].vectors.push_back(to_float(base.length * ((*both)[part] - base.direction)));
      }
    }
    for (std::size_t part = 0; part < 2; ++part) {
      const double factor = part == 0 ? scale : -scale;
      ExtraWeight weight = weights[k];
      weight.linear *= factor;
      weight.quadratic *= factor;
      new_weights.push_back(weight);
      new_extras.push_back(std::move(parts[part]));
    }
  }
  weights = std::move(new_weights);
  extras = std::move(new_extras);
}

}  // namespace chronormal::inline internal
