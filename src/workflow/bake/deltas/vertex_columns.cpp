#include "workflow/bake/deltas/vertex_columns.h"

#include <algorithm>

namespace chronormal::inline internal {

Vec3f VertexVectors::at(std::size_t vertex) const noexcept {
  const auto found = std::lower_bound(vertices.begin(), vertices.end(), vertex);
  return found == vertices.end() || *found != vertex ? Vec3f{}
                                                     : vectors[static_cast<std::size_t>(found - vertices.begin())];
}

VertexColumns by_vertex(std::span<const VertexVectors* const> columns, std::span<const std::uint32_t> vertices) {
  VertexColumns result;
  result.first.assign(vertices.size() + 1, 0);
  // Calls visit(n, k) for each vector of a column that is not zero and belongs to one of `vertices`. n is the index of
  // the vertex in `vertices`, and k the index of the vector in the column. Both lists of vertices are ascending.
  const auto walk = [&](const VertexVectors& column, const auto& visit) {
    std::size_t n = 0;
    for (std::size_t k = 0; k < column.vertices.size(); ++k) {
      while (n < vertices.size() && vertices[n] < column.vertices[k]) ++n;
      if (n < vertices.size() && vertices[n] == column.vertices[k] && column.vectors[k] != Vec3f{}) visit(n, k);
    }
  };
  for (const VertexVectors* column : columns) walk(*column, [&](std::size_t n, std::size_t) { ++result.first[n + 1]; });
  for (std::size_t n = 0; n < vertices.size(); ++n) result.first[n + 1] += result.first[n];
  result.entries.resize(result.first.back());
  std::vector<std::size_t> next(result.first.begin(), result.first.end() - 1);
  for (std::size_t c = 0; c < columns.size(); ++c) {
    walk(*columns[c], [&](std::size_t n, std::size_t k) {
      result.entries[next[n]++] = {static_cast<std::uint32_t>(c), columns[c]->vectors[k]};
    });
  }
  return result;
}

}  // namespace chronormal::inline internal
