/// Unit normals in double, a few at a time: for the elements that float32 cannot carry.
#ifndef CHRONORMAL_NORMALS_CURVES_KERNELS_EXACT_NORMALS_H_
#define CHRONORMAL_NORMALS_CURVES_KERNELS_EXACT_NORMALS_H_

#include <cstddef>
#include <span>

#include "chronormal/core/vec3.h"
#include "chronormal/normals/control_normals.h"

namespace chronormal::inline internal {

/// Writes n(t) / |n(t)| rounded to float32, as unit_normal_at() has it: the limit direction where n(t) = 0, (0, 0, 0)
/// where there is none. Returns the number of (0, 0, 0). t in [0, 1]; result must have as many vectors as normals
std::size_t exact_unit_normals(std::span<const ControlNormals> normals, double t, std::span<Vec3f> result) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CURVES_KERNELS_EXACT_NORMALS_H_
