/// The two sides of a sheet: faces that lie back to back. Private to normals and workflow.
///
/// A cape, a flag or a card of hair is often modelled twice, once for each side: every face has a *back*, a face with
/// the same points the other way round. Their normals cancel, so that a point of both sides has no direction. The sides
/// are two surfaces; at a point where they meet, this tells which faces go with which.
///
///     together    two faces with an edge from the point in common, along which one leaves it and the other comes to it
///     apart       a face and its back
///
/// Sides are the sets of what goes together, as far as nothing in a set is apart. What touches no set (another sheet at
/// the same point) goes with the first that it is not apart from. A point has two sides only where all of its faces have
/// their backs: where walls of two boxes lie against each other, the faces around the rim still say how it looks.
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

/// Two polygons, by number, of which each is the back of the other; the smaller number first.
using BackToBack = std::pair<std::uint32_t, std::uint32_t>;

/// Writes the points of the corners of polygon i, in order around it.
using LoopOf = std::function<void(std::uint32_t i, std::vector<std::uint32_t>& loop)>;

/// The polygons of `count` that lie back to back, ascending. Each is the back of one at most; one that comes to a point
/// twice has none, and neither has one of an empty loop. O(n log n), and few bytes for each polygon.
[[nodiscard]] std::vector<BackToBack> find_backs(std::size_t count, const LoopOf& loop_of);

/// An edge from or to the point that a node has a part in, to a neighbour.
struct SideEdge {
  std::uint32_t node = 0, neighbour = 0;
  bool leaves = false;  ///< the face of the node goes along it from the point, and else to it
};

/// The side of each node at one point, numbered in the order of their first nodes. apart are pairs of different nodes.
[[nodiscard]] std::vector<std::uint32_t> split_sides(std::size_t nodes, std::vector<SideEdge> edges,
                                                     std::span<const std::pair<std::uint32_t, std::uint32_t>> apart);

/// Takes points apart at which vertices of both sides of a sheet were welded. A vertex that belongs to both sides
/// itself stays as it is. O(F), and O(F log F) where sheets may have two sides
void keep_sides_apart(const Topology& topology, Points& points);

/// Takes sets of corners apart in this way. A set is named by any of its corners, and each side gets a name of its own.
void take_sides_apart(const Topology& topology, const Points& points, std::vector<std::uint32_t>& set_of_corner);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_GROUPS_SIDES_H_
