#include "workflow/bake/deltas/shared_parts.h"

#include <algorithm>

#include "io/gltf/glb/new_arrays.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kComponents = 3;

// Returns true if two parts have equal floats in an array with `width` floats for each vertex. The array may be empty.
bool have_same(const std::vector<float>& all, std::size_t width, const GltfPart& a, const GltfPart& b) {
  const auto begin = [&](const GltfPart& part) {
    return all.begin() + static_cast<std::ptrdiff_t>(width * part.first_vertex);
  };
  return all.empty() || std::equal(begin(a), begin(a) + static_cast<std::ptrdiff_t>(width * a.vertex_count), begin(b));
}

// The entries of a target that belong to one part, as indices from `first` up to `last`, without `last`.
struct PartEntries {
  std::size_t first = 0, last = 0;
};

PartEntries entries_in(const std::vector<std::uint32_t>& vertices, const GltfPart& part) {
  const auto first = std::lower_bound(vertices.begin(), vertices.end(), part.first_vertex);
  const auto last = std::lower_bound(first, vertices.end(), part.first_vertex + part.vertex_count);
  return {static_cast<std::size_t>(first - vertices.begin()), static_cast<std::size_t>(last - vertices.begin())};
}

bool move_same(const BlendTarget& target, const GltfPart& a, const GltfPart& b) {
  const PartEntries of_a = entries_in(target.vertices, a), of_b = entries_in(target.vertices, b);
  if (of_a.last - of_a.first != of_b.last - of_b.first) return false;
  for (std::size_t n = of_a.first, m = of_b.first; n < of_a.last; ++n, ++m) {
    if (target.vertices[n] - a.first_vertex != target.vertices[m] - b.first_vertex) return false;
    for (std::size_t c = 0; c < kComponents; ++c)
      if (target.deltas[kComponents * n + c] != target.deltas[kComponents * m + c]) return false;
  }
  return true;
}

bool is_zero(const float* vector) { return vector[0] == 0 && vector[1] == 0 && vector[2] == 0; }

}  // namespace

SharedParts::SharedParts(const GltfShading& shading) : shading_(shading) {
  for (std::size_t p = 0; p < shading.parts.size(); ++p) {
    const auto found = std::find_if(groups_.begin(), groups_.end(), [&](const auto& group) {
      return are_alike(shading.parts[group.front()], shading.parts[p]);
    });
    if (found == groups_.end())
      groups_.push_back({p});
    else
      found->push_back(p);
  }
}

bool SharedParts::are_alike(const GltfPart& a, const GltfPart& b) const {
  if (a.vertex_count != b.vertex_count || !have_same(shading_.set.base, kComponents, a, b) ||
      !have_same(shading_.normals, kComponents, a, b) || !have_same(shading_.tangents, 4, a, b))
    return false;
  for (std::size_t k = 0; k < shading_.set.targets.size(); ++k)
    if (!move_same(shading_.set.targets[k], a, b) || !have_same(shading_.normal_deltas[k], kComponents, a, b) ||
        !have_same(shading_.tangent_deltas[k], kComponents, a, b))
      return false;
  return true;
}

void SharedParts::join(TargetDeltas& deltas) const {
  for (const std::vector<std::size_t>& group : groups_) {
    const std::size_t count = shading_.parts[group.front()].vertex_count;
    const bool has_any =
        std::any_of(group.begin(), group.end(), [&](std::size_t p) { return !deltas.of_parts[p].empty(); });
    if (group.size() == 1 || !has_any) continue;
    std::vector<float> all = deltas.of_parts[group.front()];
    all.resize(kComponents * count);
    std::vector<bool> is_shown(count, false);
    bool fits = true;
    for (const std::size_t p : group) {
      const std::vector<float>& own = deltas.of_parts[p];
      for (std::size_t v = 0; v < count; ++v) {
        if (shading_.element_of_vertex[shading_.parts[p].first_vertex + v] == GltfShading::kNoElement) continue;
        for (std::size_t c = kComponents * v; c < kComponents * (v + 1); ++c) {
          const float value = own.empty() ? 0 : own[c];
          fits = fits && (!is_shown[v] || all[c] == value);
          all[c] = value;
        }
        is_shown[v] = true;
      }
    }
    if (!fits) continue;
    for (const std::size_t p : group) deltas.of_parts[p] = all;
  }
}

std::size_t SharedParts::bytes_of(const TargetDeltas& deltas) const {
  std::size_t total = 0;
  for (const std::vector<std::size_t>& group : groups_) {
    for (const std::size_t p : group) {
      const std::vector<float>& own = deltas.of_parts[p];
      if (p != group.front() && own == deltas.of_parts[group.front()]) continue;
      std::size_t used = 0, last = 0;
      for (std::size_t v = 0; kComponents * v < own.size(); ++v) {
        if (is_zero(own.data() + kComponents * v)) continue;
        ++used;
        last = v;
      }
      total += gltf::bytes_of_floats(used, last, own.size() / kComponents, kComponents);
    }
  }
  return total;
}

std::size_t SharedParts::bytes_of(const VertexVectors& deltas) const {
  std::size_t total = 0;
  for (const std::vector<std::size_t>& group : groups_) {
    std::vector<std::size_t> used;
    for (const std::size_t p : group) {
      const GltfPart& part = shading_.parts[p];
      const PartEntries entries = entries_in(deltas.vertices, part);
      for (std::size_t n = entries.first; n < entries.last; ++n) used.push_back(deltas.vertices[n] - part.first_vertex);
    }
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    const std::size_t count = shading_.parts[group.front()].vertex_count;
    total += gltf::bytes_of_floats(used.size(), used.empty() ? 0 : used.back(), count, kComponents);
  }
  return total;
}

}  // namespace chronormal::inline internal
