/// The two sides of a sheet: faces that lie back to back. Private to normals and workflow.
///
/// A cape, a flag or a card of hair is often modelled twice, once for each side: every face has a *back*, a face with
/// the same points the other way round. Their normals cancel, so a point of both sides has no direction. The sides are
/// two surfaces. At a point where they meet, this code decides which faces belong together.
///
///     together    two faces with an edge from the point in common, along which one face leaves the point and the other
///                 comes to it
///     apart       a face and its back
///
/// Sides are the sets of faces that are together, as long as no two in a set are apart. A face that touches no set (of
/// another sheet at the same point) joins the first set that it is not apart from. A point has two sides only if all of
/// its faces have their backs: where walls of two boxes touch each other, the faces around the rim still determine how
/// the point looks.
///
/// Threads    pure
#ifndef CHRONORMAL_NORMALS_GROUPS_SIDES_H_
#define CHRONORMAL_NORMALS_GROUPS_SIDES_H_

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"

namespace chronormal::inline internal {

inline constexpr std::uint32_t kNoFace = 0xFFFFFFFF;

/// A pair of polygons, by number, of which each is the back of the other; the smaller number comes first.
using BackToBack = std::pair<std::uint32_t, std::uint32_t>;

/// A function that writes the points of the corners of polygon i, in order around it.
using LoopOf = std::function<void(std::uint32_t i, std::vector<std::uint32_t>& loop)>;

/// Returns the polygons of `count` that are back to back, in ascending order. Each polygon is the back of at most one
/// other. A polygon that visits a point twice, or has an empty loop, has no back. O(n log n), with a few bytes for each
/// polygon.
[[nodiscard]] std::vector<BackToBack> find_backs(std::size_t count, const LoopOf& loop_of);

/// An edge between a point and a neighbour, as one face has it. The corner of this face at the point belongs to a node:
/// a vertex, or a set of corners, that stays whole when the point is split.
struct SideEdge {
  std::uint32_t node = 0, neighbour = 0;
  bool leaves = false;  ///< whether the face of the node goes along the edge from the point, not to it
};

/// Returns the side of each node at one point; sides are numbered in the order of their first nodes. `apart` has pairs
/// of different nodes that must not be on the same side.
[[nodiscard]] std::vector<std::uint32_t> split_sides(std::size_t nodes, std::vector<SideEdge> edges,
                                                     std::span<const std::pair<std::uint32_t, std::uint32_t>> apart);

/// Splits points at which vertices of both sides of a sheet were welded. A vertex that belongs to both sides itself
/// stays as it is. O(F), and O(F log F) if sheets may have two sides
void keep_sides_apart(const Topology& topology, Points& points);

/// Splits sets of corners that have corners of both sides of a sheet. A set is named by any of its corners, and each
/// side gets its own name.
void take_sides_apart(const Topology& topology, const Points& points, std::vector<std::uint32_t>& set_of_corner);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_GROUPS_SIDES_H_
