/// Computes vector areas of triangles, and their sums over the faces around elements, in lanes of double.
///
/// Points and areas are rows of four doubles: x, y, z and a fourth number, which is ignored in points and 0 in areas.
/// triangle_areas() and sums_of_areas() give the same bits as without_rounding() of CrossSum and of VectorSum
/// (core/rounding.h).
#ifndef CHRONORMAL_NORMALS_GROUPS_KERNELS_VECTOR_AREAS_H_
#define CHRONORMAL_NORMALS_GROUPS_KERNELS_VECTOR_AREAS_H_

#include <cstddef>
#include <cstdint>
#include <span>

#include "chronormal/core/vec3.h"
#include "chronormal/core/views.h"
#include "chronormal/normals/normal_groups.h"

namespace chronormal::inline internal {

inline constexpr std::size_t kAreaRow = 4;

/// Writes twice the vector area of each triangle. For each triangle, corners has three points, and areas has one row.
void triangle_areas(const double* points, std::span<const std::uint32_t> corners, double* areas) noexcept;

/// Writes the sums of the areas of the faces around some elements. The first row of `areas` is that of face first_face.
void sums_of_areas(const double* areas, std::size_t first_face, const NormalGroups& groups, IndexRange elements,
                   Vec3d* sums) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_GROUPS_KERNELS_VECTOR_AREAS_H_
