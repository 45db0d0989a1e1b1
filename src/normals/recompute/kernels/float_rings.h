/// Computes the unit normals of faces and of groups in float32 from points, sixteen at a time. These functions are the
/// inner loops of FloatRecompute. groups/rings.h describes the paths that the loops follow.
#ifndef CHRONORMAL_NORMALS_RECOMPUTE_KERNELS_FLOAT_RINGS_H_
#define CHRONORMAL_NORMALS_RECOMPUTE_KERNELS_FLOAT_RINGS_H_

#include <cstddef>
#include <cstdint>

#include "chronormal/core/views.h"
#include "normals/groups/rings.h"

namespace chronormal::inline internal {

/// The points of a mesh as rows x y z _. `fetch` is true if the points of neighbouring elements are scattered in
/// memory, so that they must be prefetched.
struct RingPoints {
  const float* rows = nullptr;
  bool fetch = false;
};

/// Writes the interpolated points s * from + t * to of a range, computed in float32, as rows x y z _. The first row of
/// `result` is that of the first point of the range.
void interpolate_points(VectorView<const float> from, VectorView<const float> to, float s, float t, IndexRange points,
                        float* result) noexcept;

/// Writes the unit normals of the elements of a range of slices; the first element goes to result[0]. Returns the
/// number of elements whose normal is outside of the range of float32, and which get (0, 0, 0). If `stream` is true,
/// and the result is packed and aligned to 64 bytes, the result bypasses the caches. Preconditions: slices.count > 0;
/// result has as many elements as the slices, or up to kRingLanes - 1 fewer.
std::size_t ring_unit_normals(const RingPoints& points, const RingSlices& all, IndexRange slices,
                              VectorView<float> result, bool stream) noexcept;

/// Writes the unit normals of a range of triangles, as ring_unit_normals() does for the elements of slices. corners has
/// three corners for each of the face_count faces of the mesh. Preconditions: faces.count > 0; result has faces.count
/// elements.
std::size_t triangle_unit_normals(const RingPoints& points, const std::uint32_t* corners, std::size_t face_count,
                                  IndexRange faces, VectorView<float> result, bool stream) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_RECOMPUTE_KERNELS_FLOAT_RINGS_H_
