/// Which vertices are one point of the surface.
///
/// Files cut a surface at seams of texture and at hard edges: there, two or more vertices lie at one point. Where they
/// lie at one point in *every* keyframe, they are one point of the surface that deforms, and a seam must not show:
///
///     vertex            0  1  2  3  4        1 and 3 coincide in all keyframes, 2 and 4 in the first one only
///     point_of_vertex   0  1  2  1  3
///
/// Points are numbered in the order of their first vertices. Nothing here looks at faces.
#ifndef CHRONORMAL_NORMALS_WELD_H_
#define CHRONORMAL_NORMALS_WELD_H_

#include <cstddef>
#include <cstdint>
#include <vector>

#include "chronormal/motion/motion.h"

namespace chronormal {

struct Points {
  std::vector<std::uint32_t> point_of_vertex;
  std::size_t count = 0;
};

/// Every vertex is a point of its own.
[[nodiscard]] Points separate_points(std::size_t vertex_count);

/// Vertices of one body (motion/motion.h) whose coordinates are equal in all keyframes are one point. Equal means equal
/// float32, to the last bit, but -0 equals 0: there is no tolerance, since vertices that are merely close may belong to
/// two sides of a slit. O(V log V), and the number of keyframes times as much where vertices coincide. The motion must
/// be valid.
[[nodiscard]] Points weld_coincident(const Motion& motion);

}  // namespace chronormal

#endif  // CHRONORMAL_NORMALS_WELD_H_
