/// The vertices and triangles of a file that shows a sequence. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_VERTICES_H_
#define CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_VERTICES_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "chronormal/core/vec3.h"
#include "chronormal/motion/topology.h"
#include "chronormal/normals/normal_groups.h"

namespace chronormal {

/// The vertices of the motion come first, and behind them their copies, one for each further normal.
struct SequenceVertices {
  static constexpr std::uint32_t kNone = static_cast<std::uint32_t>(-1);

  std::vector<std::uint32_t> vertex;     ///< of each: that of the motion
  std::vector<std::uint32_t> element;    ///< of each: whose normal it shows; kNone where it has no face
  std::vector<std::uint32_t> of_corner;  ///< of each corner of the motion

  [[nodiscard]] std::size_t size() const noexcept { return vertex.size(); }
  /// Positions of the motion, (V, 3), for each vertex of the file.
  [[nodiscard]] std::vector<float> positions(std::span<const float> of_motion) const;
  /// Vectors of elements for each vertex of the file, and `none` for those without a face.
  [[nodiscard]] std::vector<float> vectors(std::span<const Vec3d> of_elements, const Vec3d& none) const;
};

[[nodiscard]] SequenceVertices sequence_vertices(const Topology& topology, const NormalGroups& groups);

/// Polygons as fans of triangles. (Their normals are those of the polygons all the same.)
[[nodiscard]] std::vector<std::uint32_t> fan_triangles(const Topology& topology,
                                                       std::span<const std::uint32_t> vertex_of_corner);

/// Counts the polygons that a fan does not fit: one of its triangles looks the other way.
[[nodiscard]] std::size_t count_not_convex(const Topology& topology, const std::vector<float>& positions);

}  // namespace chronormal

#endif  // CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_VERTICES_H_
