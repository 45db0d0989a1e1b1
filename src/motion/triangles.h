/// Cuts polygons into triangles, for files that support only triangles, and for points of a surface. Private.
///
/// A polygon that is covered by a fan around its first corner, like every convex polygon, becomes that fan, as in most
/// programs. Any other polygon is cut by ear clipping in the plane of its vector area at one keyframe, where the
/// triangles cover it exactly once. All signs are exact. A polygon that crosses itself has no such triangles, and is
/// cut into the same number of others.
///
/// Libraries that cut polygons (mapbox earcut, CGAL) leave out corners on straight edges, so that vertices would have
/// no triangle, or they decide by rounded numbers; so this is our own implementation.
#ifndef CHRONORMAL_MOTION_TRIANGLES_H_
#define CHRONORMAL_MOTION_TRIANGLES_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "chronormal/motion/motion.h"

namespace chronormal::inline internal {

/// Returns the corners of each of the n - 2 triangles of a polygon, counted from 0 within it. `positions` are those of
/// the mesh. O(n) for convex polygons, otherwise O(n^2). A polygon of more corners than kMostClipped becomes a fan.
[[nodiscard]] std::vector<std::array<std::uint32_t, 3>> triangles_of_face(std::span<const std::uint32_t> face,
                                                                          std::span<const float> positions);
inline constexpr std::size_t kMostClipped = 1U << 11;

/// Returns the triangles of all faces, by the vertex of each corner: (triangles, 3). `positions` belong to the
/// topology's vertices. vertex_of_corner may have other vertices, with an entry for each corner of the topology.
[[nodiscard]] std::vector<std::uint32_t> cut_polygons(const Topology& topology, std::span<const float> positions,
                                                      std::span<const std::uint32_t> vertex_of_corner);

/// Tells whether a fan around the first corner covers the polygon once at these positions, as far as signs of areas
/// tell.
[[nodiscard]] bool is_fan(std::span<const std::uint32_t> face, std::span<const float> positions);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_MOTION_TRIANGLES_H_
