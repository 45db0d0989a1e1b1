/// Computes normals of triangle meshes by libraries that people use today. Each library has its own file, and all have
/// the same interface.
///
/// Positions are passed as float32, as in files. A library computes in its own way and precision, and returns one
/// normal for each element, in the order of the elements, scaled to length 1.
///
/// A LibraryMesh is built once, and normals are computed repeatedly in place. ./run bench times these computations.
#ifndef PEERS_PEERS_H_
#define PEERS_PEERS_H_

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "chronormal/core/vec3.h"

namespace chronormal::peers {

/// A mesh that all libraries can read: a manifold with consistently wound faces, since some libraries accept no other
/// mesh.
struct TriangleMesh {
  std::span<const float> positions;        ///< (V, 3)
  std::span<const std::uint32_t> corners;  ///< (F, 3)

  [[nodiscard]] std::size_t vertex_count() const { return positions.size() / 3; }
  [[nodiscard]] std::size_t face_count() const { return corners.size() / 3; }
};

/// A mesh in the data structure of a library, built as users of the library would build it, with the normals of its
/// last computation.
class LibraryMesh {
 public:
  LibraryMesh() = default;
  LibraryMesh(const LibraryMesh&) = delete;
  LibraryMesh& operator=(const LibraryMesh&) = delete;
  virtual ~LibraryMesh() = default;
};

/// The rule by which a library adds up the normals of the faces around a vertex: weighted by area, all alike, or by a
/// rule of its own.
enum class Rule { kArea, kUniform, kOther };

/// A function of a library that computes normals. `compute` and `normal` accept only meshes of their own library.
struct Call {
  std::string name;
  bool of_vertices = false;  ///< true for normals of vertices, false for normals of faces
  Rule rule = Rule::kArea;
  std::string note = {};              ///< a remark on the input, if it is not only positions
  bool slow_in_random_order = false;  ///< true if 10 M elements take minutes
  void (*compute)(LibraryMesh&) = nullptr;
  /// Returns the unit normal of an element from the last call of compute().
  Vec3d (*normal)(const LibraryMesh&, std::size_t element) = nullptr;
};

struct Library {
  std::string name, version;
  std::vector<Call> calls;
  std::unique_ptr<LibraryMesh> (*make_mesh)(const TriangleMesh&) = nullptr;
};

/// Returns a flag for each point of (P, 3) that tells if the point is inside a closed mesh, by vtkSelectEnclosedPoints.
[[nodiscard]] std::vector<bool> vtk_enclosed(const TriangleMesh& mesh, std::span<const float> points);

[[nodiscard]] Library openmesh_library();
[[nodiscard]] Library vtk_library();
[[nodiscard]] Library cgal_library();

}  // namespace chronormal::peers

#endif  // PEERS_PEERS_H_
