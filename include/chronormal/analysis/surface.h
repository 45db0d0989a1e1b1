/// Describes a mesh independently of its motion: doubled vertices, edges, pieces, and faces that coincide.
///
/// Files double vertices for texture seams or hard edges, so that a whole surface seems torn. Therefore everything here
/// counts points (normals/normal_groups.h) instead of vertices. An edge joins two points, and is
///
///     open           if one face has it, once or twice: the border of the surface
///     non-manifold   if more than two faces have it
///     turned         if two faces have it in the same direction: one of them has the wrong winding
///     seam           if two faces have it by different vertices: the file separates them
///
/// An edge can only be turned or a seam if each of its two faces has it once. Two faces coincide if they have the same
/// outline: the same points in the same cyclic order, or in reversed order. The same points in another order, as in a
/// self-crossing quad, are a different face. A face that has a point twice coincides with no other face.
///
/// Threads    pure.
/// Cost       nearly linear: the edges and the faces of each point are sorted separately.
#ifndef CHRONORMAL_ANALYSIS_SURFACE_H_
#define CHRONORMAL_ANALYSIS_SURFACE_H_

#include <cstddef>

#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"

namespace chronormal {

/// A count of edges, vertices or faces of one kind in a mesh, and the lowest index among them.
struct Found {
  std::size_t count = 0;
  std::size_t first = 0;  ///< the lowest index; 0 if count is 0

  void add(std::size_t index, std::size_t how_many = 1) noexcept {
    first = count == 0 || index < first ? index : first;
    count += how_many;
  }
  friend bool operator==(const Found&, const Found&) = default;
};

/// Finds copies, which are vertices at the same point as a vertex with a lower index.
[[nodiscard]] Found find_copies(const Points& points);

/// The counts of edges, pieces, vertices and coinciding faces of a mesh. The comment at the top of this file defines
/// the kinds of edges. For edges and pairs of faces, Found::first is the lowest face that has such an edge or belongs
/// to such a pair.
struct Surface {
  std::size_t edges = 0;
  Found open_edges, non_manifold_edges, turned_edges, seam_edges;
  std::size_t pieces = 0;  ///< number of parts of the mesh that have no point in common
  Found unreferenced;      ///< vertices that belong to no face
  Found repeating_faces;   ///< faces that name the same point twice, for example triangles without area
  Found doubled_faces;     ///< faces with the outline and winding of a face with a lower index
  Found back_to_back;      ///< pairs of faces with the same outline but opposite windings
  std::size_t triangles = 0;
  std::size_t most_corners = 0;  ///< the largest number of corners of a face
};

/// Counts the edges of each kind, the pieces and all other members of Surface for a mesh. `points` tells which vertices
/// of the mesh are one point.
[[nodiscard]] Surface survey(const Topology& topology, const Points& points);

}  // namespace chronormal

#endif  // CHRONORMAL_ANALYSIS_SURFACE_H_
