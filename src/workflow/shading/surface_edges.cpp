#include "workflow/shading/surface_edges.h"

#include <algorithm>
#include <utility>

namespace chronormal::inline internal {

std::vector<SurfaceEdge> surface_edges(const GltfShading& shading) {
  const std::vector<std::uint32_t>& elements = shading.element_of_vertex;
  std::vector<SurfaceEdge> edges;
  const auto add = [&](std::uint32_t a, std::uint32_t b) {
    const bool are_shown = elements[a] != GltfShading::kNoElement && elements[b] != GltfShading::kNoElement;
    if (are_shown && a != b) edges.push_back({std::min(a, b), std::max(a, b)});
  };
  const Topology& topology = shading.set.topology;
  edges.reserve(topology.corner_count() + elements.size());
  for (std::size_t f = 0; f < topology.face_count(); ++f) {
    const auto corners = topology.face(f);
    for (std::size_t c = 0; c < corners.size(); ++c) add(corners[c], corners[(c + 1) % corners.size()]);
  }
  // Links the vertices of each element in a chain. Each pair of neighbours in the chain becomes an edge.
  std::vector<std::uint32_t> last(shading.groups.size(), GltfShading::kNoElement);
  for (std::uint32_t v = 0; v < elements.size(); ++v) {
    if (elements[v] == GltfShading::kNoElement) continue;
    const std::uint32_t before = std::exchange(last[elements[v]], v);
    if (before != GltfShading::kNoElement) add(before, v);
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  edges.shrink_to_fit();  // frees the unused half of the memory
  return edges;
}

}  // namespace chronormal::inline internal
