#include "workflow/truth/stored_keys.h"

#include <utility>

namespace chronormal::inline internal {
namespace {

Vec3d vector_of(const std::vector<float>& values, std::size_t vertex) noexcept {
  const float* const v = values.data() + 3 * vertex;
  return {v[0], v[1], v[2]};
}

}  // namespace

StoredKey::StoredKey(const GltfShading& shading) : shading_(&shading) {}

StoredKey::StoredKey(const GltfShading& shading, std::size_t target) : StoredKey(shading) {
  const BlendTarget& moved = shading.set.targets[target];
  if (!moved.vertices.empty()) moved_ = shading.set.base;
  for (std::size_t n = 0; n < moved.vertices.size(); ++n)
    for (std::size_t c = 0; c < 3; ++c) moved_[3 * std::size_t{moved.vertices[n]} + c] += moved.deltas[3 * n + c];
  deltas_ = &shading.normal_deltas[target];
}

Vec3d StoredKey::normal(std::uint32_t vertex) const noexcept {
  const Vec3d base = vector_of(shading_->normals, vertex);
  return deltas_ == nullptr || deltas_->empty() ? base : base + vector_of(*deltas_, vertex);
}

bool StoredKey::turns(std::uint32_t vertex) const noexcept {
  return deltas_ != nullptr && !deltas_->empty() && vector_of(*deltas_, vertex) != Vec3d{};
}

std::vector<std::size_t> targets_with_normals(const GltfShading& shading) {
  std::vector<std::size_t> result;
  if (shading.mark) return result;
  for (std::size_t k = 0; k < shading.set.targets.size(); ++k)
    if (shading.turns[k] && !shading.normal_deltas[k].empty()) result.push_back(k);
  return result;
}

std::vector<std::uint32_t> vertices_of_elements(const GltfShading& shading) {
  std::vector<std::uint32_t> result(shading.groups.size(), GltfShading::kNoElement);
  for (std::uint32_t v = 0; v < shading.element_of_vertex.size(); ++v) {
    const std::uint32_t e = shading.element_of_vertex[v];
    if (e != GltfShading::kNoElement && result[e] == GltfShading::kNoElement) result[e] = v;
  }
  return result;
}

}  // namespace chronormal::inline internal
