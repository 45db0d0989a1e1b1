// The length of a right normal is by area, whatever weighs its direction (AuthorSum::with_area_length()), in the base
// as in every pose.
#include "workflow/bake/deltas/right_normals.h"

#include <cmath>

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kRightBlock = 256;
// Below this part of its terms, the direction of a normal is not judged. An audit draws the line at five times this.
constexpr double kLeastTerms = 2e-5;

}  // namespace

RightNormals::RightNormals(const GltfShading& shading, const NormalTerms& terms, std::span<const float> base_normals,
                           const std::vector<double>& largest)
    : shading_(shading),
      terms_(terms),
      base_normals_(base_normals),
      largest_(largest),
      base_(shading.groups.size()),
      base_lengths_(base_.size()),
      all_elements_(base_.size()),
      turns_(shading.element_of_vertex.size()) {
  parallel_each(base_.size(), kRightBlock, [&](std::size_t e) {
    base_[e] = terms_.base_of(static_cast<std::uint32_t>(e));
    base_lengths_[e] = length(base_[e]);
    all_elements_[e] = static_cast<std::uint32_t>(e);
  });
  parallel_each(turns_.size(), kRightBlock, [&](std::size_t v) {
    const std::uint32_t element = shading_.element_of_vertex[v];
    if (element != GltfShading::kNoElement) turns_[v] = ShownTurn(stored(v), base_[element]);
  });
}

RightNormals::Places::Places(const GltfShading& shading, std::span<const std::uint32_t> vertices) {
  std::vector<std::size_t> place(shading.groups.size(), 0);
  for (const std::uint32_t v : vertices) place[shading.element_of_vertex[v]] = 1;
  for (std::uint32_t e = 0; e < place.size(); ++e) {
    if (place[e] == 0) continue;
    place[e] = elements.size();
    elements.push_back(e);
  }
  for (const std::uint32_t v : vertices) of_vertices.push_back(place[shading.element_of_vertex[v]]);
}

Vec3d RightNormals::stored(std::size_t vertex) const noexcept {
  const float* const n = base_normals_.data() + 3 * vertex;
  return to_double(Vec3f{n[0], n[1], n[2]});
}

Vec3d RightNormals::judged(std::uint32_t element, const Vec3d& normal) const noexcept {
  const double of_base = base_lengths_[element], size = length(normal);
  if (!(size > kLeastTerms * std::max(of_base, largest_[element]))) return {};
  return (VertexTerms::has_base(of_base, largest_[element]) ? size / of_base : 1) * unit(normal);
}

std::vector<Vec3d> RightNormals::of_elements(std::span<const double> pose) const {
  return of_elements(pose, all_elements_);
}

std::vector<Vec3d> RightNormals::of_elements(std::span<const double> pose,
                                             std::span<const std::uint32_t> elements) const {
  std::vector<Vec3d> result(elements.size());
  if (terms_.is_fitted()) {
    const std::vector<Vec3d> weighted = terms_.weighted_at(pose, elements);
    parallel_each(elements.size(), kRightBlock, [&](std::size_t n) { result[n] = judged(elements[n], weighted[n]); });
    return result;
  }
  std::vector<double> positions(shading_.set.base.size());
  blend_positions(shading_.set, pose, positions);
  parallel_each(elements.size(), kRightBlock, [&](std::size_t n) {
    result[n] = judged(elements[n], normal_from_positions(shading_, positions, elements[n]));
  });
  return result;
}

Vec3d RightNormals::of_vertex(std::size_t vertex, const Vec3d& of_element) const noexcept {
  return turns_[vertex](of_element);
}

}  // namespace chronormal::inline internal
