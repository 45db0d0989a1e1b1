/// Normals of faces and of groups in float32 from points, sixteen at a time: the inner loops of FloatRecompute.
/// groups/rings.h describes the paths that they go along.
#ifndef CHRONORMAL_NORMALS_RECOMPUTE_KERNELS_FLOAT_RINGS_H_
#define CHRONORMAL_NORMALS_RECOMPUTE_KERNELS_FLOAT_RINGS_H_

#include <cstddef>
#include <cstdint>

#include "chronormal/core/views.h"
#include "normals/groups/rings.h"

namespace chronormal::inline internal {

/// Points in rows x y z _, and whether points of neighbouring elements are scattered in memory and should be
/// prefetched.
struct RingPoints {
  const float* rows = nullptr;
  bool fetch = false;
};

/// Writes the rows x y z _ of a range of points: s from + t to in float32. The first row of result belongs to the first
/// point of the range.
void interpolate_points(VectorView<const float> from, VectorView<const float> to, float s, float t, IndexRange points,
                        float* result) noexcept;

/// Writes the unit normals of the elements of a range of slices, the first of them to result[0]. Returns how many
/// elements have no normal in the range of float32; these get (0, 0, 0). `stream` bypasses the caches if the result is
/// packed and aligned to 64 bytes. slices.count > 0; result must have as many elements as the slices, or up to
/// kRingLanes - 1 fewer
std::size_t ring_unit_normals(const RingPoints& points, const RingSlices& all, IndexRange slices,
                              VectorView<float> result, bool stream) noexcept;

/// Writes the unit normals of a range of triangles, in the same way. corners has three corners for each of the
/// face_count faces of the mesh. faces.count > 0; result must have as many elements
std::size_t triangle_unit_normals(const RingPoints& points, const std::uint32_t* corners, std::size_t face_count,
                                  IndexRange faces, VectorView<float> result, bool stream) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_RECOMPUTE_KERNELS_FLOAT_RINGS_H_
