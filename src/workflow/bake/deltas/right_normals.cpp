// Computes right normals. The length of a right normal comes from area weighting, in the base and in every pose, even
// if another weighting determines its direction (AuthorSum::with_area_length()).
#include "workflow/bake/deltas/right_normals.h"

#include <cmath>

#include "analysis/quality/kernels/shown_angles.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kRightBlock = 256;
// The smallest length of a normal whose direction is judged, relative to its largest term. Audits use a limit that is
// five times as high.
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

bool RightNormals::is_judged(std::uint32_t element, const Vec3d& normal) const noexcept {
  const double least = kLeastTerms * std::max(base_lengths_[element], largest_[element]);
  return max_abs(normal) > least || length(normal) > least;  // the first test is faster, and decides for most normals
}

std::vector<Vec3d> RightNormals::normals_of(std::span<const double> pose,
                                            std::span<const std::uint32_t> elements) const {
  if (terms_.is_fitted()) return terms_.weighted_at(pose, elements);
  std::vector<double> positions(shading_.set.base.size());
  blend_positions(shading_.set, pose, positions);
  std::vector<Vec3d> result(elements.size());
  parallel_each(elements.size(), kRightBlock,
                [&](std::size_t n) { result[n] = normal_from_positions(shading_, positions, elements[n]); });
  return result;
}

std::vector<Vec3d> RightNormals::directions_of(std::span<const double> pose,
                                               std::span<const std::uint32_t> elements) const {
  std::vector<Vec3d> result = normals_of(pose, elements);
  for (std::size_t n = 0; n < result.size(); ++n)
    if (!is_judged(elements[n], result[n])) result[n] = {};
  make_units(result);
  return result;
}

std::vector<Vec3d> RightNormals::of_elements(std::span<const double> pose) const {
  return of_elements(pose, all_elements_);
}

std::vector<Vec3d> RightNormals::of_elements(std::span<const double> pose,
                                             std::span<const std::uint32_t> elements) const {
  std::vector<Vec3d> result = normals_of(pose, elements);
  parallel_each(result.size(), kRightBlock, [&](std::size_t n) {
    const std::uint32_t e = elements[n];
    const double of_base = base_lengths_[e];
    if (!is_judged(e, result[n])) {
      result[n] = {};
    } else {
      const double size = VertexTerms::has_base(of_base, largest_[e]) ? length(result[n]) / of_base : 1;
      result[n] = size * unit(result[n]);
    }
  });
  return result;
}

Vec3d RightNormals::of_vertex(std::size_t vertex, const Vec3d& of_element) const noexcept {
  return turns_[vertex](of_element);
}

}  // namespace chronormal::inline internal
