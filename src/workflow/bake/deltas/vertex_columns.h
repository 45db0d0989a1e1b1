/// Vectors of vertices in columns, where each column (a target) has one weight. Files store them column by column;
/// adding them up needs them vertex by vertex. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_BAKE_JUDGE_VERTEX_COLUMNS_H_
#define CHRONORMAL_WORKFLOW_BAKE_JUDGE_VERTEX_COLUMNS_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "chronormal/core/vec3.h"

namespace chronormal::inline internal {

/// Vectors of some vertices, ascending; all others are zero.
struct VertexVectors {
  std::vector<std::uint32_t> vertices;
  std::vector<Vec3f> vectors;

  [[nodiscard]] Vec3f at(std::size_t vertex) const noexcept;
};

/// The nonzero deltas of each vertex in one candidate, with their columns.
struct VertexColumns {
  struct Entry {
    std::uint32_t column = 0;
    Vec3f delta;

    friend bool operator==(const Entry&, const Entry&) = default;
  };
  std::vector<std::size_t> first;  ///< (n + 1)
  std::vector<Entry> entries;

  [[nodiscard]] std::span<const Entry> of(std::size_t n) const {
    return std::span(entries).subspan(first[n], first[n + 1] - first[n]);
  }
};

/// Reorders columns of vectors, each for its own vertices, into lists of columns for each vertex.
[[nodiscard]] VertexColumns by_vertex(std::span<const VertexVectors* const> columns,
                                      std::span<const std::uint32_t> vertices);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_JUDGE_VERTEX_COLUMNS_H_
