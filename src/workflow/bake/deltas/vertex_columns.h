/// Stores vectors of vertices in columns. Each column belongs to a target, and has one weight in a pose. Files store
/// vectors column by column, but the sum of a vertex needs them vertex by vertex. Private to workflow.
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

/// The deltas of each vertex in one candidate that are not zero, with the columns to which they belong.
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

/// Reorders vectors. Each input column has its own vertices, and the result has a list of columns for each of
/// `vertices`.
[[nodiscard]] VertexColumns by_vertex(std::span<const VertexVectors* const> columns,
                                      std::span<const std::uint32_t> vertices);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_DELTAS_VERTEX_COLUMNS_H_
