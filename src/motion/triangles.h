/// Cuts polygons into triangles: what files that hold only triangles get, and what is asked where a surface is.
/// Private.
///
/// A polygon that a fan around its first corner covers, as every convex one, becomes that fan, which is what most
/// programs make of it. Another one is cut by ear clipping in the plane of its vector area at one keyframe: the
/// triangles cover the polygon once there. All signs are exact. A polygon that crosses itself has no such triangles,
/// and gets as many others.
///
/// Libraries that cut polygons (mapbox earcut, CGAL) leave out corners on straight edges, so that vertices would have
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

/// The corners of one polygon, counted from 0 in it, of each of its n - 2 triangles. positions are those of the mesh.
/// O(n) for convex ones, else O(n^2); one of more corners than kMostClipped becomes a fan.
[[nodiscard]] std::vector<std::array<std::uint32_t, 3>> triangles_of_face(std::span<const std::uint32_t> face,
                                                                          std::span<const float> positions);
inline constexpr std::size_t kMostClipped = 1U << 11;

/// The triangles of all faces, by the vertex of each corner: (triangles, 3). positions are those of the topology's
/// vertices; vertex_of_corner may name other vertices, and has as many entries as the topology has corners.
[[nodiscard]] std::vector<std::uint32_t> cut_polygons(const Topology& topology, std::span<const float> positions,
                                                      std::span<const std::uint32_t> vertex_of_corner);

/// Tells whether a fan around the first corner covers the polygon once at these positions, as far as signs of areas
/// tell.
[[nodiscard]] bool is_fan(std::span<const std::uint32_t> face, std::span<const float> positions);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_MOTION_TRIANGLES_H_
