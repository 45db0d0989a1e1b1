/// Lists the pairs of vertices between which a jump of the error is visible. Private to workflow.
///
/// Normals are interpolated over faces. If two neighbouring vertices have the same error, the surface between them
/// looks right. If they have different errors, the surface shows a fold that does not exist. The *tear* of a pair of
/// vertices measures the difference of their errors as an angle, from the length of the difference of the two error
/// vectors:
///
///     tear(a, b) = 2 asin(min(1, |(s_a - u_a) - (s_b - u_b)| / 2)),   s rendered and u true, both unit vectors
#ifndef CHRONORMAL_WORKFLOW_SHADING_SURFACE_EDGES_H_
#define CHRONORMAL_WORKFLOW_SHADING_SURFACE_EDGES_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "chronormal/core/vec3.h"
#include "workflow/shading/gltf_shading.h"

namespace chronormal::inline internal {

/// A pair of vertices on the surface. The lower index comes first.
using SurfaceEdge = std::array<std::uint32_t, 2>;

/// Lists the edges of all faces, and the pairs of vertices that share a point and a normal (texture seams). The list
/// has each pair once, in ascending order. Vertices without a normal of their own are in no pair. Takes O(corners log
/// corners).
[[nodiscard]] std::vector<SurfaceEdge> surface_edges(const GltfShading& shading);

/// The numbers of pairs of vertices with a tear beyond 10, 20 and 40 degrees.
struct TearCounts {
  static constexpr std::array<float, 3> kDegrees = {10, 20, 40};

  /// The limits of 10, 20 and 40 degrees as squared lengths of the difference of two error vectors: (2 sin(angle /
  /// 2))^2.
  static constexpr std::array<float, 3> kSquares = {0.030384494F, 0.12061476F, 0.46791112F};

  std::array<std::size_t, 3> beyond{};

  void add(const TearCounts& other) noexcept {
    for (std::size_t k = 0; k < beyond.size(); ++k) beyond[k] += other.beyond[k];
  }
  /// Adds the tears between two vertices in some poses. a and b have the errors of the two vertices (rendered minus
  /// true unit normal) as planes of x, y and z, (3, poses). A pose in which an error is NaN adds no tear.
  void add(const float* a, const float* b, std::size_t poses) noexcept {
    std::array<std::uint32_t, 3> counts{};
    for (std::size_t p = 0; p < poses; ++p) {
      const float x = a[p] - b[p], y = a[poses + p] - b[poses + p], z = a[2 * poses + p] - b[2 * poses + p];
      const float square = x * x + y * y + z * z;
      for (std::size_t k = 0; k < counts.size(); ++k) counts[k] += square > kSquares[k] ? 1U : 0U;
    }
    for (std::size_t k = 0; k < counts.size(); ++k) beyond[k] += counts[k];
  }
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_SHADING_SURFACE_EDGES_H_
