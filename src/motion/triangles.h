/// Cuts polygons into triangles, for files that hold only triangles, and where a point of a surface is asked for.
/// Private.
///
/// A polygon that is covered by a fan around its first corner, as every convex one is, becomes that fan, which is what
/// most programs make of it. Any other polygon is cut by ear clipping in the plane of its vector area at one keyframe:
/// the triangles cover it once there. All signs are exact. A polygon that crosses itself has no such triangles, and
/// gets as many others.
///
/// Libraries that cut polygons (mapbox earcut, CGAL) leave out corners on straight edges, so that vertices would have
/// no triangle, or decide by rounded numbers; this is why we have our own.
/// no triangle, or decide by rounded numbers; so this is our own.
#ifndef CHRONORMAL_MOTION_TRIANGLES_H_
#define CHRONORMAL_MOTION_TRIANGLES_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "chronormal/motion/motion.h"

namespace chronormal::inline internal {

/// Returns the corners of each of the n - 2 triangles of one polygon, counted from 0 in it. positions are the positions
/// of the mesh. O(n) for convex polygons, else O(n^2). A polygon of more corners than kMostClipped becomes a fan.
[[nodiscard]] std::vector<std::array<std::uint32_t, 3>> triangles_of_face(std::span<const std::uint32_t> face,
                                                                          std::span<const float> positions);
inline constexpr std::size_t kMostClipped = 1U << 11;

/// Returns the triangles of all faces, by the vertex of each corner: (triangles, 3). positions belong to the topology's
/// vertices. vertex_of_corner may name other vertices, and has as many entries as the topology has corners.
[[nodiscard]] std::vector<std::uint32_t> cut_polygons(const Topology& topology, std::span<const float> positions,
                                                      std::span<const std::uint32_t> vertex_of_corner);

/// Tells whether a fan around the first corner covers the polygon once at these positions, as far as signs of areas
/// tell.
[[nodiscard]] bool is_fan(std::span<const std::uint32_t> face, std::span<const float> positions);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_MOTION_TRIANGLES_H_
