// Who shares a normal, the terms of those, and a copy for each that shows it.
#include "chronormal/normals/element_blend.h"

#include <cassert>

namespace chronormal {

Result<ElementBlend> ElementBlend::make(BlendSet set, const ElementOptions& options) {
  if (set.topology.face_count() == 0) return invalid_input("", "the mesh has no faces");
  if (const Status status = validate(set); !status) return status.error();
  if (options.kind == ElementKind::kFaces) return ElementBlend(BlendNormals::of_faces(std::move(set)));
  Motion star;  // targets move vertices at one point of the base together, or part them
  star.topology = set.topology;
  star.keyframes = {{set.base, 0, "base"}};
  for (const BlendTarget& target : set.targets) {
    std::vector<float> moved = set.base;
    for (std::size_t n = 0; n < target.vertices.size(); ++n)
      for (std::size_t c = 0; c < 3; ++c) moved[std::size_t{3} * target.vertices[n] + c] += target.deltas[3 * n + c];
    star.keyframes.push_back({std::move(moved), 1, ""});
  }
  star.connect_as_targets();
  Result<NormalGroups> groups = make_groups(star, options);
  if (!groups) return groups.error();
  const auto outputs = groups.value().element_of_output();
  const std::vector<std::uint32_t> element_of_output(outputs.begin(), outputs.end());
  ElementBlend blend(BlendNormals::of_groups(std::move(set), std::move(groups).value()));
  blend.element_of_output_ = element_of_output;
  blend.scratch_.resize(3 * blend.normals_.size());
  return blend;
}

std::size_t ElementBlend::unit_normals(std::span<const double> weights, VectorView<float> result, Threads threads) {
  assert(result.count == size() && weights.size() == normals_.set().targets.size());
  if (element_of_output_.empty()) return normals_.unit_normals(weights, result, threads).zeros;
  const auto elements = VectorView<float>::packed(scratch_.data(), normals_.size());
  normals_.unit_normals(weights, elements, threads);
  std::size_t zeros = 0;
  for (std::size_t i = 0; i < result.count; ++i) {
    const Vec3f normal = elements[element_of_output_[i]];
    result.set(i, normal);
    if (normal == Vec3f{}) ++zeros;
  }
  return zeros;
}

std::size_t ElementBlend::size() const noexcept {
  return element_of_output_.empty() ? normals_.size() : element_of_output_.size();
}

}  // namespace chronormal
