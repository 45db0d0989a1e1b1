#include "workflow/truth/stored_keys.h"

#include <utility>

namespace chronormal::inline internal {
namespace {

Vec3d vector_of(const std::vector<float>& values, std::size_t vertex) noexcept {
  const float* const v = values.data() + 3 * vertex;
  return {v[0], v[1], v[2]};
}

// Returns the weight of a correction target in the pose in which `target` has weight 1 and all other targets have
// weight 0.
double weight_at_key(const GltfExtraTarget& extra, std::size_t target) {
  double weight = 0;
  for (const auto& term : extra.linear) weight += term.i == target ? term.a : 0;
  for (const auto& term : extra.quadratic) weight += term.i == target && term.j == target ? term.q : 0;
  return weight;
}

// Calls visit(target, weight) for `target` and for all correction targets that change normals in the pose in which
// `target` has weight 1 and all other targets of the author have weight 0.
template <class Visit>
void for_shown_at_key(const GltfShading& shading, std::size_t target, const Visit& visit) {
  if (!shading.normal_deltas[target].empty()) visit(target, 1.0);
  if (!shading.mark) return;
  for (const GltfExtraTarget& extra : shading.mark->extras) {
    const double weight = weight_at_key(extra, target);
    if (weight != 0 && !shading.normal_deltas[extra.target].empty()) visit(extra.target, weight);
  }
}

}  // namespace

StoredKey::StoredKey(const GltfShading& shading) : shading_(&shading) {}

StoredKey::StoredKey(const GltfShading& shading, std::size_t target) : StoredKey(shading) {
  const BlendTarget& moved = shading.set.targets[target];
  if (!moved.vertices.empty()) moved_ = shading.set.base;
  for (std::size_t n = 0; n < moved.vertices.size(); ++n)
    for (std::size_t c = 0; c < 3; ++c) moved_[3 * std::size_t{moved.vertices[n]} + c] += moved.deltas[3 * n + c];
  for_shown_at_key(shading, target, [&](std::size_t shown, double weight) {
    parts_.push_back({&shading.normal_deltas[shown], weight});
  });
}

Vec3d StoredKey::delta(std::uint32_t vertex) const noexcept {
  Vec3d sum;
  for (const Part& part : parts_) sum = sum + part.weight * vector_of(*part.deltas, vertex);
  return sum;
}

Vec3d StoredKey::normal(std::uint32_t vertex) const noexcept {
  return vector_of(shading_->normals, vertex) + delta(vertex);
}

bool StoredKey::turns(std::uint32_t vertex) const noexcept { return delta(vertex) != Vec3d{}; }

std::vector<std::size_t> targets_with_normals(const GltfShading& shading) {
  std::vector<std::size_t> result;
  if (shading.mark && !shading.mark->author) return result;
  std::vector<bool> is_extra(shading.set.targets.size());
  if (shading.mark)
    for (const GltfExtraTarget& extra : shading.mark->extras) is_extra[extra.target] = true;
  for (std::size_t k = 0; k < is_extra.size(); ++k) {
    bool turns = false;
    if (!is_extra[k])
      for_shown_at_key(shading, k, [&](std::size_t shown, double) { turns = turns || shading.turns[shown]; });
    if (turns) result.push_back(k);
  }
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
