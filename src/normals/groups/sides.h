/// Finds the two sides of a sheet, which consists of faces that are back to back. Used by normals and workflow.
///
/// A cape, a flag or a card of hair is often modelled twice, once for each side. Every face then has a *back*: a face
/// with the same points in reversed order. The normals of a face and its back cancel, so a point that belongs to both
/// sides would have no normal. The sides are therefore treated as two surfaces. At a point where both sides meet, two
/// relations between faces decide which faces belong to the same side:
///
///     together    two faces with an edge from the point in common, along which one face leaves the point and the other
///                 comes to it
///     apart       a face and its back
///
/// A side is a set of faces that are together, directly or through other faces, as long as no two faces of the set are
/// apart. A face that is together with no set (it may belong to another sheet at the same point) joins the first set
/// with no face that must stay apart from it. A point has two sides only if all of its faces have their backs. Where
/// walls of two boxes touch each other, for example, the faces around the rim have no backs, and still determine how
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

/// The numbers of two polygons each of which is the back of the other. The smaller number comes first.
using BackToBack = std::pair<std::uint32_t, std::uint32_t>;

/// A function that writes the points of polygon i, in the order of its corners.
using LoopOf = std::function<void(std::uint32_t i, std::vector<std::uint32_t>& loop)>;

/// Returns the pairs among polygons 0 ... count - 1 that are back to back, in ascending order. A polygon is in at most
/// one pair. A polygon that has a point twice, or has no points, has no back. O(n log n), with a few bytes for each
/// polygon.
[[nodiscard]] std::vector<BackToBack> find_backs(std::size_t count, const LoopOf& loop_of);

/// An edge between a point and a neighbour, as one face has it. The corner of this face at the point belongs to a node.
/// A node is a vertex, or a set of corners, that is not divided when the point is split into sides.
struct SideEdge {
  std::uint32_t node = 0, neighbour = 0;
  /// True if the face goes along the edge from the point to the neighbour, false if the face goes from the neighbour to
  /// the point.
  bool leaves = false;
};

/// Returns the number of the side of each node at one point. Sides are numbered in the order of their first nodes.
/// `apart` has pairs of different nodes that must not be on the same side.
[[nodiscard]] std::vector<std::uint32_t> split_sides(std::size_t nodes, std::vector<SideEdge> edges,
                                                     std::span<const std::pair<std::uint32_t, std::uint32_t>> apart);

/// Splits points at which vertices of both sides of a sheet were welded. A vertex that belongs to both sides is not
/// split. O(F) for F faces, and O(F log F) if sheets may have two sides.
void keep_sides_apart(const Topology& topology, Points& points);

/// Splits sets of corners that have corners of both sides of a sheet. A set is named by any of its corners. After the
/// split, each side has a name of its own.
void take_sides_apart(const Topology& topology, const Points& points, std::vector<std::uint32_t>& set_of_corner);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_GROUPS_SIDES_H_
