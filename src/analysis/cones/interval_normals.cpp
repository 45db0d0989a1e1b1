#include "analysis/cones/interval_normals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace chronormal::inline internal {

IntervalNormals part_of(const ControlNormals& c, const Restriction& restriction) noexcept {
  IntervalNormals part;
  const std::array<const Vec3d*, 3> from{&c.n0, &c.m, &c.n1};
  const std::array<Vec3d*, 3> to{&part.normals.n0, &part.normals.m, &part.normals.n1};
  for (std::size_t k = 0; k < 3; ++k) {
    double size = 0;
    bool has_term = false;
    for (std::size_t j = 0; j < 3; ++j) {
      const double weight = restriction.weights[k][j];
      if (weight == 0 || *from[j] == Vec3d{}) continue;
      *to[k] = *to[k] + weight * *from[j];
      size += weight * max_abs(*from[j]);
      has_term = true;
    }
    if (has_term) part.unknown = std::fmax(part.unknown, (kNormalShare * size + kUnderflow) / max_abs(*to[k]));
  }
  return part;
}

IntervalNormals exact_part_of(const ExactCurve& exact, double t0, double t1) noexcept {
  return {{exact.normal_at(t0), exact.blossom_at(t0, t1), exact.normal_at(t1)}};
}

NormalCone cone_around(IntervalNormals part) noexcept {
  ControlNormals& c = part.normals;
  const std::array<Vec3d*, 3> vectors{&c.n0, &c.m, &c.n1};
  const auto first = std::find_if_not(vectors.begin(), vectors.end(), [](const Vec3d* v) { return *v == Vec3d{}; });
  if (first == vectors.end()) return NormalCone::empty();
  // cones_of_three() finds no cone for elements with zero vectors. Such vectors are therefore replaced by copies of
  // another vector, which do not change the cone.
  for (Vec3d* const v : vectors) {
    if (*v == Vec3d{}) *v = **first;
  }
  NormalCone cone;
  std::uint16_t flags = 0;
  cones_of_three(&c, 1, part.unknown, &cone, &flags);
  return flags == 0 ? cone : NormalCone::whole_sphere();
}

}  // namespace chronormal::inline internal
