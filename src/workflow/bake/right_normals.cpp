// The direction of a right normal is by the weighting that is asked for, its length by area in any case: only areas add
// up to the same from both sides of a pose.
#include "workflow/bake/right_normals.h"

#include <cmath>

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kBlock = 256;
// Below this part of the terms that it is made of the direction of a normal is not judged. An audit draws the line at
// five times that.
constexpr double kLeastLength = 2e-5;

}  // namespace

Vec3d RightNormals::stored(std::size_t vertex) const noexcept {
  const float* const n = base_normals_.data() + 3 * vertex;
  return to_double(Vec3f{n[0], n[1], n[2]});
}

Vec3d RightNormals::judged(std::uint32_t element, const Vec3d& by_area, const Vec3d& direction) const noexcept {
  const double of_base = length(base_[element]), size = length(by_area);
  if (!(size > kLeastLength * std::fmax(of_base, largest_[element]))) return {};
  return (VertexTerms::has_base(base_[element], largest_[element]) ? size / of_base : 1) * unit(direction);
}

std::vector<Vec3d> RightNormals::of_elements(std::span<const double> pose) const {
  std::vector<Vec3d> result = terms_.by_area_at(pose);
  const std::vector<Vec3d> weighted = terms_.is_fitted() ? terms_.exact_at(pose) : std::vector<Vec3d>();
  parallel_each(result.size(), kBlock, [&](std::size_t e) {
    result[e] = judged(static_cast<std::uint32_t>(e), result[e], weighted.empty() ? result[e] : weighted[e]);
  });
  return result;
}

std::vector<Vec3d> RightNormals::of_elements(std::span<const double> pose,
                                             std::span<const std::uint32_t> elements) const {
  std::vector<Vec3d> result(elements.size());
  if (terms_.is_fitted()) {
    const std::vector<Vec3d> all = of_elements(pose);
    for (std::size_t n = 0; n < elements.size(); ++n) result[n] = all[elements[n]];
    return result;
  }
  std::vector<double> positions(shading_.set.base.size());
  blend_positions(shading_.set, pose, positions);
  parallel_each(elements.size(), kBlock, [&](std::size_t n) {
    const Vec3d normal = normal_from_positions(shading_, positions, elements[n]);
    result[n] = judged(elements[n], normal, normal);
  });
  return result;
}

Vec3d RightNormals::of_vertex(std::size_t vertex, const Vec3d& of_element) const noexcept {
  if (of_element == Vec3d{}) return {};
  const std::uint32_t element = shading_.element_of_vertex[vertex];
  return length(of_element) * shown_direction(stored(vertex), base_[element], of_element);
}

}  // namespace chronormal::inline internal
