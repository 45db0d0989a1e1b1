/// Vertex normals of triangle meshes by libraries that people use today: one file for each library, all behind one
/// call.
///
/// Positions go in as the float32 that files hold. A library computes in its own way and precision; what comes out is
/// one normal for each vertex, in the order of the vertices, scaled to length 1.
#ifndef PEERS_PEERS_H_
#define PEERS_PEERS_H_

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "chronormal/core/vec3.h"

namespace chronormal::peers {

/// Must be a manifold, with its faces wound alike: these libraries take nothing else.
struct TriangleMesh {
  std::span<const float> positions;        ///< (V, 3)
  std::span<const std::uint32_t> corners;  ///< (F, 3)

  [[nodiscard]] std::size_t vertex_count() const { return positions.size() / 3; }
  [[nodiscard]] std::size_t face_count() const { return corners.size() / 3; }
};

struct Method {
  std::string library;  ///< with its version
  std::string call;
  std::vector<Vec3d> (*normals)(const TriangleMesh&);
};

[[nodiscard]] std::vector<Method> openmesh_methods();
[[nodiscard]] std::vector<Method> vtk_methods();
[[nodiscard]] std::vector<Method> cgal_methods();

}  // namespace chronormal::peers

#endif  // PEERS_PEERS_H_
