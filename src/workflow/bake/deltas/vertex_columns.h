/// Stores vectors of vertices in columns. Each column belongs to a target, and is multiplied by the weight of this
/// target in a pose. Files store vectors column by column, but the sum at a vertex needs all vectors of this vertex.
/// Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_BAKE_DELTAS_VERTEX_COLUMNS_H_
#define CHRONORMAL_WORKFLOW_BAKE_DELTAS_VERTEX_COLUMNS_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "chronormal/core/vec3.h"

namespace chronormal::inline internal {

/// The vectors of some vertices, in ascending order of the vertices. All other vertices have the vector (0, 0, 0).
struct VertexVectors {
  std::vector<std::uint32_t> vertices;
  std::vector<Vec3f> vectors;

  [[nodiscard]] Vec3f at(std::size_t vertex) const noexcept;
};

/// The deltas of a candidate that are not zero, vertex by vertex. Each delta has the index of its column, which is a
/// target.
struct VertexColumns {
  struct Entry {
    std::uint32_t column = 0;
    Vec3f delta;

    friend bool operator==(const Entry&, const Entry&) = default;
  };
  std::vector<std::size_t> first;  ///< (n + 1), for each vertex the index of its first entry
  std::vector<Entry> entries;

  [[nodiscard]] std::span<const Entry> of(std::size_t n) const {
    return std::span(entries).subspan(first[n], first[n + 1] - first[n]);
  }
};

/// Reorders vectors from columns to vertices. Each column has its own list of vertices. The result has, for each vertex
/// in `vertices`, the vectors of all columns.
[[nodiscard]] VertexColumns by_vertex(std::span<const VertexVectors* const> columns,
                                      std::span<const std::uint32_t> vertices);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_DELTAS_VERTEX_COLUMNS_H_
