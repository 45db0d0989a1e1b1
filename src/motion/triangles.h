/// Cuts polygons into triangles, for files that support only triangles, and to find whether points are inside a
/// surface.
///
/// If a fan around its first corner covers a polygon, as it does for every convex polygon, the polygon becomes that
/// fan, as in most programs. Any other polygon is cut by ear clipping in the plane of its vector area at one keyframe,
/// where the triangles cover it exactly once. All signs are exact. A polygon that crosses itself cannot be covered in
/// this way, and is cut into the same number of triangles.
///
/// Libraries that cut polygons (mapbox earcut, CGAL) leave out corners on straight edges, so that some vertices would
/// have no triangle, or they decide by rounded numbers. So the library has its own implementation.
#ifndef CHRONORMAL_MOTION_TRIANGLES_H_
#define CHRONORMAL_MOTION_TRIANGLES_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "chronormal/motion/motion.h"

namespace chronormal::inline internal {

/// Returns the n - 2 triangles of a polygon with n corners, as the numbers of their corners in the polygon, counted
/// from 0. `positions` are the positions of all vertices of the mesh. O(n) for convex polygons, otherwise O(n^2). A
/// polygon of more corners than kMostClipped becomes a fan.
[[nodiscard]] std::vector<std::array<std::uint32_t, 3>> triangles_of_face(std::span<const std::uint32_t> face,
                                                                          std::span<const float> positions);
inline constexpr std::size_t kMostClipped = 1U << 11;

/// Returns the triangles of all faces as vertices, (triangles, 3). `positions` belong to the topology's vertices. The
/// vertices in the result come from vertex_of_corner, which has a vertex for each corner of the topology and may number
/// vertices differently.
[[nodiscard]] std::vector<std::uint32_t> cut_polygons(const Topology& topology, std::span<const float> positions,
                                                      std::span<const std::uint32_t> vertex_of_corner);

/// Returns true if a fan around the first corner covers the polygon exactly once at these positions, as far as the
/// signs of triangles' areas tell.
[[nodiscard]] bool is_fan(std::span<const std::uint32_t> face, std::span<const float> positions);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_MOTION_TRIANGLES_H_
