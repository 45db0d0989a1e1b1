/// Describes a mesh apart from its motion: doubled vertices, edges, pieces, faces that lie on each other.
///
/// Files double vertices, for texture seams or hard edges, and a surface that is whole then looks torn. So everything
/// here counts points (normals/normal_groups.h) and not vertices. An edge has two of them, and is
///
///     open           if one face has it, once or twice: the border of the surface
///     non-manifold   if more than two faces have it
///     turned         if two faces have it and go along it the same way: one of them is wound the wrong way round
///     seam           if two faces have it, but not by the same vertices: the file keeps it apart
///
/// The last two are asked where both faces have the edge once. Two faces lie on each other if they have the same
/// outline: the same points in the same cyclic order, or in the reversed one. The same points in another order are
/// another face, as are both halves of a quad that is crossed. A face that has a point twice lies on no other one.
///
/// Threads    pure.
/// Cost       sorting within the edges and faces of each point: near linear.
#ifndef CHRONORMAL_ANALYSIS_SURFACE_H_
#define CHRONORMAL_ANALYSIS_SURFACE_H_

#include <cstddef>

#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"

namespace chronormal {

/// A count of things that were found, and the lowest index among them.
struct Found {
  std::size_t count = 0;
  std::size_t first = 0;  ///< 0 where there are none

  void add(std::size_t index, std::size_t how_many = 1) noexcept {
    first = count == 0 || index < first ? index : first;
    count += how_many;
  }
  friend bool operator==(const Found&, const Found&) = default;
};

/// Finds the vertices that are copies: vertices at the point of a lower one.
[[nodiscard]] Found find_copies(const Points& points);

/// The counts that the text above explains. The first of an edge, or of a pair, is the lowest face that has one.
struct Surface {
  std::size_t edges = 0;
  Found open_edges, non_manifold_edges, turned_edges, seam_edges;
  std::size_t pieces = 0;  ///< parts without a common point
  Found unreferenced;      ///< vertices that no face has
  Found repeating_faces;   ///< faces that have a point twice: a triangle has no area then
  Found doubled_faces;     ///< faces with the outline of a lower one, wound the same way
  Found back_to_back;      ///< pairs of faces with the same outline, wound against each other
  std::size_t triangles = 0;
  std::size_t most_corners = 0;  ///< of one face
};

/// Surveys a mesh; points says which of its vertices are one.
[[nodiscard]] Surface survey(const Topology& topology, const Points& points);

}  // namespace chronormal

#endif  // CHRONORMAL_ANALYSIS_SURFACE_H_
