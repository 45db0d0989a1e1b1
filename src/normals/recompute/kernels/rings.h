/// Normals of faces and of groups in float32 from points, sixteen at a time: the inner loops of FloatRecompute.
///
/// A normal is a sum over a path of points p around a centre c: n = sum (p[i] - c) x (p[i + 1] - c). The centre of a
/// polygon is its first corner, and its path consists of the other corners; the path of a vertex consists of its
/// neighbours in turn. Pieces of a path that do not join are connected through the centre, which adds nothing, and
/// shorter paths are filled up to the longest of sixteen with points that add nothing either:
///
///     slice    centres        of 16 elements, as indices of points
///              first points   of the paths
///              second ...     as many rows as the longest path has points
#ifndef CHRONORMAL_NORMALS_RECOMPUTE_KERNELS_RINGS_H_
#define CHRONORMAL_NORMALS_RECOMPUTE_KERNELS_RINGS_H_

#include <cstddef>
#include <cstdint>

#include "chronormal/core/views.h"

namespace chronormal::inline internal {

inline constexpr std::size_t kRingLanes = 16;  // elements of a slice

/// Points in rows x y z _, and whether points of neighbouring elements are scattered in memory and should be
/// prefetched.
struct RingPoints {
  const float* rows = nullptr;
  bool fetch = false;
};

/// Slices: rows of kRingLanes indices. Slice s has the rows first_row[s] to first_row[s + 1]; at least two.
struct RingSlices {
  const std::uint32_t* indices = nullptr;
  const std::size_t* first_row = nullptr;
  std::size_t count = 0;
};

/// Writes rows x y z _ of a range of points: s from + t to in float32. result begins with the first of them.
void interpolate_points(VectorView<const float> from, VectorView<const float> to, float s, float t, IndexRange points,
                        float* result) noexcept;

/// Writes the unit normals of the elements of a range of slices, the first of them to result[0]. Returns how many have
/// no normal in the range of float32; these get (0, 0, 0). `stream` writes past the caches where the result is packed
/// and aligned to 64 bytes.
/// slices.count > 0; result must have as many elements as the slices, or up to kRingLanes - 1 fewer
std::size_t ring_unit_normals(const RingPoints& points, const RingSlices& all, IndexRange slices,
                              VectorView<float> result, bool stream) noexcept;

/// The same for a range of triangles. corners has three corners for each of the face_count faces of the mesh.
/// faces.count > 0; result must have as many elements
std::size_t triangle_unit_normals(const RingPoints& points, const std::uint32_t* corners, std::size_t face_count,
                                  IndexRange faces, VectorView<float> result, bool stream) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_RECOMPUTE_KERNELS_RINGS_H_
